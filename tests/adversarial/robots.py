# SPDX-License-Identifier: BSD-3-Clause
"""Robots whose packages the adversarial search looks at."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from compiled_packages import Generated
from mechanisms import FIVE_BAR, robot_of
from oracles import example_urdf
from small_arm import ARM

from softimpact.codegen import generate_package
from softimpact.symbolic import Robot, arm_of, drives, load_robot

TWO_LINKS = """<mujoco><compiler angle="radian"/><worldbody>
  <body name="upper"><joint name="q1" axis="0 0 1" range="-3 3" armature=".3"/>
    <inertial mass="10" pos=".5 0 0" diaginertia=".01 .8333 .8333"/>
    <body name="lower" pos="1 0 0"><joint name="q2" axis="0 0 1" range="-3 3" armature=".3"/>
      <inertial mass="10" pos=".5 0 0" diaginertia=".01 .8333 .8333"/>
      <site name="tip" pos="1 0 0"/>
    </body></body></worldbody></mujoco>"""


def two_links() -> Robot:
    """Return RR's links, turned by motors through springs that are inputs."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "two_links.xml")
        path.write_text(TWO_LINKS, encoding="utf-8")
        return replace(load_robot(path), tip="tip")


def solo12() -> Robot:
    """Return a leg of Solo12, whose rotors are a guess."""
    leg = arm_of(load_robot(example_urdf("solo12.urdf")), "FL_FOOT").robot
    return replace(leg, tip="FL_FOOT")


def cold() -> Robot:
    """Return an arm of three joints, which damp as much as gears with cold grease."""
    dampings = {"turn": 8.0, "lift": 3.0, "bend": 0.5}
    text = ARM
    for name, damping in dampings.items():
        text = text.replace(f"name='{name}'", f"name='{name}' damping='{damping}'", 1)
    return _arm(text)


def _arm(text: str) -> Robot:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "arm.xml")
        path.write_text(text, encoding="utf-8")
        return replace(load_robot(path), tip="tool")


def five_bar() -> Robot:
    """Return two motors that move a point in a plane through a closed chain."""
    with tempfile.TemporaryDirectory() as folder:
        return robot_of(Path(folder), FIVE_BAR)


ROBOTS: dict[str, Callable[[], Robot]] = {
    "panda": lambda: load_robot("panda"),
    "ur5e": lambda: load_robot("ur5e"),
    "solo12": solo12,
    "two_links": two_links,
    "rr": lambda: load_robot("rr"),
    "rmin": lambda: load_robot("rmin"),
    "gen3": lambda: load_robot("gen3"),
    "iiwa14": lambda: load_robot("iiwa14"),
    "xarm7": lambda: load_robot("xarm7"),
    "hanging": lambda: load_robot("ur5e"),
    "cold": cold,
    "five_bar": five_bar,
}
"""By name: elastic arms, a leg, two links in a plane, passive joints, closed loops, gravity, joints
that damp."""


CLOSED = ("rmin", "five_bar")
"""Robots whose links' frames packages do not know."""


def package_of(name: str, folder: Path) -> Generated:
    """Return the package of a robot by name, generated anew."""
    robot = ROBOTS[name]()
    known = drives(robot, rotor_inertia=0.1) if name == "solo12" else None
    pull = (0.0, 0.0, -9.81) if name == "hanging" else None
    manifest = generate_package(robot, folder, name=name, drives=known, gravity=pull)
    return Generated(robot, str(robot.tip), folder, manifest)
