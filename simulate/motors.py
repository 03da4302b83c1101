# SPDX-License-Identifier: BSD-3-Clause
"""What the motors do during an impact: hold their angles, or follow a controller."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from softimpact.symbolic import Robot, bias_torques, gravity_torques, mass_matrix
from softimpact.symbolic.impact_model import WEIGHTLESS
from softimpact.symbolic.matrices import Matrix
from softimpact.symbolic.rigid import Array

from .approach import Arrival
from .controller import Controller


@dataclass(frozen=True, eq=False)
class Motors:
    """A robot's motors as a law sees them (SX); vectors have one entry a joint.

    Attributes:
        robot: the rigid robot.
        gravity: along the base's axes [m/s²].
        q: link angles.
        rate: of the links.
        moved: motor angles since first touch; links' at rigid joints.
        speed: of the motors.
        rotors: reflected inertias B.
    """

    robot: Robot
    gravity: tuple[float, float, float]
    q: Matrix
    rate: Matrix
    moved: Matrix
    speed: Matrix
    rotors: Matrix


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
    gains = ca.SX.sym("K_p", motors.robot.n, motors.robot.n)
    return MotorLaw(-ca.mtimes(gains, motors.moved), ca.vec(gains))


def computed_torque(motors: Motors, at_touch: Matrix) -> MotorLaw:
    """Computed torque with PID in the active space (MSM §3.1.3); see ``Controller``.

    Parameters are those of ``controller_parameters``.
    """
    robot = motors.robot
    A = _active(robot)
    k_p, k_d, k_i, follows = (ca.SX.sym(name) for name in ("k_p", "k_d", "k_i", "on"))
    wanted_speed, wanted = ca.SX.sym("dw", len(A)), ca.SX.sym("w", len(A))
    behind, summed = wanted - motors.moved[A], ca.SX.sym("s", len(A))
    acceleration = k_p * behind + k_d * (wanted_speed - motors.speed[A]) + k_i * summed
    M = mass_matrix(robot, motors.q) + ca.diag(motors.rotors)
    coriolis = bias_torques(robot, motors.q, motors.rate, WEIGHTLESS)
    holding = gravity_torques(robot, motors.q, motors.gravity)
    torque = ca.SX(-at_touch)
    torque[A] += holding[A] + follows * (ca.mtimes(M[A, A], acceleration) + coriolis[A])
    return MotorLaw(
        torque=torque,
        parameters=ca.vertcat(k_p, k_d, k_i, follows, wanted_speed),
        memory=ca.vertcat(wanted, summed),
        memory_rate=ca.vertcat(wanted_speed, behind),
    )


def controller_parameters(robot: Robot, arrival: Arrival, controller: Controller) -> Array:
    """Return the parameters of ``computed_torque`` from first touch on."""
    wanted_speed = arrival.speed * arrival.link_velocity[_active(robot)]
    if controller.reference == "held":
        wanted_speed = np.zeros_like(wanted_speed)
    gains = [controller.proportional, controller.derivative, controller.integral]
    return np.array([*gains, 1.0, *wanted_speed])


def after_reaction(parameters: Array) -> Array:
    """Return the parameters of ``computed_torque`` once the robot has reacted."""
    changed = parameters.copy()
    changed[3] = 0.0
    return changed


def _active(robot: Robot) -> list[int]:
    return [i for i, actuated in enumerate(robot.actuated) if actuated]
