# SPDX-License-Identifier: BSD-3-Clause
"""What a user may get wrong: exit code 2, one line that says what, and no traceback."""

from __future__ import annotations

import errno
import math
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import refusal, run
from oracles import example_urdf

from softimpact import cli
from softimpact.studio.commands.generate import RealOption
from softimpact.studio.typed.values import one_of
from softimpact.symbolic import load_robot

Q = "[0, 0.3, 0, -1.8, 0.1, 2, 0.5]"
PANDA = ("panda", "--q", Q, "--direction", "[0, 1, 0]")

GOOD_INERTIAL = (
    "<inertial><mass value='2'/>"
    "<inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/></inertial>"
)


def analyze(*options: str) -> str:
    return refusal("analyze", *PANDA, *options)


def instead(option: str, value: str) -> str:
    """Analyze the Panda with one of its options replaced."""
    given = {"--q": Q, "--direction": "[0, 1, 0]", option: value}
    return refusal("analyze", "panda", *(word for pair in given.items() for word in pair))


@pytest.fixture
def arm(tmp_path: Path) -> Callable[..., Path]:
    """Writes a one-joint URDF with an inertial element and a joint type of choice."""

    def write(inertial: str = GOOD_INERTIAL, kind: str = "continuous") -> Path:
        path = tmp_path / "arm.urdf"
        path.write_text(
            "<robot name='arm'><link name='foot'/>"
            f"<link name='hand'>{inertial}</link>"
            f"<joint name='shoulder' type='{kind}'><axis xyz='0 0 1'/><origin xyz='0.5 0 0'/>"
            "<parent link='foot'/><child link='hand'/></joint></robot>"
        )
        return path

    return write


def analyze_file(path: Path) -> str:
    where = ("--tip", "hand", "--q", "[0]", "--direction", "[0, 1, 0]")
    return refusal("analyze", path, *where)


def with_inertia(mass: str, xx: str) -> str:
    return GOOD_INERTIAL.replace("'2'", f"'{mass}'").replace("ixx='0.1'", f"ixx='{xx}'")


# Model files


def test_missing_file() -> None:
    assert "nowhere.urdf: no such file" in analyze_file(Path("nowhere.urdf"))


def test_broken_xml(tmp_path: Path) -> None:
    path = tmp_path / "broken.xml"
    path.write_text("<mujoco><worldbody>")
    assert str(path) in analyze_file(path)


def test_not_a_robot_description(tmp_path: Path) -> None:
    path = tmp_path / "page.urdf"
    path.write_text("<html/>")
    assert str(path) in analyze_file(path)


@pytest.mark.parametrize(
    ("mass", "xx", "reason"),
    [
        ("-1", "0.1", "mass is negative"),
        ("NaN", "0.1", "mass must be a finite number"),
        ("inf", "0.1", "mass must be a finite number"),
    ],
)
def test_impossible_inertia(arm: Callable[..., Path], mass: str, xx: str, reason: str) -> None:
    message = analyze_file(arm(with_inertia(mass, xx)))
    assert "body 'hand'" in message
    assert reason in message


def test_inertia_that_makes_the_mass_matrix_indefinite(arm: Callable[..., Path]) -> None:
    """What the joint feels decides: here izz, about its axis."""
    message = analyze_file(arm(with_inertia("2", "0.1").replace("izz='0.1'", "izz='-0.1'")))
    assert "body 'hand'" in message
    assert "not positive definite" in message


def test_no_inertia_at_all(arm: Callable[..., Path]) -> None:
    message = analyze_file(arm(""))
    assert "body 'hand'" in message
    assert "<inertial>" in message


@pytest.mark.parametrize("number", ["NaN", "inf"])
def test_placement_that_is_not_finite(arm: Callable[..., Path], number: str) -> None:
    path = arm()
    path.write_text(path.read_text().replace("0.5 0 0", f"{number} 0 0"))
    assert "arm.urdf: a number is" in analyze_file(path)


def test_no_joints(arm: Callable[..., Path]) -> None:
    assert "has no joints" in analyze_file(arm(kind="fixed"))


BODY = (
    "<body name='{}'><joint type='{}'/><inertial mass='1' pos='0 0 1' diaginertia='1 1 1'/></body>"
)
BALL = BODY.format("hand", "ball")
PENDULUMS = BODY.format("hand", "hinge") + BODY.format("foot", "hinge")


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (f"<worldbody>{BALL}</worldbody>", "ball joint"),
        (
            f"<worldbody>{PENDULUMS}</worldbody>"
            "<equality><weld body1='hand' body2='foot'/></equality>",
            "equality weld",
        ),
    ],
)
def test_joints_that_are_not_modelled(tmp_path: Path, content: str, reason: str) -> None:
    path = tmp_path / "loop.xml"
    path.write_text(f"<mujoco>{content}</mujoco>")
    message = analyze_file(path)
    assert str(path) in message
    assert reason in message


