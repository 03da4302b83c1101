# SPDX-License-Identifier: BSD-3-Clause
"""The standard's two-body formula (ISO/TS 15066, A.3.4): the lowest rung of the ladder, ``iso``.

Robot and region are two masses with the region's spring between them: F = v √(k μ) and
E = F²/2k, with 1/μ = 1/m_H + 1/m_R and m_R = M/2 + m_L. A clamped region does not move: μ = m_R.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from ..body.regions import BodyRegion
from ..matrices import Matrix
from ..robot.robot import Robot


@dataclass(frozen=True, eq=False)
class TwoBody:
    """Two masses and a spring.

    Attributes:
        stiffness: k of the region [N/m].
        reduced_mass: μ [kg].
    """

    stiffness: Matrix
    reduced_mass: Matrix

    def force(self, speed: Matrix) -> Matrix:
        """Return the peak force F [N] at a relative speed [m/s]."""
        return speed * ca.sqrt(self.stiffness * self.reduced_mass)

    def energy(self, speed: Matrix) -> Matrix:
        """Return the energy E [J] that the region takes up at a relative speed [m/s]."""
        return self.reduced_mass * speed**2 / 2

    def safe_speed(self, limit: Matrix) -> Matrix:
        """Return the speed [m/s] at which the peak force is a limit [N]."""
        return limit / ca.sqrt(self.stiffness * self.reduced_mass)


def two_body(
    region: BodyRegion, clamped: bool, moving_mass: Matrix, payload: Matrix = 0.0
) -> TwoBody:
    """Return the two-body model of an impact.

    Args:
        region: k and m_H.
        clamped: whether the region is held.
        moving_mass: M of the robot's moving parts [kg].
        payload: m_L that it holds [kg].
    """
    robot = moving_mass / 2 + payload
    mass = robot if clamped else 1 / (1 / region.effective_mass + 1 / robot)
    return TwoBody(region.stiffness, mass)


def moving_mass(robot: Robot) -> Matrix:
    """Return M [kg], the mass of all that moves of a robot, without its payload."""
    return sum((joint.inertia.mass for joint in robot.joints), 0.0)
