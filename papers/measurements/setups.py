# SPDX-License-Identifier: BSD-3-Clause
"""What was measured: robot, posture, device, speed and force."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from softimpact.symbolic.robot.rigid import Array

DOWN = np.array([0.0, 0.0, -1.0])


@dataclass(frozen=True, eq=False)
class Measurement:
    """One measured impact of a robot on a device.

    Attributes:
        title: of the robot and the speed.
        robot: its built-in model.
        q: posture, link angles [rad]; inferred, see ``docs/validation.md``.
        direction: in which the flange moves.
        device: that was hit, fixed.
        speed: of the impact [m/s].
        force: that was measured [N].
        rotors: range of the reflected rotor inertias: each joint's times one of these [s²] is its
            rotor; None takes the file's, of which ``rotor_share`` then is the range.
    """

    title: str
    robot: str
    q: Array
    direction: Array
    device: str
    speed: float
    force: float


DEVICE = "device_75_sh70"
"""K2 of 75 N/mm (stated); the pad K1 is not stated and taken as the hardest there is."""

UR10E_POSE = np.array([2.9221, -1.3219, 1.7901, -2.0391, -1.5708, 0.0])
"""Flange 0.8 m from and 0.4 m above the base, pointing down, elbow up."""

IIWA_POSE = np.array([0.0, 0.9713, 0.0, -0.8209, 0.0, 0.8258, 0.0])
"""Flange at the same place, elbow up; 30° from straight down, as the arm is all but stretched
(0.817 m of 0.82) where it points down."""

SVARNY = (
    Measurement("UR10e at 0.16 m/s", "ur10e", UR10E_POSE, DOWN, DEVICE, 0.16, 140.0),
    Measurement("UR10e at 0.36 m/s", "ur10e", UR10E_POSE, DOWN, DEVICE, 0.36, 280.0),
    Measurement("iiwa at 0.20 m/s", "iiwa14", IIWA_POSE, DOWN, DEVICE, 0.20, 140.0),
)
"""P. Svarny, J. Rozlivek, L. Rustler, M. Hoffmann, 3D Collision-Force-Map for Safe Human-Robot
Collaboration, ICRA 2021 (arXiv 2009.01036): the speeds at which two arms that move down reach two
forces at one place of their workspace."""