def test_model_files_leave_no_log_behind(
    arm: Callable[..., Path], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    analyze_file(arm(with_inertia("NaN", "NaN")))
    assert [path.name for path in tmp_path.iterdir()] == ["arm.urdf"]


# Names


def test_unknown_robot_lists_the_built_in_ones() -> None:
    message = refusal("analyze", "pandora", *PANDA[1:])
    assert "pandora" in message
    assert "panda, rmin, rr" in message


def test_unknown_frame_lists_the_known_ones() -> None:
    message = analyze("--tip", "elbow")
    assert "'elbow'" in message
    for frame in load_robot("panda").frames:
        assert frame in message


def test_file_without_a_contact_frame_needs_one() -> None:
    path = example_urdf("ur5_robot.urdf")
    message = refusal("analyze", path, "--q", "[0]", "--direction", "[0, 1, 0]")
    assert "tip: " in message
    assert "tool0" in message


def test_frame_on_the_base_cannot_be_the_tip() -> None:
    assert "'link0' is fixed to the base" in analyze("--tip", "link0")


def test_unknown_set_of_rotor_inertias_lists_the_known_ones() -> None:
    message = analyze("--rotor-inertia", "drake")
    assert "'drake'" in message
    assert "drake_fr3, menagerie_fr3, menagerie_panda" in message


# Vectors


def test_wrong_length_names_the_joints() -> None:
    message = instead("--q", "[0, 1]")
    assert "q: has 2 values, but 7 are needed" in message
    assert "joint1, joint2" in message


def test_joints_of_another_branch_do_not_count() -> None:
    path = example_urdf("baxter.urdf")
    where = ("--tip", "left_gripper", "--direction", "[0, 1, 0]")
    assert "7 are needed" in refusal("analyze", path, *where, "--q", [0] * 19)


@pytest.mark.parametrize(
    ("option", "value", "reason"),
    [
        ("--q", "[0, NaN, 0, 0, 0, 0, 0]", "q: entry 2 must be finite, but is nan"),
        ("--q", "[0, 0, Infinity, 0, 0, 0, 0]", "q: entry 3 must be finite, but is inf"),
        ("--q", "[0, 0, 0, 1e999, 0, 0, 0]", "q: entry 4 must be finite, but is inf"),
        ("--q", "0.3", "q: has 1 values, but 7 are needed"),
        ("--q", '{"joint1": 0}', "q: needs a JSON list"),
        ("--q", "0, 1, 2", "q: has 3 values, but 7 are needed"),
        ("--q", "0, 1, a", "q: needs a number or a JSON list"),
        ("--q", "[0, 1", "q: needs a number or a JSON list"),
        ("--q", "", "Invalid value for --q: is empty"),
        ("--q", '[0, "a", 0, 0, 0, 0, 0]', "q: entry 2 is not a number"),
        ("--q", "[0, true, 0, 0, 0, 0, 0]", "q: entry 2 is not a number"),
        ("--q", "[[0, 1, 0, 0, 0, 0, 0]]", "q: entry 1 is not a number"),
        ("--q", "[" * 5000, "q: needs a number or a JSON list"),
        ("--q", f"[1{'0' * 400}]", "q: entry 1 is too large"),
        ("--direction", "[0, 0, 0]", "direction: must not be zero"),
        ("--direction", "[0, 1]", "direction: has 2 values, but 3 are needed"),
        ("--direction", "[0, NaN, 0]", "direction: entry 2 must be finite"),
        ("--gravity", "[0, -9.81]", "gravity: has 2 values, but 3 are needed"),
        ("--gravity", "[0, 0, -Infinity]", "gravity: entry 3 must be finite"),
    ],
)
def test_vectors(option: str, value: str, reason: str) -> None:
    assert reason in instead(option, value)


# Drives


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--joint-stiffness", "0"], "joint_stiffness: must be greater than 0"),
        (["--joint-stiffness", "[1, 1, -5, 1, 1, 1, 1]"], "entry 3 is -5"),
        (["--joint-stiffness", "[1, 1]"], "joint_stiffness: has 2 values, but 7 are needed"),
        (["--joint-stiffness", "nan"], "joint_stiffness: must not be NaN"),
        (["--joint-stiffness", "soft"], "joint_stiffness: needs a number or a JSON list"),
        (["--rotor-inertia", "-0.1"], "rotor_inertia: must be finite and ≥ 0"),
        (["--rotor-inertia", "inf"], "rotor_inertia: must be finite and ≥ 0"),
        (["--rotor-inertia", "0", "--joint-stiffness", "1e4"], "'joint1' is elastic"),
        (["--position-gain", "-1"], "position_gain: must be finite and ≥ 0"),
        (["--position-gain", "inf"], "position_gain: must be finite and ≥ 0"),
        (["--computed-torque-gain", "-1"], "computed_torque_gain: must be finite and ≥ 0"),
        (["--computed-torque-gain", "nan"], "computed_torque_gain: must be finite and ≥ 0"),
        (["--computed-torque-gain", "much"], "--computed-torque-gain"),
        (["--position-gain", "1", "--computed-torque-gain", "1"], "excludes position_gain"),
        (["--gear-ratio", "100"], "gear_ratio: needs rotor_inertia"),
        (["--rotor-inertia", "1e-5", "--gear-ratio", "0"], "gear_ratio: must be finite"),
        (["--order", "0"], "--order"),
        (["--order", "two"], "--order"),
    ],
)
def test_drives(options: list[str], reason: str) -> None:
    assert reason in analyze(*options)


