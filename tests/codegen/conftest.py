# SPDX-License-Identifier: BSD-3-Clause
"""Packages that many tests look at."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
from compiled_packages import Generated, candidate_poses
from oracles import example_urdf
from sharing import once

from softimpact.codegen import generate_package
from softimpact.symbolic import Robot, chain_to, load_robot

GANTRY = """
<mujoco model="Gantry-2">
  <worldbody>
    <body name="beam"><joint name="x" type="slide" axis="1 0 0" range="-1 1" armature="2"/>
      <inertial mass="8" pos="0 0 0" diaginertia=".4 .5 .6"/>
      <body name="arm" pos="0 0 .5" euler="0 30 0"><joint name="turn" axis="0 0 1" armature=".3"/>
        <inertial mass="3" pos=".1 0 .2" diaginertia=".03 .04 .02"/>
        <body name="probe" pos=".4 0 0"><joint name="z" type="slide" axis="0 .6 .8" armature="1"/>
          <inertial mass="1" pos="0 0 .1" diaginertia=".01 .01 .005"/>
          <site name="tip" pos="0 .1 .3"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="session")
def package(
    shared_folder: Path, tmp_path_factory: pytest.TempPathFactory
) -> Callable[[str], Generated]:
    """Return the package of a robot by name; it is generated once in a test run."""
    root = tmp_path_factory.mktemp("robots")

    def load(name: str) -> tuple[Robot, str]:
        if name == "gantry":
            path = root / "gantry.xml"
            path.write_text(GANTRY)
            return load_robot(path), "tip"
        if name == "ur5":
            robot = load_robot(example_urdf("ur5_robot.urdf"))
            return robot.with_armature([0.5] * robot.n), "tool0"
        if name == "baxter":  # two arms; masses off the chain stay
            robot = chain_to(load_robot(example_urdf("baxter.urdf")), "left_gripper_base_link")
            return robot.with_armature([0.2] * robot.n), "left_gripper_base_link"
        if name == "ur5_wrist":
            return load_robot(example_urdf("ur5_robot.urdf")), "wrist_1_link"
        robot = load_robot(name)
        return robot, str(robot.tip)

    @cache
    def generated(name: str) -> Generated:
        robot, tip = load(name)
        folder = shared_folder / "packages" / name
        poses = candidate_poses(name, robot)
        manifest = once(folder, lambda at: generate_package(robot, at, tip=tip, poses=poses))
        return Generated(robot, tip, folder, manifest)

    return generated
