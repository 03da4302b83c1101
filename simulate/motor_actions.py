# SPDX-License-Identifier: BSD-3-Clause
"""Laws of the motors of the nonlinear robot, as expressions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import casadi as ca

from softimpact.symbolic.matrices import Matrix

UNLIMITED = 1e30
"""Torque [N·m] that stands for no limit in expressions, where an infinite one gives NaN."""


@dataclass(frozen=True, eq=False)
class MotorSide:
    """A robot's motors as a law sees them (SX); vectors have one entry an independent joint.

    Attributes:
        active: indices of the joints that have a motor.
        moved: motor angles since first touch; links' at rigid joints.
        speed: of the motors.
        inertia: M_θθ in the upper left block of the generalised mass matrix, n×n.
        coriolis: torques that Coriolis and centrifugal forces need.
        potential: torques that gravity and the file's springs need.
    """

    active: list[int]
    moved: Matrix
    speed: Matrix
    inertia: Matrix
    coriolis: Matrix
    potential: Matrix


@dataclass(frozen=True, eq=False)
class MotorAction:
    """What motors do (SX).

    Attributes:
        torque: beyond those that hold the robot at first touch, length n.
        parameters: symbols.
        acceleration: of the motors where their motion is given, length n; None where torques are.
        memory: of the controller, as in ``Mechanism``.
        memory_rate: its rate.
    """

    torque: Matrix
    parameters: Matrix
    acceleration: Matrix | None = None
    memory: Matrix = field(default_factory=lambda: ca.SX(0, 1))
    memory_rate: Matrix = field(default_factory=lambda: ca.SX(0, 1))


MotorActionBuilder = Callable[[MotorSide, Matrix], MotorAction]
"""From the motors and the torques at first touch to a law."""


def free(motors: MotorSide, at_touch: Matrix) -> MotorAction:
    """No torque changes."""
    return MotorAction(0 * motors.moved, ca.SX(0, 1))


def held(motors: MotorSide, at_touch: Matrix) -> MotorAction:
    """Constant K_p hold the motors where they were at first touch; parameters are its entries."""
    gains = ca.SX.sym("K_p", *motors.inertia.shape)
    return MotorAction(-ca.mtimes(gains, motors.moved), ca.vec(gains))


def servo(motors: MotorSide, at_touch: Matrix) -> MotorAction:
    """K_p and K_d on the deviation from a reference that moves on; torques saturate.

    Parameters are K_p (n×n), K_d, the limits and the reference's speed.
    """
    n = int(motors.moved.numel())
    gains = ca.SX.sym("K_p", n, n)
    damping, limit, wanted_speed = (ca.SX.sym(name, n) for name in ("K_d", "limit", "dw"))
    wanted = ca.SX.sym("w", n)
    asked = ca.mtimes(gains, wanted - motors.moved) + damping * (wanted_speed - motors.speed)
    return MotorAction(
        torque=ca.fmax(ca.fmin(asked, limit), -limit),
        parameters=ca.vertcat(ca.vec(gains), damping, limit, wanted_speed),
        memory=wanted,
        memory_rate=wanted_speed,
    )


def prescribed(motors: MotorSide, at_touch: Matrix) -> MotorAction:
    """The motors' accelerations are parameters: zero if they are driven or have stopped."""
    acceleration = ca.SX.sym("a", int(motors.moved.numel()))
    return MotorAction(0 * motors.moved, acceleration, acceleration)


def computed_torque(motors: MotorSide, at_touch: Matrix) -> MotorAction:
    """Computed torque with PID in the active space (MSM §3.1.3); see ``Controller``.

    Parameters are k_p, k_d, k_i, whether the robot has not reacted yet, and the reference's speed.
    """
    A = motors.active
    k_p, k_d, k_i, follows = (ca.SX.sym(name) for name in ("k_p", "k_d", "k_i", "on"))
    wanted_speed, wanted = ca.SX.sym("dw", len(A)), ca.SX.sym("w", len(A))
    behind, summed = wanted - motors.moved[A], ca.SX.sym("s", len(A))
    acceleration = k_p * behind + k_d * (wanted_speed - motors.speed[A]) + k_i * summed
    pid = ca.mtimes(motors.inertia[A, A], acceleration)
    torque = ca.SX(-at_touch)
    torque[A] += motors.potential[A] + follows * (pid + motors.coriolis[A])
    return MotorAction(
        torque=torque,
        parameters=ca.vertcat(k_p, k_d, k_i, follows, wanted_speed),
        memory=ca.vertcat(wanted, summed),
        memory_rate=ca.vertcat(wanted_speed, behind),
    )
