# SPDX-License-Identifier: BSD-3-Clause
"""Closed chains as MJCF: a four-bar, a five-bar, a spatial linkage, and some that are wrong."""

from __future__ import annotations

from pathlib import Path

from softimpact.symbolic import Robot, load_robot

FOUR_BAR = """
<mujoco model="four_bar">
  <custom><text name="tip" data="tool"/></custom>
  <worldbody>
    <body name="crank" euler="0 0 {tilt}"><joint name="crank" axis="0 0 1" armature="0.02"/>
      <inertial mass="0.8" pos="0.1 0.01 0" diaginertia=".004 .004 .006"/>
      <body name="coupler" pos="{crank} 0 0"><joint name="coupler" axis="0 0 1"/>
        <inertial mass="0.6" pos="0.2 0.03 0" diaginertia=".003 .003 .005"/>
        <site name="pin" pos="{length} 0 {lift}"/><site name="tool" pos="0.3 0.2 0"/>
        <site name="middle" pos="0.3 0 0"/>
      </body>
    </body>
    <body name="rocker" pos="0.6 0 0"><joint name="rocker" axis="0 0 1" stiffness="40"
        springref="1.5"/>
      <inertial mass="0.9" pos="0.2 0 0" diaginertia=".005 .005 .008"/>
      <site name="eye" pos="0.4 0 0"/>
    </body>{more}
  </worldbody>
  <equality><connect name="pin" site1="pin" site2="eye"/>{equality}</equality>
  <actuator><motor joint="crank"/></actuator>
  <keyframe><key qpos="{key}"/></keyframe>
</mujoco>
"""
"""Crank, coupler and rocker; the crank has the motor, the rocker a spring."""

FIVE_BAR = """
<mujoco model="five_bar">
  <compiler angle="radian"/>
  <custom><text name="tip" data="end"/></custom>
  <worldbody>
    <body name="left" euler="0.5 -0.3 0.2">
      <body name="a1"><joint name="a1" axis="0 0 1"/>
        <inertial mass="1" pos=".1 0 0" diaginertia=".01 .01 .01"/>
        <body name="a2" pos="0 .3 0"><joint name="a2" axis="0 0 1" stiffness="5"/>
          <inertial mass=".5" pos=".1 0 0" diaginertia=".003 .003 .004"/>
          <site name="end" pos=".4 .1 0"/>
        </body>
      </body>
      <body name="b1" pos=".5 0 0"><joint name="b1" axis="0 0 1"/>
        <inertial mass="1.1" pos="0 .1 0" diaginertia=".011 .01 .01"/>
        <body name="b2" pos=".1 .3 0"><joint name="b2" axis="0 0 1"/>
          <inertial mass=".4" pos="-.1 0 0" diaginertia=".002 .003 .003"/>
        </body>
      </body>
    </body>
  </worldbody>
  <equality><connect body1="a2" body2="b2" anchor=".4 .1 0"/></equality>
  <actuator><motor joint="a1"/><motor joint="b1"/></actuator>
</mujoco>
"""
"""Two motors move a point in a tilted plane; closed at zero, which fixes the anchors."""

SPATIAL = """
<mujoco model="spatial">
  <compiler angle="radian"/>
  <custom><text name="tip" data="a2"/></custom>
  <worldbody>
    <body name="a1"><joint name="a1" axis="0 0 1"/>
      <inertial mass="1" pos=".1 0 0" diaginertia=".01 .01 .01"/>
      <body name="a2" pos=".3 0 .1"><joint name="a2" axis="0 1 .2"/>
        <inertial mass=".5" pos=".1 0 0" diaginertia=".003 .003 .004"/>
        <body name="a3" pos=".2 .1 0"><joint name="a3" axis="1 .3 0" stiffness="8"/>
          <inertial mass=".3" pos=".1 0 0" diaginertia=".002 .002 .002"/>
        </body>
      </body>
    </body>
    <body name="b1" pos=".7 .1 0"><joint name="b1" axis="0 .1 1"/>
      <inertial mass=".9" pos="0 .1 0" diaginertia=".011 .01 .01"/>
      <body name="b2" pos="0 .2 0"><joint name="b2" type="slide" axis=".2 1 0"/>
        <inertial mass=".4" pos="-.1 0 0" diaginertia=".002 .003 .003"/>
      </body>
    </body>
  </worldbody>
  <equality><connect name="ball" body1="a3" body2="b2" anchor=".2 .05 .1"/></equality>
  <actuator><motor joint="a1"/><motor joint="b1"/></actuator>
</mujoco>
"""
"""A loop that is not planar: hinges in space and a slide, joined by a ball."""


def four_bar(folder: Path, **changes: str) -> Robot:
    """Return the four-bar, or a variant of it."""
    usual = dict.fromkeys(("more", "equality"), "") | {
        "tilt": "0",
        "crank": "0.2",
        "length": "0.5",
        "lift": "0",
        "key": "1 -0.4 1.7",
    }
    return robot_of(folder, FOUR_BAR.format(**(usual | changes)))


def robot_of(folder: Path, text: str) -> Robot:
    """Write an MJCF file and load it."""
    path = folder / "mechanism.xml"
    path.write_text(text)
    return load_robot(path)


PARALLELOGRAM = {"crank": "0.4", "length": "0.6", "key": "1 -1 1"}

SIX_BAR = {
    "key": "1 -0.4 1.7 1.9 0.8",
    "more": """
    <body name="lever" pos="1.1 0 0"><joint name="lever" axis="0 0 1"/>
      <inertial mass="1" pos="0.2 0 0" diaginertia=".01 .01 .01"/>
      <body name="link" pos="0.4 0 0"><joint name="link" axis="0 0 1" stiffness="3"/>
        <inertial mass="0.5" pos="0.2 0 0" diaginertia=".004 .004 .005"/>
        <site name="hook" pos="0.45 0 0"/>
      </body>
    </body>""",
    "equality": '<connect name="hook" site1="eye" site2="hook"/>',
}
"""A second loop behind the rocker of the four-bar."""

THIRD_CRANK = PARALLELOGRAM | {
    "key": "1 -1 1 1",
    "more": """
    <body name="third" pos="0.3 0 0"><joint name="third" axis="0 0 1"/>
      <inertial mass="1" pos="0.2 0 0" diaginertia=".01 .01 .01"/><site name="third" pos="0.4 0 0"/>
    </body>""",
    "equality": '<connect name="third" site1="middle" site2="third"/>',
}
"""One crank too many, which a parallelogram bears because all three stay parallel."""
