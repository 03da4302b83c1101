# SPDX-License-Identifier: BSD-3-Clause
"""Static equilibrium of elastic joints under gravity."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from .dynamics import STANDARD_GRAVITY, gravity_torques, stiffness_of_potential
from .errors import NoEquilibrium
from .rigid import Array
from .robot import Robot

TOLERANCE = 1e-9
"""Residual torque [N·m] at which the equilibrium counts as found."""


def link_angles_at_rest(
    robot: Robot,
    motor_angles: ArrayLike,
    springs: ArrayLike,
    gravity: Sequence[float] = STANDARD_GRAVITY,
) -> Array:
    """Return the link angles q at which springs and gravity balance: k_s(q − θ) + ∂V/∂q = 0.

    Args:
        robot: any robot.
        motor_angles: θ, length n [rad].
        springs: k_s, length n [N·m/rad].
        gravity: acceleration along the base's axes [m/s²].

    Raises:
        NoEquilibrium: none was found, or the one found is unstable (springs too soft).
    """
    theta = robot.vector("motor_angles", motor_angles)
    stiffness = robot.vector("joint_stiffness", springs)
    q = ca.SX.sym("q", robot.n)
    residual = stiffness * (q - theta) + gravity_torques(robot, q, gravity)
    newton = ca.rootfinder(
        "rest", "newton", {"x": q, "g": residual}, {"error_on_fail": False, "max_iter": 100}
    )
    found = newton(x0=theta)["x"]
    left = stiffness * (found - theta) + gravity_torques(robot, found, gravity)
    error = float(ca.norm_inf(left))
    if not error < TOLERANCE * max(1.0, float(stiffness.max())):
        raise NoEquilibrium(error, "the joint stiffness is too low for the arm to hold itself")
    curvature = np.diag(stiffness) + np.array(stiffness_of_potential(robot, found, gravity))
    if np.linalg.eigvalsh(curvature).min() <= 0:
        raise NoEquilibrium(error, "the balance found is unstable; raise the joint stiffness")
    return np.array(found).ravel()


def motor_angles_at_rest(
    robot: Robot,
    link_angles: ArrayLike,
    springs: ArrayLike,
    gravity: Sequence[float] = STANDARD_GRAVITY,
) -> Array:
    """Return the motor angles θ = q + k_s⁻¹ ∂V/∂q that hold the links at q."""
    q = robot.vector("link_angles", link_angles)
    torques = np.array(gravity_torques(robot, q, gravity)).ravel()
    return np.asarray(q + torques / robot.vector("joint_stiffness", springs))
