# SPDX-License-Identifier: BSD-3-Clause
"""``examples/host`` scales velocities as it says, and builds with CMake's FetchContent offline."""

from __future__ import annotations

import re
import subprocess
import tarfile
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
from adversarial.cases import stacked
from adversarial.impacts import Robot
from adversarial.plain import plain_forces
from compiled_impacts import FREE_OR_DRIVEN
from compiled_packages import WARNINGS, Generated, run, tool

from softimpact.symbolic import body_region, load_robot

ROOT = Path(__file__).parents[2]
EXAMPLE, PACKAGE = ROOT / "examples/host", ROOT / "generated/panda"


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    binary = tmp_path_factory.mktemp("host") / "safe_stream"
    sources = [EXAMPLE / "main.c", *PACKAGE.glob("src/*.c")]
    include = f"-I{PACKAGE / 'include'}"
    run(tool("gcc"), "-std=c99", "-O1", *WARNINGS, include, *sources, "-o", binary, "-lm")
    return binary


def stream(program: Path, lines: list[str]) -> subprocess.CompletedProcess[str]:
    given = "".join(f"{line}\n" for line in lines)
    return subprocess.run(
        [program, "-"], input=given, capture_output=True, text=True, check=False
    )  # fmt: skip


def rows(said: str) -> list[list[float]]:
    """Time, planned and allowed speed, share, and the first joint's command of each line."""
    return [[float(x) for x in line.split()] for line in said.splitlines()[1:-1]]


def check_own_motion(said: str) -> None:
    found = re.search(r"(\d+) states, (\d+) slowed down, least share ([\d.]+), .*", said)
    assert found, said
    assert int(found[1]) == 2000
    assert 500 < int(found[2]) < 2000
    assert 0.3 < float(found[3]) < 0.9
    for _, planned, allowed, share, _ in rows(said):
        assert share == pytest.approx(min(1, allowed / planned) if planned > 0 else 1, abs=2e-3)


def test_own_motion_is_slowed_down_where_it_must_be(program: Path) -> None:
    check_own_motion(run(program))


def test_states_from_a_file_get_the_speed_that_an_integrator_allows(
    program: Path, tmp_path: Path
) -> None:
    q = np.array([0.1, -0.3, 0.2, -2.0, 0.3, 2.0, 0.5])
    rate = np.array([1.5, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0])
    line = ",".join(f"{x:.17g}" for x in [0.5, *q, *rate])
    done = stream(program, [line])
    assert done.returncode == 0, done.stderr
    ((time, planned, allowed, share, first),) = rows(done.stdout)

    panda, chest = load_robot("panda"), body_region("chest")
    manifest = Mock(name="panda", tip="hand_tcp", gravity=(0.0, 0.0, 0.0))
    robot = Robot(Generated(panda, str(panda.tip), PACKAGE, manifest), tmp_path)
    velocity = robot.jacobians(q[None])[0] @ rate
    case = stacked([{
        "q": q, "n": velocity, "springs": [3e3] * 7, "rotors": panda.armature, "gains": [0.0] * 7,
        "damping_gains": [0.0] * 7, "motors": FREE_OR_DRIVEN, "reaction": 0.02, "horizon": 0.1,
        "stiffness": chest.stiffness, "damping": chest.damping, "mass": chest.effective_mass,
        "limit": chest.force_limit,
    }])  # fmt: skip
    assert time == 0.5
    assert planned == pytest.approx(np.linalg.norm(velocity), abs=1e-3)
    force = plain_forces(robot, case, np.array([allowed]))[0]
    assert 0.97 < force / chest.force_limit < 1.001  # of 3 decimals
    assert first == pytest.approx(share * rate[0], abs=2e-3)


def test_rest_goes_through_and_nonsense_stops_the_arm(program: Path) -> None:
    pose = "0.1,-0.3,0.2,-2,0.3,2,0.5"
    rest = stream(program, [f"0,{pose},0,0,0,0,0,0,0"])
    assert rows(rest.stdout)[0][3] == 1
    lost = stream(program, [f"0,{pose},nan,0,0,0,0,0,0"])
    assert rows(lost.stdout)[0][3:] == [0, 0]
    short = stream(program, [f"0,{pose},0,0,0,0,0,0,0", f"0,{pose}"])
    assert (short.returncode, short.stderr) == (2, "line 2 is not a state\n")


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["folder", "archive"])
def test_fetch_content_takes_the_package_without_a_network(tmp_path: Path, kind: str) -> None:
    cmake, chosen = tool("cmake"), []
    if kind == "archive":
        archive = tmp_path / "panda.tar.gz"
        with tarfile.open(archive, "w:gz") as file:
            file.add(PACKAGE, arcname="panda")
        chosen = [f"-DPANDA_PACKAGE={archive}"]
    run(cmake, "-S", EXAMPLE, "-B", tmp_path / "build", *chosen)
    run(cmake, "--build", tmp_path / "build")
    check_own_motion(run(tmp_path / "build/safe_stream"))
