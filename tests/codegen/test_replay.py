# SPDX-License-Identifier: BSD-3-Clause
"""Packages run their own test before they are written."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import run
from robot_files import many_joints

from softimpact.codegen import FailedOwnTest, generate_package, package_of
from softimpact.codegen.package.render import render
from softimpact.codegen.verification.replay import replay, works
from softimpact.symbolic import load_robot
from softimpact.toolchain import c_compiler

COMPILER = c_compiler() or ("cc",)

JOINTS = 14


@pytest.fixture(scope="module")
def files() -> dict[str, str]:
    return render(package_of(load_robot("rr")))[0]


def test_a_sound_package_passes(files: dict[str, str]) -> None:
    replay(files, COMPILER)


def test_a_golden_impact_that_is_missed_is_named(files: dict[str, str]) -> None:
    table = files["test/golden.c"]
    head, _, impacts = table.partition("rr_golden_impacts")
    place = impacts.index("RR_HEAD, ")
    row = impacts[place : impacts.index(" }", place)]
    part, clamped, speed, force = row.split(", ")
    wrong = ", ".join([part, clamped, speed, repr(1.01 * float(force))])
    tampered = head + "rr_golden_impacts" + impacts.replace(row, wrong)
    with pytest.raises(FailedOwnTest, match="FAILED rr_peak_force: error within its bound"):
        replay({**files, "test/golden.c": tampered}, COMPILER)


def test_c_that_does_not_compile_is_named(files: dict[str, str]) -> None:
    broken = files["src/rr_jacobian.c"] + "\nint nonsense\n"
    with pytest.raises(FailedOwnTest, match=r"rr_jacobian\.c:.*error"):
        replay({**files, "src/rr_jacobian.c": broken}, COMPILER)


def test_nothing_is_written_of_a_package_that_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*arguments: object) -> None:
        raise FailedOwnTest("FAILED rr_chain: error within its bound")

    monkeypatch.setattr("softimpact.codegen.package.generate.replay", fail)
    outcome = run("generate", "rr", "--out", tmp_path / "c")
    assert outcome.code == 3
    assert "not written: FAILED rr_chain" in outcome.err
    assert not (tmp_path / "c").exists()


def test_compilers_that_make_no_programs() -> None:
    assert works(COMPILER)
    assert not works(["false"])
    assert not works(["/nowhere/cc"])


@pytest.mark.parametrize(
    ("named", "reason"),
    [
        ("false", "makes no programs"),
        pytest.param("/nowhere/cc", "there is no C compiler", marks=pytest.mark.slow),
    ],
)
def test_without_a_compiler_one_line_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, named: str, reason: str
) -> None:
    monkeypatch.setenv("CC", named)
    outcome = run("generate", "rr", "--out", tmp_path / "c")
    assert outcome.code == 0
    assert outcome.err.count("\n") == 1
    assert reason in outcome.err
    assert "the package's own test was not run" in outcome.err


@pytest.mark.slow
def test_what_many_joints_take_grows_with_their_square(tmp_path: Path) -> None:
    """Time is compared with that of half the joints, as machines differ; the word comes early."""
    half, _ = taken(JOINTS // 2, tmp_path)
    seconds, megabytes = taken(JOINTS, tmp_path)
    assert seconds < 2**2 * half
    assert megabytes < 1000 * (JOINTS / 20) ** 2


def taken(joints: int, folder: Path) -> tuple[float, float]:
    """Return how long an arm's package keeps a core busy (s), and its most memory (MB)."""
    path = folder / f"arm{joints}.urdf"
    path.write_text(many_joints(joints))
    script = (
        "import resource, sys; from softimpact.cli import main; code = main();"
        "use = resource.getrusage(resource.RUSAGE_SELF);"
        "peak = open('/proc/self/status').read().split('VmHWM:')[1].split()[0];"
        "print(code, use.ru_utime, int(peak) / 1024)"  # ru_maxrss begins with the parent's
    )
    arguments = ["generate", str(path), "--tip", "tool", "--rotor-inertia", "0.1"]
    done = subprocess.run(
        [sys.executable, "-c", script, *arguments, "--out", str(path.with_suffix("")), "--json"],
        capture_output=True,
        text=True,
        check=True,
    )
    manifest, numbers = done.stdout.splitlines()
    code, seconds, megabytes = map(float, numbers.split())
    assert code == 0
    assert len(json.loads(manifest)["joints"]) == joints
    word = done.stderr.startswith(f"{joints} joints: a large package. Expect some ")
    assert word == (joints == JOINTS)
    return seconds, megabytes


@pytest.mark.slow
def test_a_package_from_python_needs_no_compiler(tmp_path: Path) -> None:
    steps: list[str] = []
    generate_package(
        load_robot("rr"), tmp_path / "c", on_step=lambda what, done, of: steps.append(what)
    )
    assert steps[:2] == ["derivation", "mass_matrix"]
    assert "own test" not in steps
