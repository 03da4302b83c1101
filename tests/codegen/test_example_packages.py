# SPDX-License-Identifier: BSD-3-Clause
"""Packages of robots that others described pass their own tests."""

from __future__ import annotations

from pathlib import Path

import pytest
from compiled_packages import Generated
from oracles import example_urdf

from softimpact.codegen import generate_package
from softimpact.symbolic import arm_of, drives, load_robot

ARMS = {
    "solo12.urdf": "FL_FOOT",
    "kinova.urdf": "j2s6s200_end_effector",
    "icub.urdf": "r_hand",
    "panda.urdf": "panda_rightfinger",  # a finger that follows the other
    "baxter.urdf": "r_gripper_r_finger",  # likewise
    "ur5_robot.urdf": "tool0",
    "xarm7.urdf": "link_eef",
    "talos_left_arm.urdf": "gripper_left_base_link",
    "z1.urdf": "link06",
    "romeo_small.urdf": "r_wrist",
}
"""Contact frames of a sample of ``example-robot-data``."""


@pytest.mark.slow
@pytest.mark.parametrize("name", ARMS)
def test_packages_of_example_robots(name: str, tmp_path: Path) -> None:
    arm = arm_of(load_robot(example_urdf(name)), ARMS[name]).robot
    known = drives(arm, rotor_inertia=0.1)
    folder = tmp_path / "package"
    manifest = generate_package(arm, folder, name="arm", drives=known)
    package = Generated(arm, ARMS[name], folder, manifest)
    assert "all passed" in package.run_own_test("gcc", "double", tmp_path / "test")