def test_springs_too_soft_to_hold_the_arm() -> None:
    options = ("--joint-stiffness", "1", "--motor-angles", "--gravity", "[0, 0, -9.81]")
    assert "no static equilibrium" in analyze(*options)


def test_direction_in_which_the_robot_cannot_move() -> None:
    planar = refusal("analyze", "rr", "--q", "[0, 0, 1, 0]", "--direction", "[0, 0, 1]")
    assert "cannot move along direction [0, 0, 1]" in planar
    stretched = refusal("analyze", "rr", "--q", "[0.3, 0, 0, 0]", "--direction", _along(0.3))
    assert "cannot move along direction" in stretched


def _along(angle: float) -> str:
    return str([math.cos(angle), math.sin(angle), 0.0])


# The command line itself


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["analyse"], "No such command 'analyse'. Did you mean 'analyze'?"),
        (["analyze"], "Missing argument"),
        (["analyze", *PANDA, "--stiffness", "1"], "No such option: --stiffness"),
        (["analyze", "panda", "--q", Q], "Missing option '--direction'"),
        (["analyze", *PANDA, "--tip", ""], "Invalid value for --tip: is empty"),
        (["analyze", *PANDA, "--tip="], "Invalid value for --tip: is empty"),
        (
            ["simulate", *PANDA, "--region", "chest", "--speed", "1", "--horizon", "1e4"],
            "10 s",
        ),
        (["reproduce", "--out", "x", "--paper", "mms"], "for '--paper': 'mms' is not one of"),
    ],
)
def test_usage(words: list[str], reason: str) -> None:
    assert reason in refusal(*words)


def test_interruption(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("softimpact.symbolic.analyse", interrupted)
    outcome = run("analyze", *PANDA)
    assert (outcome.code, outcome.out) == (130, "")


def test_failed_solver_has_its_own_exit_code(monkeypatch: pytest.MonkeyPatch) -> None:
    class SolverGaveUp(Exception):
        exit_code = 3

    def fail(*_: object, **__: object) -> None:
        raise SolverGaveUp("status: Infeasible_Problem_Detected,\nbest feasible force 400 N")

    monkeypatch.setattr("softimpact.symbolic.analyse", fail)
    outcome = run("analyze", *PANDA)
    assert (outcome.code, outcome.out) == (3, "")
    assert outcome.err == (
        "error: status: Infeasible_Problem_Detected, best feasible force 400 N\n"
    )


def test_our_own_mistakes_are_not_dressed_up(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("softimpact.symbolic.analyse", broken)
    with pytest.raises(ZeroDivisionError):
        run("analyze", *PANDA)


def test_folder_that_cannot_be_written(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device", "/data/out")

    monkeypatch.setattr("softimpact.symbolic.analyse", full)
    assert refusal("analyze", *PANDA) == "error: /data/out: No space left on device\n"


def test_a_full_disk_behind_stdout_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("softimpact.studio.output.printed.print_json", full)
    lost = "error: the result cannot be written: No space left on device\n"
    assert refusal("analyze", *PANDA, "--json") == lost


def test_main_reads_the_process_arguments(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["softimpact", "analyze", "pandora"])
    assert cli.main() == 2


def test_names_are_asked_of_a_literal() -> None:
    """A checker does not see it: an option's type taken for the names would refuse all of them."""
    with pytest.raises(TypeError, match="no Literal"):
        one_of("number type", "double", RealOption)
