# SPDX-License-Identifier: BSD-3-Clause
"""How far the linearised robot's forces may be off, from how much the robot changes meanwhile."""

from __future__ import annotations

import casadi as ca

from ..dynamics.equations_of_motion import bias_acceleration, bias_torques
from ..matrices import Factorisation, Matrix, on_scalars
from .impact_model import WEIGHTLESS, ImpactModel


def linearisation_error(
    model: ImpactModel, q: Matrix, direction: Matrix, velocity: Matrix, duration: Matrix
) -> Matrix:
    """Return the share of the force by which the linear robot may be off.

    It is (|a| + |b|) T / 2v + |√(m_c(q + q̇ T) / m_c(q)) − 1| for a robot that moves at q̇, v = n·J q̇
    at its contact point, over the duration T. a = n·J̇ q̇ bends the path of a contact
    point whose joints keep their speed, b = a − nᵀJ M⁻¹ h(q̇) that of links that nothing drives:
    each moves the point by a share of v T. The force goes with the root of the mass, about.

    Args:
        model: the robot, an open chain.
        q: joint angles, length n, of any matrix kind.
        direction: unit vector n, length 3.
        velocity: q̇ at first touch, length n, with n·J q̇ > 0 [rad/s].
        duration: T, from first touch to the peak [s].
    """
    return on_scalars(_error, (model,), q, direction, velocity, duration)


def _error(
    model: ImpactModel, q: Matrix, direction: Matrix, velocity: Matrix, duration: Matrix
) -> Matrix:
    robot = model.robot
    bend = ca.dot(direction, bias_acceleration(robot, model.tip, q, velocity))
    coriolis = bias_torques(robot, q, velocity, WEIGHTLESS)
    row = model.direction_row(q, direction)
    slowed = ca.dot(Factorisation(model.mass_matrix(q)).solve(row.T), coriolis)
    speed: Matrix = ca.mtimes(row, velocity)
    path = (ca.fabs(bend) + ca.fabs(bend - slowed)) * duration / (2 * speed)
    before, after = (model.reflected_mass(at, direction) for at in (q, q + velocity * duration))
    return path + ca.fabs(ca.sqrt(after / before) - 1)
