# SPDX-License-Identifier: BSD-3-Clause
"""Closed chains, and contact points on any body, from the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from command_line import refusal, run_json
from mechanisms import FOUR_BAR, PARALLELOGRAM, THIRD_CRANK

RMIN = ("analyze", "rmin", "--direction", "[1, 0, 0]", "--gravity", "[0, 0, -9.81]")
MOTORS = ("--motor-angles", "--q", "[-2.279400, -0.872665]")
USUAL = {"tilt": "0", "crank": "0.2", "length": "0.5", "lift": "0", "more": "", "equality": ""}


def four_bar(folder: Path, **changes: str) -> str:
    path = folder / "four_bar.xml"
    path.write_text(FOUR_BAR.format(**(USUAL | {"key": "1 -0.4 1.7"} | changes)))
    return str(path)


def test_rmin_from_its_motor_angles() -> None:
    result = run_json(*RMIN, *MOTORS)
    assert result["m_c"] == pytest.approx(1.171, abs=1e-3)
    assert len(result["q"]) == len(result["joints"]) == 6
    again = run_json(*RMIN, "--q", json.dumps(result["q"]))
    assert again["k_r"] == pytest.approx(result["k_r"], rel=1e-6)
    assert run_json(*RMIN, *MOTORS, "--tip", "O13")["m_c"] == pytest.approx(0.4386, abs=1e-4)


def test_any_point_of_any_body() -> None:
    elbow = run_json(*RMIN, *MOTORS, "--tip", "O13")
    same = run_json(*RMIN, *MOTORS, "--tip", "link12@0.2,0,0")
    assert same["m_c"] == pytest.approx(elbow["m_c"], rel=1e-12)
    between = run_json(*RMIN, *MOTORS, "--tip", "link12@0.1,0,0.03")
    assert between["tip"] == "link12@0.1,0,0.03"
    assert between["m_c"] != pytest.approx(elbow["m_c"], rel=0.1)


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ((*MOTORS, "--tip", "link99@0,0,0.1"), "unknown frame 'link99'; known: link11, link12"),
        ((*MOTORS, "--tip", "link12@0,0"), "three finite numbers: FRAME@x,y,z"),
        ((*MOTORS, "--tip", "link12@0,0,high"), "three finite numbers"),
        (("--q", "[0, 0, 0, 0, 0, 0]"), "loop 'end_point' does not close"),
        (("--q", "[0, 0, 0]"), "q: has 3 values, but 6 are needed"),
        (("--motor-angles", "--q", "[0, 0, 0]"), "has 3 values, but 2 are needed"),
        (("--motor-angles", "--q", "[3.1416, 0]"), "loop 'end_point' does not close"),
        (
            (*MOTORS, "--joint-stiffness", "[9, 9, 9, 9, 9, 9]"),
            "joint 'q12' follows",
        ),
    ],
)
def test_what_may_go_wrong_with_rmin(options: tuple[str, ...], reason: str) -> None:
    assert reason in refusal(*RMIN, *options)


def test_an_arm_that_cannot_hold_itself(tmp_path: Path) -> None:
    from softimpact.robots import built_in_robots

    soft = tmp_path / "soft.xml"
    text = built_in_robots()["rmin"].read_text()
    soft.write_text(text.replace('stiffness="351"', 'stiffness="0.5"'))
    where = ("analyze", soft, "--direction", "[1, 0, 0]", *MOTORS)
    message = refusal(*where, "--gravity", "[0, 0, 9.81]")
    assert "no static equilibrium" in message
    assert "too soft for the arm to hold itself" in message


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"length": "0.1", "crank": "0.05"}, "loop 'pin' does not close"),
        ({"lift": "0.01"}, "no joint moves them along"),
        (THIRD_CRANK, "loop 'third' is redundant"),
    ],
)
def test_loops_that_are_wrong(changes: dict[str, str], reason: str, tmp_path: Path) -> None:
    where = ("analyze", four_bar(tmp_path, **changes), "--direction", "[1, 0, 0]", "--q")
    assert reason in refusal(*where, "[1, -1, 1, 1]" if "more" in changes else "[1, -1, 1]")


def test_a_parallelogram(tmp_path: Path) -> None:
    path = four_bar(tmp_path, **PARALLELOGRAM)
    found = run_json("analyze", path, "--q", "[1, -1, 1]", "--direction", "[0.8, -0.5, 0]")
    assert found["m_c"] > 0
    assert len(found["mass_matrix"]) == 1
    assert found["m_a"] is None
