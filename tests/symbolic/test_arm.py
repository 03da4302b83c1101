# SPDX-License-Identifier: BSD-3-Clause
"""Which joints an impact moves: all on the way to the arm's end, also beyond the contact point."""

from __future__ import annotations

import numpy as np
import pytest
from oracles import assert_near

from softimpact.symbolic import Robot, arm_of, frame_pose, load_robot


@pytest.mark.parametrize("point", ["link2", "link5", "flange", "hand_tcp"])
def test_the_end_is_the_robots_own_where_the_contact_lies_on_the_way(
    panda: Robot, point: str
) -> None:
    arm = arm_of(panda, point)
    assert (arm.end, arm.robot.tip, arm.robot.n, arm.warnings) == ("hand_tcp", point, 7, ())
    q = np.linspace(-1, 0.5, 7)
    there, expected = (frame_pose(robot, point, q).position for robot in (arm.robot, panda))
    assert_near(there, expected)


def test_elsewhere_the_contact_is_the_end_and_what_is_beyond_is_welded_with_a_word() -> None:
    arm = arm_of(load_robot("mini_cheetah"), "thigh_fr")  # its own tip is another leg's foot
    assert (arm.end, arm.robot.n) == ("thigh_fr", 2)
    line, held = arm.warnings
    assert "3.52 kg, at which 4 chains of joints start) is taken as held" in held
    assert "joint 'knee_fr' is beyond the contact point 'thigh_fr' welded" in line


def test_an_end_that_is_named_counts(panda: Robot) -> None:
    arm = arm_of(panda, "link3", "link5")
    assert (arm.end, arm.robot.n) == ("link5", 5)
