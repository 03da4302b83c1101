# SPDX-License-Identifier: BSD-3-Clause
"""Small robots as MJCF and URDF texts with parts to replace."""

from __future__ import annotations

from collections.abc import Sequence
from random import Random
from typing import Protocol

from softimpact.symbolic import Robot, arm_of, impact_model, whole_configuration


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


TWO_LINKS = """
<mujoco model="two">
  <compiler angle="radian" {compiler}/>
  {before}
  <worldbody>
    {beside}
    <body name="upper" {upper}>
      <joint name="j1" axis="0 0 1" {j1}/>
      <inertial pos="0.2 0 0" mass="2" diaginertia="0.01 0.02 0.02"/>
      {on_upper}
      <body name="fore" pos="0.4 0 0">
        <joint name="j2" axis="0 0 1" {j2}/>
        {inertial}
        {on_fore}
        <site name="tool" pos="0.3 0 0"/>
      </body>
    </body>
  </worldbody>
  {after}
</mujoco>
"""
FORE = '<inertial pos="0.15 0 0" mass="1" diaginertia="0.005 0.01 0.01"/>'

TWO_LINKS_URDF = """<?xml version="1.0"?>
<robot name="two" {top}>
  {before}
  <link name="base">{base}</link>
  <link name="upper">{upper}</link>
  <link name="fore">{fore}</link>
  <link name="tool">{tool}</link>
  <joint name="j1" type="{type1}"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    {limit}{on_j1}</joint>
  <joint name="{second}" type="revolute"><parent link="upper"/><child link="fore"/>
    <origin xyz="0.4 0 0"/><axis xyz="0 0 1"/>{limit2}{on_j2}</joint>
  <joint name="jt" type="fixed"><parent link="fore"/><child link="tool"/>
    <origin xyz="0.3 0 0"/></joint>
  {after}
</robot>
"""


def urdf_inertial(
    mass: str, x: str, ixx: str = "0.01", iyy: str = "0.02", izz: str = "0.02"
) -> str:
    """Return a URDF inertial element on the x axis."""
    return (
        f'<inertial><origin xyz="{x} 0 0"/><mass value="{mass}"/>'
        f'<inertia ixx="{ixx}" iyy="{iyy}" izz="{izz}" ixy="0" ixz="0" iyz="0"/></inertial>'
    )


URDF_LIMIT = '<limit lower="-3" upper="3" effort="50" velocity="2"/>'


def two_links(**changes: str) -> str:
    """Return a planar arm of two links as MJCF, with some of its parts replaced."""
    parts = ("compiler", "before", "beside", "upper", "j1", "on_upper", "j2", "on_fore", "after")
    return TWO_LINKS.format(**dict.fromkeys(parts, "") | {"inertial": FORE} | changes)


def two_links_urdf(**changes: str) -> str:
    """Return a planar arm of two links as URDF, with some of its parts replaced."""
    empty = ("top", "before", "base", "tool", "on_j1", "on_j2", "after")
    plain = {
        "upper": urdf_inertial("2", "0.2"),
        "fore": urdf_inertial("1", "0.15"),
        "limit": URDF_LIMIT,
        "limit2": URDF_LIMIT,
        "second": "j2",
        "type1": "revolute",
    }
    return TWO_LINKS_URDF.format(**dict.fromkeys(empty, "") | plain | changes)


def many_joints(count: int) -> str:
    """Return an arm of many joints in general position, with a tool, as URDF."""
    random = Random(1)

    def numbers(low: float, high: float) -> str:
        return " ".join(f"{random.uniform(low, high):.3f}" for _ in range(3))

    parts = ['<robot name="long_arm"><link name="l0"/>']
    for i in range(1, count + 1):
        parts.append(
            f'<link name="l{i}"><inertial><origin xyz="{numbers(-0.05, 0.1)}"/><mass value="1"/>'
            '<inertia ixx="0.005" iyy="0.006" izz="0.004" ixy="0.0003" ixz="0.0001" iyz="0"/>'
            f'</inertial></link><joint name="j{i}" type="revolute"><parent link="l{i - 1}"/>'
            f'<child link="l{i}"/><axis xyz="0 0 1"/>'
            f'<origin xyz="{numbers(-0.1, 0.2)}" rpy="{numbers(-3, 3)}"/>'
            '<limit lower="-2.5" upper="2.5" effort="50" velocity="3"/></joint>'
        )
    parts.append(
        '<link name="tool"/><joint name="fix" type="fixed"><origin xyz="0 0 0.1"/>'
        f'<parent link="l{count}"/><child link="tool"/></joint></robot>'
    )
    return "\n".join(parts)


def felt(
    robot: Robot,
    q: Sequence[float] = (0.3, 1.2),
    direction: Sequence[float] = (1.0, 0.0, 0.0),
    tip: str = "tool",
) -> float:
    """Mass felt at a frame with rigid joints [kg]."""
    arm = arm_of(robot, tip).robot
    return float(impact_model(arm).reflected_mass(whole_configuration(arm, q), direction))
