# SPDX-License-Identifier: BSD-3-Clause
"""Static equilibrium of elastic joints under gravity."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from ..errors import InvalidValue, NoEquilibrium
from ..robot.rigid import Array
from ..robot.robot import Robot
from .equations_of_motion import STANDARD_GRAVITY, Gravity, gravity_torques, stiffness_of_potential

TOLERANCE = 1e-9
"""Deflection [rad] that unbalanced torques would cause where the equilibrium counts as found."""


def link_angles_at_rest(
    robot: Robot,
    motor_angles: ArrayLike,
    springs: ArrayLike,
    gravity: Gravity = STANDARD_GRAVITY,
) -> Array:
    """Return the link angles q at which springs and gravity balance: q − θ + k_s⁻¹ ∂V/∂q = 0.

    Args:
        robot: any robot without loops; ``configuration_at_rest`` takes closed chains.
        motor_angles: θ, length n [rad].
        springs: k_s, length n [N·m/rad], infinite for a rigid joint.
        gravity: acceleration along the base's axes [m/s²].

    Raises:
        NoEquilibrium: none was found, or the one found is unstable (springs too soft).
        InvalidValue: a motor angle that is not finite, or a spring that is not greater than 0.
        WrongLength: a vector that does not fit the robot.
    """
    theta = robot.vector("motor_angles", motor_angles)
    if not np.isfinite(theta).all():
        raise InvalidValue("motor_angles", "must hold finite numbers")
    flexibility = _flexibility(robot, springs)
    q = ca.SX.sym("q", robot.n)
    sag = q - theta + flexibility * gravity_torques(robot, q, gravity)
    newton = ca.rootfinder(
        "rest", "newton", {"x": q, "g": sag}, {"error_on_fail": False, "max_iter": 100}
    )
    found = newton(x0=theta)["x"]
    torques = np.array(gravity_torques(robot, found, gravity)).ravel()
    left = abs(np.array(found).ravel() - theta + flexibility * torques)
    if not left.max() < TOLERANCE:
        residual = float((left[flexibility > 0] / flexibility[flexibility > 0]).max(initial=0))
        raise NoEquilibrium(residual, "the joint stiffness is too low for the arm to hold itself")
    root = np.sqrt(flexibility)  # K + H ≻ 0, scaled so that rigid joints count as held
    curvature = np.array(stiffness_of_potential(robot, found, gravity))
    if np.linalg.eigvalsh(np.eye(robot.n) + np.outer(root, root) * curvature).min() <= 0:
        raise NoEquilibrium(0.0, "the balance found is unstable; raise the joint stiffness")
    return np.array(found).ravel()


def _flexibility(robot: Robot, springs: ArrayLike) -> Array:
    """Return 1/k_s."""
    stiffness = robot.vector("joint_stiffness", springs)
    if not (stiffness > 0).all():
        raise InvalidValue("joint_stiffness", "must be greater than 0 N·m/rad")
    return np.asarray(1 / stiffness)


def motor_angles_at_rest(
    robot: Robot,
    link_angles: ArrayLike,
    springs: ArrayLike,
    gravity: Gravity = STANDARD_GRAVITY,
) -> Array:
    """Return the motor angles θ = q + k_s⁻¹ ∂V/∂q that hold the links at q.

    Takes and raises what ``link_angles_at_rest`` does, with link angles for motor angles.
    """
    q = robot.vector("link_angles", link_angles)
    torques = np.array(gravity_torques(robot, q, gravity)).ravel()
    return np.asarray(q + _flexibility(robot, springs) * torques)
