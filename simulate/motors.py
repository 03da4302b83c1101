# SPDX-License-Identifier: BSD-3-Clause
"""What the motors do during an impact: hold their angles, or follow a controller."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from softimpact.symbolic.matrices import Matrix
from softimpact.symbolic.robot.rigid import Array

from .approach import Arrival
from .controller import Controller


@dataclass(frozen=True, eq=False)
class Motors:
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
class MotorLaw:
    """Motor torques as expressions (SX).

    Attributes:
        torque: beyond those that hold the robot at first touch, length n.
        parameters: symbols.
        memory: of the controller, as in ``Mechanism``.
        memory_rate: its rate.
    """

    torque: Matrix
    parameters: Matrix
    memory: Matrix = field(default_factory=lambda: ca.SX(0, 1))
    memory_rate: Matrix = field(default_factory=lambda: ca.SX(0, 1))


LawBuilder = Callable[[Motors, Matrix], MotorLaw]
"""From the motors and the torques at first touch to a law."""


def held(motors: Motors, at_touch: Matrix) -> MotorLaw:
    """Constant K_p hold the motors where they were at first touch; parameters are its entries."""
    gains = ca.SX.sym("K_p", *motors.inertia.shape)
    return MotorLaw(-ca.mtimes(gains, motors.moved), ca.vec(gains))


def computed_torque(motors: Motors, at_touch: Matrix) -> MotorLaw:
    """Computed torque with PID in the active space (MSM §3.1.3); see ``Controller``.

    Parameters are those of ``controller_parameters``.
    """
    A = motors.active
    k_p, k_d, k_i, follows = (ca.SX.sym(name) for name in ("k_p", "k_d", "k_i", "on"))
    wanted_speed, wanted = ca.SX.sym("dw", len(A)), ca.SX.sym("w", len(A))
    behind, summed = wanted - motors.moved[A], ca.SX.sym("s", len(A))
    acceleration = k_p * behind + k_d * (wanted_speed - motors.speed[A]) + k_i * summed
    pid = ca.mtimes(motors.inertia[A, A], acceleration)
    torque = ca.SX(-at_touch)
    torque[A] += motors.potential[A] + follows * (pid + motors.coriolis[A])
    return MotorLaw(
        torque=torque,
        parameters=ca.vertcat(k_p, k_d, k_i, follows, wanted_speed),
        memory=ca.vertcat(wanted, summed),
        memory_rate=ca.vertcat(wanted_speed, behind),
    )


def controller_parameters(
    arrival: Arrival, active: Sequence[bool], controller: Controller
) -> Array:
    """Return the parameters of ``computed_torque`` from first touch on."""
    wanted_speed = arrival.speed * arrival.link_velocity[list(active)]
    if controller.reference == "held":
        wanted_speed = np.zeros_like(wanted_speed)
    gains = [controller.proportional, controller.derivative, controller.integral]
    return np.array([*gains, 1.0, *wanted_speed])


def after_reaction(parameters: Array) -> Array:
    """Return the parameters of ``computed_torque`` once the robot has reacted."""
    changed = parameters.copy()
    changed[3] = 0.0
    return changed
