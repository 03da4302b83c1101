# SPDX-License-Identifier: BSD-3-Clause
"""Robot files at the command line: inspect, init, check, and what analyze and simulate make."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from command_line import refusal, run, run_json
from oracles import example_urdf
from robot_files import two_links, two_links_urdf

from softimpact.robots import built_in_robots

TURNED = "[-0.564642473, 0.825335615, 0]"  # along which the coupled arm's tool moves at 0.6


def written(folder: Path, text: str, name: str = "robot.xml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def result_of(*arguments: object) -> dict[str, object]:
    """One JSON object of a command that may warn."""
    outcome = run(*arguments, "--json")
    assert outcome.code == 0, outcome.err
    assert all(line.startswith("warning: ") for line in outcome.err.splitlines())
    found = json.loads(outcome.out)
    assert isinstance(found, dict)
    return found


def test_a_joint_that_follows_has_no_entry_in_q(tmp_path: Path) -> None:
    path = written(tmp_path, two_links_urdf(on_j2='<mimic joint="j1" multiplier="-1"/>'), "a.urdf")
    where = ("--tip", "tool", "--direction", "[0, 1, 0]")
    short = result_of("analyze", path, "--q", "[0.6]", *where)
    assert short["q"] == [0.6, -0.6]
    assert short["m_c"] == pytest.approx(2.385570, abs=1e-6)
    assert short["m_c"] == result_of("analyze", path, "--q", "[0.6,-0.6]", *where)["m_c"]
    message = refusal("analyze", path, "--q", "[0.6, 0.6]", *where)
    assert "joint 'j2' follows 'j1'" in message


def test_drives_of_a_joint_that_follows(tmp_path: Path) -> None:
    path = written(tmp_path, two_links_urdf(on_j2='<mimic joint="j1" multiplier="-1"/>'), "a.urdf")
    impact = ("--tip", "tool", "--q", "[0.6]", "--direction", TURNED, "--region", "chest")
    drives = ("--speed", "0.3", "--joint-stiffness", "1e4", "--rotor-inertia")
    one = result_of("simulate", path, *impact, *drives, "0.3")
    assert one["joint_stiffness"] == [1e4, None]
    assert one["rotor_inertia"] == [0.3, 0.0]
    assert one["peak"] == result_of("simulate", path, *impact, *drives, "[0.3]")["peak"]


def test_damping_of_the_file_counts(tmp_path: Path) -> None:
    where = ("--tip", "tool", "--q", "[0.3, 1.2]", "--direction", "[1, 0, 0]", "--region", "chest")
    peaks = []
    for damping in ("0", "50"):
        text = two_links(
            j1=f'armature="0.3" damping="{damping}"', j2=f'armature="0.2" damping="{damping}"'
        )
        path = written(tmp_path, text)
        found = result_of("simulate", path, *where, "--speed", "0.5", "--motors", "free")
        peaks.append(float(str(found["peak"])))
    assert abs(peaks[1] - peaks[0]) > 0.2 * peaks[0]


@pytest.mark.parametrize("option", ["--hold-base", "--floating"])
def test_robots_that_float(tmp_path: Path, option: str) -> None:
    trunk = '<body name="trunk"><freejoint/><geom size=".2"/><body name="upper">'
    text = two_links(beside='<geom type="plane" size="1 1 1"/>')
    text = text.replace('<body name="upper" >', trunk).replace(
        "</worldbody>", "</body></worldbody>"
    )
    path = written(tmp_path, text)
    where = ("--tip", "tool", "--q", "[0.3, 1.2]", "--direction", "[1, 0, 0]")
    message = refusal("factors", path, *where)
    assert "--hold-base" in message
    assert "--floating" in message
    assert result_of("factors", path, *where, option)["floating"] is (option == "--floating")
    assert "excludes floating" in refusal("factors", path, *where, "--floating", "--hold-base")
    if option == "--hold-base":
        held = result_of("analyze", path, *where, option)
        assert held["m_c"] == pytest.approx(0.359356, abs=1e-6)


def test_warnings_are_on_stderr_and_in_json(tmp_path: Path) -> None:
    path = written(tmp_path, two_links_urdf(after="<transmission/>"), "a.urdf")
    where = ("--tip", "tool", "--q", "[0.3, 1.2]", "--direction", "[1, 0, 0]")
    outcome = run("analyze", path, *where, "--json")
    line = "transmissions are not read: every joint counts as having a motor"
    assert f"warning: {line}\n" in outcome.err
    assert line in json.loads(outcome.out)["warnings"]


def test_inspect_shows_what_there_is(tmp_path: Path) -> None:
    text = two_links(
        j1='damping="3" armature="0.2" range="-1 2"',
        after='<equality><joint joint1="j2" joint2="j1" polycoef="0 -1 0 0 0"/></equality>'
        '<actuator><position joint="j1" kp="50" kv="2"/></actuator>',
    )
    found = result_of("inspect", written(tmp_path, text), "--tip", "tool")
    joints = found["joints"]
    assert isinstance(joints, list)
    first, second = joints
    assert (first["damping"], first["rotor_inertia"], first["upper"]) == (3.0, 0.2, 2.0)
    assert (first["position_gain"], first["velocity_gain"]) == (50.0, 2.0)
    assert (first["motor"], second["motor"], second["mass"]) == (True, False, 1.0)
    assert found["followers"] == ["j2"]
    assert found["q"] == ["j1"]
    assert found["reach"] == pytest.approx(0.7)
    opinions = found["second_opinions"]
    assert isinstance(opinions, dict)
    assert opinions["MuJoCo"] < 1e-10
    assert opinions["Pinocchio"] < 1e-10


def test_inspect_of_files_from_the_wild() -> None:
    found = result_of("inspect", example_urdf("solo12.urdf"))
    opinions = found["second_opinions"]
    assert isinstance(opinions, dict)
    assert opinions["Pinocchio"] < 1e-10
    assert found["tip"] is None
    table = run("inspect", example_urdf("romeo_small.urdf")).out
    assert "RShoulderYaw" in table
    arm = result_of("inspect", example_urdf("baxter.urdf"), "--tip", "left_gripper")["q"]
    assert isinstance(arm, list)
    assert [name.removeprefix("left_") for name in arm] == [
        "s0",
        "s1",
        "e0",
        "e1",
        "w0",
        "w1",
        "w2",
    ]


def test_a_study_of_an_arm_whose_base_floats(tmp_path: Path) -> None:
    arm = (
        '<joint name="j" axis="0 0 1"/><geom size="0.1" mass="1"/><site name="tool" pos="0.5 0 0"/>'
    )
    body = f'<body><freejoint/><geom size="0.1"/><body pos="0 0 1">{arm}</body></body>'
    path = written(tmp_path, f"<mujoco><worldbody>{body}</worldbody></mujoco>")
    assert "hold the robot's base by --hold-base" in refusal("init", path, "--tip", "tool")
    assert "hold_base = true" in run("init", path, "--tip", "tool", "--hold-base").out


LEG = ("mini_cheetah", "--q", "[0, -0.8, 1.6]", "--direction", "[0, 0, -1]")


def test_what_is_taken_for_a_base_that_may_move_is_said() -> None:
    held = "the base of mini_cheetah (3.52 kg, at which 4 chains of joints start) is taken as held"
    (line,) = run_json("analyze", *LEG)["warnings"]
    assert line.startswith(held)
    nothing, line = run_json("analyze", *LEG, "--hold-base")["warnings"]
    assert nothing == "the file holds the base already: hold_base changes nothing"
    assert line.startswith(held)
    assert held in run("init", "mini_cheetah").err
    assert run("init", "panda").err == ""


def test_a_first_study_for_machines() -> None:
    found = run_json("init", "ur5e")
    assert found["text"] == run("init", "ur5e").out
    assert found["study"]["robot"]["tip"] == "flange"


def test_a_robot_is_no_study() -> None:
    assert "softimpact init panda > study.toml" in refusal("check", "panda")


def test_inspect_of_a_file_that_is_none(tmp_path: Path) -> None:
    assert "no such file" in refusal("inspect", tmp_path / "gone.urdf")


@pytest.mark.parametrize("name", ["panda", "ur5e", "iiwa14", "fr3", "mini_cheetah", "rmin", "rr"])
def test_a_first_study_can_run(name: str, tmp_path: Path) -> None:
    begun = run("init", name)
    assert begun.code == 0, begun.err
    path = written(tmp_path, begun.out, "study.toml")
    outcome = run("check", path)
    assert outcome.code == 0, outcome.err
    assert "nothing is wrong" in outcome.out


def test_a_first_study_says_what_is_missing(tmp_path: Path) -> None:
    path = written(tmp_path, two_links_urdf(), "a.urdf")
    begun = run("init", path, "--tip", "tool")
    assert "TODO: the model has no rotor inertia of j1, j2" in begun.out
    study = written(tmp_path, begun.out, "study.toml")
    assert "robot.rotor_inertia: joint 'j1'" in refusal("check", study)
    written(tmp_path, begun.out.replace("# rotor_inertia =", "rotor_inertia ="), "study.toml")
    assert run("check", study).code == 0
    assert "names no contact frame" in refusal("init", path)


def test_check_says_everything_at_once(tmp_path: Path) -> None:
    text = run("init", "panda").out
    for right, wrong in (
        ("max_deflection =", "max_deflecton ="),
        ('"chest"', '"chst"'),
        ("speed = 0.5", "speed = -1"),
        ("lower = 300", "lower = 3e9"),
    ):
        assert right in text
        text = text.replace(right, wrong)
    text += (
        '[[poses]]\nname = "far"\nq = [9, 0, 0, 0, 0, 0, 0]\n[[poses]]\nname = "b"\nq = [9, 0]\n'
    )
    path = written(tmp_path, text, "study.toml")
    lines = text.splitlines()
    outcome = run("check", path)
    assert (outcome.code, outcome.out) == (2, "")
    problems = [line.removeprefix(f"error: {path}:") for line in outcome.err.splitlines()]
    found = {}
    for problem in problems:
        number, field, reason = problem.split(": ", 2)
        found[field] = (lines[int(number) - 1].split("#")[0].strip(), reason)
    assert found["impact.region"][0] == 'region = "chst"'
    assert found["impact.speed"][0] == "speed = -1"
    assert found["stiffness.lower"][0] == "lower = 3e9"
    assert found["accuracy.max_deflecton"] == (
        "max_deflecton = 0.001",
        "unknown; did you mean 'max_deflection'?",
    )
    assert found["poses.1.q"][0] == "q = [9, 0, 0, 0, 0, 0, 0]"
    assert found["poses.2.q"][0] == "q = [9, 0]"
    assert len(found) == 7
    listed = json.loads(run("check", path, "--json").out)["problems"]
    assert len(listed) == 7


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("title = ", ":1: "),
        ("", "robot: is missing"),
        ('[robot]\nmodel = "nobody"\n', "robot"),
        ("poses = 3\n", ":1: poses: "),
    ],
)
def test_check_of_what_is_no_study(tmp_path: Path, text: str, message: str) -> None:
    outcome = run("check", written(tmp_path, text, "study.toml"))
    assert outcome.code == 2
    assert message in outcome.err


def test_check_says_what_the_search_could_not_do(tmp_path: Path) -> None:
    """Springs so stiff that impacts take too many steps are said before the design says it."""
    text = run("init", "ur10e").out
    named = text.replace("# rotor_inertia = [", 'rotor_inertia = "upper_estimate"  # [')
    study = written(tmp_path, named, "study.toml")
    assert run("check", study).code == 0
    study = written(tmp_path, re.sub(r"(?m)^upper = .*$", "upper = 1e7", named), "study.toml")
    (line,) = (
        i for i, text in enumerate(study.read_text().splitlines(), 1) if text == "upper = 1e7"
    )
    refused = run("check", study)
    assert refused.code == 2
    assert refused.err.startswith(f"error: {study}:{line}: stiffness.upper: joints that stiff")
    assert refused.err.count("\n") == 1


def test_check_of_a_study_that_comes_along() -> None:
    study = built_in_robots()["panda"].parent / "studies/panda_24_poses.toml"
    assert run("check", study).code == 0
