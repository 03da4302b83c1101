# SPDX-License-Identifier: BSD-3-Clause
"""Motions as people's tools write them, and what is none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from softimpact.studio.program.motion_file import MotionFileError, read_motion
from softimpact.symbolic import InvalidValue, load_robot

UR = load_robot("ur5e")
NAMES = ",".join(UR.joint_names)


def written(path: Path, text: str) -> Path:
    file = path / "motion.csv"
    file.write_bytes(text.encode())
    return file


def test_columns_in_any_order(tmp_path: Path) -> None:
    names = [*reversed(UR.joint_names), "t"]
    text = f"{','.join(names)}\n6,5,4,3,2,1,0\n6,5,3.1,3,2,1.5,0.5\n"
    found, warnings = read_motion(written(tmp_path, text), UR)
    np.testing.assert_array_equal(found.time, [0, 0.5])
    np.testing.assert_array_equal(found.q, [[1, 2, 3, 4, 5, 6], [1.5, 2, 3, 3.1, 5, 6]])
    assert warnings == []


@pytest.mark.parametrize(
    "change",
    [
        lambda text: "\ufeff" + text,
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.replace(",", ";"),
        lambda text: text.replace(",", "\t"),
        lambda text: text.replace(",", " , "),
        lambda text: text.rstrip("\n"),
    ],
    ids=["bom", "crlf", "semicolons", "tabs", "spaces", "no last line end"],
)
def test_as_other_tools_write(tmp_path: Path, change: object) -> None:
    assert callable(change)
    text = change(f"t,{NAMES}\n0,0,0,0,0,0,0\n1,1,0,0,0,0,0\n")
    found, _ = read_motion(written(tmp_path, text), UR)
    np.testing.assert_array_equal(found.q[:, 0], [0, 1])


def test_joints_off_the_arm_and_angles_beyond_limits_are_named(tmp_path: Path) -> None:
    text = f"t,{NAMES},finger\n0,0,0,3.5,0,0,0,0\n1,1,0,0,0,0,0,0\n"
    _, warnings = read_motion(written(tmp_path, text), UR, ("finger",))
    assert len(warnings) == 2
    assert "'finger' is of no joint of the arm" in warnings[0]
    assert "'elbow_joint' goes from 0 to 3.5, beyond its limits" in warnings[1]


ROW = "0,0,0,0,0,0,0"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "has no column 't'"),
        (f"time,{NAMES}\n{ROW}\n", "has no column 't' in its first line; needs the columns t, sho"),
        (f"t,{NAMES}\n", "holds no samples"),
        ("t,shoulder_pan_joint\n0,0\n", "has no column for joint 'shoulder_lift_joint', 'elb"),
        (f"t,{NAMES},nose\n{ROW},0\n", "has unknown columns 'nose'"),
        (f"t,t,{NAMES}\n0,{ROW}\n", "has two columns 't'"),
        (f"t,{NAMES}\n{ROW}\n1,a,0,0,0,0,0\n", "could not convert string 'a'"),
        (f"t,{NAMES}\n{ROW}\n1,a,0,0,0,0,0\n", "in line 3"),
        (f"t,{NAMES}\n{ROW}\n1,0\n", "changed from 7 to 2 in line 3"),
        (f"t;{NAMES}\n{ROW}\n".replace(",", ";").replace("0;0", "0,5;0", 1), "need a point"),
        (f"t,{NAMES}\n{ROW}\n1,0\n", "below its first line"),
        (f"t,{NAMES}\n0,0\n1,0\n", "has 7 names in its first line, but 2 numbers below"),
        (f"t,{NAMES}\n{ROW}\n1,90,-45,120,0,0,0\n", "look like degrees"),
    ],
)
def test_what_is_no_motion(tmp_path: Path, text: str, reason: str) -> None:
    with pytest.raises(MotionFileError, match=reason):
        read_motion(written(tmp_path, text), UR)


def test_bytes_that_are_no_text(tmp_path: Path) -> None:
    path = tmp_path / "motion.csv"
    path.write_bytes(b"\xff\xfe\x00t")
    with pytest.raises(MotionFileError, match="not a text file"):
        read_motion(path, UR)


def test_time_that_does_not_rise(tmp_path: Path) -> None:
    with pytest.raises(InvalidValue, match="t: must rise"):
        read_motion(written(tmp_path, f"t,{NAMES}\n{ROW}\n{ROW}\n"), UR)
