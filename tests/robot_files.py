# SPDX-License-Identifier: BSD-3-Clause
"""Small robots as MJCF and URDF texts with parts to replace."""

from __future__ import annotations

from typing import Protocol

from softimpact.symbolic import Robot


class Read(Protocol):
    """Loads a robot from a text, see ``load_robot``."""

    def __call__(self, text: str, suffix: str = ".xml", *, tip: str | None = None) -> Robot:
        """Write the text to a file with a suffix and load that."""
        ...


ARM = """
<mujoco>
  <custom><text name="tip" data="hand"/>{custom}</custom>
  <asset>{asset}</asset>
  <worldbody>
    <body name="arm"><joint name="j1" {joint}/>
      <inertial pos="{com}" mass="{mass}" diaginertia="{inertia}"/>{inside}
      <body name="hand" pos="0 0 1"/>
    </body>
  </worldbody>{after}
</mujoco>
"""
PLAIN = {"mass": "1", "inertia": "1 1 1", "com": "0.1 0 0"}

URDF = """
<robot name="r"><link name="world"/>
  <link name="arm">
    <inertial><origin xyz="0 0 0.1" rpy="0 0 0.3"/><mass value="{mass}"/>
      <inertia ixx="0.02" iyy="0.03" izz="{izz}" ixy="0.001" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="package://nowhere/arm.dae"/></geometry></visual>
    <collision><geometry><mesh filename="missing/arm.stl"/></geometry></collision>
  </link>
  <link name="tool"/>
  <joint name="j1" type="{kind}"><parent link="world"/><child link="arm"/>
    <origin xyz="0 0 1" rpy="0 1.5707963267948966 0"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="2" effort="1" velocity="1"/></joint>
  <joint name="fix" type="fixed"><parent link="arm"/><child link="tool"/>
    <origin xyz="0.5 0 0"/></joint>
</robot>
"""


def arm(**changes: str) -> str:
    """Return a one-joint MJCF with some of its parts replaced."""
    empty = dict.fromkeys(("custom", "asset", "joint", "inside", "after"), "")
    return ARM.format(**empty | PLAIN | changes)
