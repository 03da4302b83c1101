# SPDX-License-Identifier: BSD-3-Clause
"""A study of an arm with three joints, which compiles and solves in moments."""

from __future__ import annotations

from pathlib import Path

from softimpact.optimize import Study, load_study

ARM = """<mujoco><compiler angle='radian'/><worldbody>
<body><joint name='turn' axis='0 0 1' armature='0.4' range='-2.8 2.8'/>
  <inertial mass='4' pos='0 0 0.1' diaginertia='0.04 0.04 0.02'/>
  <body pos='0 0 0.3'><joint name='lift' axis='0 1 0' armature='0.3' range='-2.8 2.8'/>
    <inertial mass='3' pos='0.2 0.01 0' diaginertia='0.02 0.05 0.05'/>
    <body pos='0.4 0 0'><joint name='bend' axis='0 1 0' armature='0.1' range='-2.8 2.8'/>
      <inertial mass='2' pos='0.15 0 0.02' diaginertia='0.01 0.03 0.03'/>
      <site name='tool' pos='0.35 0 0'/>
</body></body></body></worldbody>
<actuator><motor joint='turn' forcerange='-80 80'/><motor joint='lift' forcerange='-80 80'/>
<motor joint='bend' forcerange='-40 40'/></actuator></mujoco>
"""

STUDY = """
title = "Three joints"
{objective}
[robot]
model = "arm.xml"
tip = "tool"
[impact]
region = "chest"
direction = [0.0, 1.0, 0.0]
speed = 0.5
[motors]
kind = "{motors}"
reaction_time = 0.01
horizon = 0.05
[stiffness]
lower = 500.0
upper = 3e4
nominal = 8000.0
[accuracy]
forces = [[20.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 0.0, 20.0]]
max_deflection = {deflection}
{accuracy}
[task]
pose_of = "bent"
exact = false
[[poses]]
name = "bent"
q = [0.2, -0.7, 1.3]
[[poses]]
name = "far"
q = [-0.4, -0.2, 0.5]
{tables}
"""


def small_study(
    folder: Path,
    tables: str = "",
    *,
    motors: str = "driven",
    deflection: float = 2e-3,
    accuracy: str = "",
    scenarios: str = "directions = [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]",
) -> Study:
    """Return the study with more tables."""
    (folder / "arm.xml").write_text(ARM, encoding="utf-8")
    more = f"[scenarios]\n{scenarios}\n{tables}"
    text = STUDY.format(
        motors=motors, deflection=deflection, accuracy=accuracy, tables=more, objective=""
    )
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return load_study(path)
