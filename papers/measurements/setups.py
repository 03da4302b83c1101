# SPDX-License-Identifier: BSD-3-Clause
"""What was measured: robot, place, device, speed and force, and what was not said."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from softimpact.symbolic.robot.rigid import Array

DOWN = np.array([0.0, 0.0, -1.0])

REACH, HEIGHT = 0.8, 0.4
"""Of the device from the robot's axis and above its base [m]."""

UR10E_POSE = np.array([2.9221, -1.3219, 1.7901, -2.0391, -1.5708, 0.0])
"""Flange there, pointing down, elbow up [rad]. The other three ways to reach it have the same mass
at the flange to 1 %."""

SHOULDER, UPPER_ARM, FOREARM, HAND = 0.36, 0.42, 0.4, 0.126
"""Of the iiwa 14 [m], from KUKA's data sheet."""

MOST_TILT = np.radians(60)
"""Of the iiwa's flange from straight down: pointing down at that place, the arm is all but
stretched, so it may well have pointed elsewhere."""

Postures = Callable[[np.random.Generator, int], Array]
"""From a source of random numbers and a count to so many postures, count×n."""


@dataclass(frozen=True, eq=False)
class Measurement:
    """One measured impact of a robot's flange on a device, which is fixed.

    Attributes:
        title: of the robot and the speed.
        robot: its built-in model.
        postures: that it may have had.
        direction: in which the flange moves.
        device: that was hit.
        speed: of the impact [m/s].
        force: that was measured [N].
    """

    title: str
    robot: str
    postures: Postures
    direction: Array
    device: str
    speed: float
    force: float


def ur10e_postures(random: np.random.Generator, count: int) -> Array:
    """Return the same posture again and again."""
    return np.tile(UR10E_POSE, (count, 1))


def iiwa_postures(random: np.random.Generator, count: int) -> Array:
    """Return postures with the elbow up in a vertical plane and any tilt of the flange."""
    return np.array([iiwa_posture(tilt) for tilt in random.uniform(0, MOST_TILT, count)])


def iiwa_posture(tilt: float) -> Array:
    """Return the iiwa's joint angles with its flange tilted out of straight down [rad]."""
    x = REACH - HAND * np.sin(tilt)
    z = HEIGHT + HAND * np.cos(tilt) - SHOULDER
    r, lean = np.hypot(x, z), np.arctan2(x, z)
    behind = np.arccos((r**2 + UPPER_ARM**2 - FOREARM**2) / (2 * UPPER_ARM * r))
    ahead = np.arccos((r**2 + FOREARM**2 - UPPER_ARM**2) / (2 * FOREARM * r))
    return np.array([0, lean - behind, 0, -(behind + ahead), 0, np.pi - tilt - (lean + ahead), 0])


DEVICE = "device_75_sh70"
"""K2 of 75 N/mm, as stated; the pad K1 is not, and taken as the hardest there is."""

SVARNY = (
    Measurement("UR10e at 0.16 m/s", "ur10e", ur10e_postures, DOWN, DEVICE, 0.16, 140.0),
    Measurement("UR10e at 0.36 m/s", "ur10e", ur10e_postures, DOWN, DEVICE, 0.36, 280.0),
    Measurement("iiwa at 0.20 m/s", "iiwa14", iiwa_postures, DOWN, DEVICE, 0.20, 140.0),
)
"""P. Svarny, J. Rozlivek, L. Rustler, M. Hoffmann, 3D Collision-Force-Map for Safe Human-Robot
Collaboration, 2021 (arXiv 2009.01036): speeds at which two arms reach two forces at one place."""
