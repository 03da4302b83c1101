# SPDX-License-Identifier: BSD-3-Clause
"""Motions from waypoints with speeds."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles import column

from softimpact.studio.program.motion_file import MotionFileError
from softimpact.studio.program.waypoints import JOINT_STEP, PLACE_STEP, read_waypoints
from softimpact.symbolic import SoftImpactError, frame_pose, load_robot

UR = load_robot("ur5e")
A, B, C = [0.1, -1, 1, 0, 0, 0], [0.8, -1.2, 1.1, 0.2, 0, 0], [0.8, -1.2, 1.1, 0.2, 0, 1.0]


def written(path: Path, content: Any) -> Path:
    file = path / "motion.json"
    file.write_text(content if isinstance(content, str) else json.dumps(content))
    return file


def test_the_end_moves_at_the_speed_that_was_said(tmp_path: Path) -> None:
    content = {"waypoints": [{"q": A}, {"q": B, "speed": 0.5}, {"q": A}], "speed": 0.25}
    moved = read_waypoints(written(tmp_path, content), UR)
    places = np.array([column(frame_pose(UR, "flange", q).position) for q in moved.q])
    way = np.linalg.norm(np.diff(places, axis=0), axis=1)
    speed = way / np.diff(moved.time)
    turn = int(np.argmin(np.linalg.norm(moved.q - B, axis=1)))
    np.testing.assert_allclose(speed[:turn], 0.5)
    np.testing.assert_allclose(speed[turn:], 0.25)
    assert way.max() <= PLACE_STEP * 1.01
    assert abs(np.diff(moved.q, axis=0)).max() <= JOINT_STEP * 1.0001
    np.testing.assert_allclose(moved.q[[0, turn, -1]], [A, B, A])


def test_joints_by_name_and_a_way_by_its_time(tmp_path: Path) -> None:
    named = dict(zip(UR.joint_names, C, strict=True))
    content = {"waypoints": [{"q": B}, {"q": named, "time": 0.5}]}
    moved = read_waypoints(written(tmp_path, content), UR)
    assert moved.time[-1] == pytest.approx(0.5)
    np.testing.assert_allclose(moved.q[-1], C)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("{", "not valid JSON"),
        ([], "must be a table of fields"),
        ({"waypoints": [{"q": A}]}, "waypoints: needs 2, not 1"),
        ({"waypoints": [{"q": A}, {"q": B}]}, "waypoint 2 has neither a speed nor a time"),
        ({"waypoints": [{"q": A}, {"q": B, "speed": -1}]}, r"waypoints\.1\.speed: must be"),
        ({"waypoints": [{"q": A}, {"q": B, "speed": 1, "time": 1}]}, "give either speed"),
        ({"waypoints": [{"q": B}, {"q": C, "speed": 1}]}, "the arm's end stays where it is"),
        ({"waypoints": [{"q": A}, {"q": B[:3], "speed": 1}]}, r"waypoints\.1\.q: has 3 values"),
        ({"waypoints": [{"q": {"elbow": 1}}, {"q": B}], "speed": 1}, "waypoint 1 has no joint"),
        ({"waypoints": [{"q": A}, {"q": B, "v": 1}]}, r"waypoints\.1\.v: Extra inputs"),
    ],
)
def test_what_is_no_motion(tmp_path: Path, content: Any, reason: str) -> None:
    with pytest.raises(SoftImpactError, match=reason):
        read_waypoints(written(tmp_path, content), UR)


@pytest.mark.parametrize("angle", [float("nan"), float("inf"), 1e300, 180.0])
def test_angles_that_are_none(tmp_path: Path, angle: float) -> None:
    text = json.dumps({"waypoints": [{"q": A}, {"q": [*B[:5], angle]}], "speed": 1})
    with pytest.raises(MotionFileError, match="waypoint 2 must hold finite angles in radians"):
        read_waypoints(written(tmp_path, text), UR)
