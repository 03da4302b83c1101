# SPDX-License-Identifier: BSD-3-Clause
"""The nonlinear robot over links and motors, and the stages of its motors in an impact."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import casadi as ca
import numpy as np

from softimpact.symbolic import (
    Contact,
    ImpactModel,
    InvalidValue,
    Motors,
    frame_pose,
    gravity_torques,
    loop_tangent,
)
from softimpact.symbolic.impact.drives import require_rotors
from softimpact.symbolic.impact.motors import MotorLaw
from softimpact.symbolic.matrices import Matrix
from softimpact.symbolic.robot.rigid import Array

from .arrival import Arrival
from .controller import Controller
from .full_mechanism import full_simulator
from .mechanism import BodyKind
from .motor_actions import (
    UNLIMITED,
    MotorActionBuilder,
    computed_torque,
    free,
    held,
    prescribed,
    servo,
)
from .scene import Leg, Motion, Scene, Stage, unchanged

AT_REST = 1e-6
"""Torque [N·m, N] on a joint without a motor below which it counts as balanced."""


def full_scene(
    model: ImpactModel,
    arrival: Arrival,
    contact: Contact,
    motors: Motors | Controller,
    tolerance: float,
) -> Scene:
    """Return the scene of the nonlinear robot's impact.

    Motor torques balance gravity at first touch, where the springs hold the links at q; beyond
    that, motors do what they are said to. Its motion is that of all links and of the elastic
    joints' motors since first touch.

    Args:
        model: the robot.
        arrival: how it arrives.
        contact: with the body.
        motors: what they do, with the gains of the model; or the papers' controller.
        tolerance: of the integrator.

    Raises:
        InvalidValue: a joint without a motor is not in equilibrium, or an elastic joint has no
            rotor.
    """
    robot, q, n = model.robot, arrival.q, arrival.direction
    free = list(model.independent)
    kind = BodyKind.of(contact)
    start = n @ _column(frame_pose(robot, model.tip, q).position)
    rotors, springs = _column(model.drives.rotors), _column(model.drives.springs)[free]
    rates = np.array(loop_tangent(robot, ca.DM(q))) @ arrival.link_velocity
    velocity = np.concatenate([rates, arrival.link_velocity[list(model.elastic)]])
    damping = [robot.damping, arrival.speed * rates]
    common = np.concatenate([q, n, [start], _balance(model, q), rotors, springs, *damping])

    def stage(
        begin: float, law: MotorActionBuilder, numbers: Callable[[Motion], tuple[Array, Array]]
    ) -> Stage:
        if law is not prescribed:
            require_rotors(model.drives, robot.joint_names)
        simulator = full_simulator(
            robot, model.tip, model.elastic, model.gravity, law, kind, tolerance
        )

        def enter(motion: Motion) -> Leg:
            of_law, memory = numbers(motion)
            return Leg(simulator, np.concatenate([common, of_law]), motion, memory, unchanged)

        return Stage(begin, enter)

    if isinstance(motors, Controller):
        stages = _controlled(model, arrival, motors, stage)
    else:
        stages = tuple(
            stage(begin, LAWS[law], partial(_numbers, model, arrival, motors, begin, law))
            for begin, law in motors.laws
        )
    return Scene(stages, Motion(np.zeros_like(velocity), velocity), arrival.speed, contact)


LAWS: dict[MotorLaw, MotorActionBuilder] = {
    "free": free,
    "servo": servo,
    "held": held,
    "driven": prescribed,
    "braking": prescribed,
    "stopped": prescribed,
}
"""Expressions of each law."""


def _numbers(
    model: ImpactModel,
    arrival: Arrival,
    motors: Motors,
    begin: float,
    law: MotorLaw,
    motion: Motion,
) -> tuple[Array, Array]:
    """Return a law's parameters and memory when it begins."""
    nothing, before = np.zeros(0), arrival.link_velocity
    if law == "free":
        return nothing, nothing
    if law == "held":
        return _gains(model, arrival.q).ravel(), nothing
    if law == "servo":
        free, drives = list(model.independent), model.drives
        limits = (
            np.full(model.robot.n, np.inf) if drives.torque_limits is None else drives.torque_limits
        )
        limits = np.minimum(limits, UNLIMITED)[free]
        K_d = (
            np.zeros(len(free))
            if drives.damping_gains is None
            else _column(drives.damping_gains)[free]
        )
        speed = arrival.speed * before * np.array(model.actuated)
        return np.concatenate(
            [_gains(model, arrival.q).ravel(), K_d, limits, speed]
        ), before * begin
    if law == "braking":
        speeds = _motor_rows(model, motion.velocity)
        return -arrival.speed * speeds / motors.stopping_time, nothing
    return np.zeros_like(before), nothing


def _motor_rows(model: ImpactModel, rates: Array) -> Array:
    """Return the motors' part of links' and elastic motors' rates, one an independent joint."""
    rows = rates[list(model.independent)].copy()
    rows[list(model.elastic)] = rates[model.robot.n :]
    return rows


def _controlled(
    model: ImpactModel,
    arrival: Arrival,
    controller: Controller,
    stage: Callable[[float, MotorActionBuilder, Callable[[Motion], tuple[Array, Array]]], Stage],
) -> tuple[Stage, ...]:
    """Return the stages of the papers' controller."""
    A = list(model.actuated)
    wanted = arrival.link_velocity[A] * (controller.reference == "moving")
    gains = [controller.proportional, controller.derivative, controller.integral]

    def numbers(follows: float, motion: Motion) -> tuple[Array, Array]:
        parameters = np.concatenate([gains, [follows], arrival.speed * wanted])
        return parameters, np.zeros(2 * len(wanted))

    begin = stage(0.0, computed_torque, partial(numbers, 1.0))
    if np.isinf(controller.reaction_time):
        return (begin,)
    return begin, stage(controller.reaction_time, computed_torque, partial(numbers, 0.0))


def _column(vector: Matrix) -> Array:
    return np.array(vector, dtype=float).ravel()


def holding_torques(model: ImpactModel, q: Array) -> tuple[Array, dict[str, float]]:
    """Return torques that hold the robot at q, and those that joints without a motor lack, by name.

    Args:
        model: the robot.
        q: link angles, length n.
    """
    G = np.array(loop_tangent(model.robot, ca.DM(q)))
    torques = G.T @ _column(gravity_torques(model.robot, q, model.gravity))
    lacking = {
        model.robot.joint_names[i]: float(torque)
        for i, actuated, torque in zip(model.independent, model.actuated, torques, strict=True)
        if not actuated and abs(torque) > AT_REST
    }
    return torques, lacking


def _balance(model: ImpactModel, q: Array) -> Array:
    """Torques that hold the robot at q; joints without a motor must need none."""
    torques, lacking = holding_torques(model, q)
    for name, torque in lacking.items():
        raise InvalidValue(
            "q",
            f"joint '{name}' has no motor and is not at rest there (torque {torque:.3g} N·m); "
            "choose its equilibrium",
        )
    return torques


def _gains(model: ImpactModel, q: Array) -> Array:
    """K_p over the independent joints."""
    return np.array(ca.densify(model.position_gains(q)))
