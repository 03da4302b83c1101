# SPDX-License-Identifier: BSD-3-Clause
"""The nonlinear robot over links and motors."""

from __future__ import annotations

from functools import lru_cache

import casadi as ca
import numpy as np

from softimpact.symbolic import (
    Contact,
    ImpactModel,
    InvalidValue,
    Robot,
    bias_torques,
    direction_jacobian,
    frame_pose,
    gravity_torques,
    mass_matrix,
    stiffness_of_potential,
)
from softimpact.symbolic.impact_model import WEIGHTLESS
from softimpact.symbolic.matrices import Factorisation, Matrix
from softimpact.symbolic.rigid import Array

from .approach import Arrival
from .controller import Controller
from .mechanism import BodyKind, Mechanism
from .motors import (
    LawBuilder,
    Motors,
    after_reaction,
    computed_torque,
    controller_parameters,
    held,
)
from .simulator import Scene, Simulator, Switch, build_simulator

Gravity = tuple[float, float, float]

AT_REST = 1e-6
"""Torque [N·m, N] on a joint without a motor below which it counts as balanced."""


def full_scene(
    model: ImpactModel,
    arrival: Arrival,
    contact: Contact,
    tolerance: float,
    controller: Controller | None = None,
) -> Scene:
    """Return the scene of the nonlinear robot's impact.

    Without a controller, constant motor torques balance gravity at first touch, where the springs
    hold the links at q; K_p holds the motors where they are then.

    Args:
        model: the robot.
        arrival: how it arrives.
        contact: with the body.
        tolerance: of the integrator.
        controller: takes the place of the model's K_p.

    Raises:
        InvalidValue: a joint without a motor is not in equilibrium.
    """
    robot, q, n = model.robot, arrival.q, arrival.direction
    elastic = model.drives.elastic
    law = held if controller is None else computed_torque
    kind = BodyKind.of(contact)
    simulator = _full_simulator(robot, model.tip, elastic, model.gravity, law, kind, tolerance)
    start = n @ _column(frame_pose(robot, model.tip, q).position)
    rotors, springs = _column(model.drives.rotors), _column(model.drives.springs)
    parameters = np.concatenate([q, n, [start], _balance(model, q), rotors, springs])
    velocity = np.concatenate([arrival.link_velocity, arrival.link_velocity[list(elastic)]])

    def scene(of_law: Array, switch: Switch | None = None) -> Scene:
        everything = np.concatenate([parameters, of_law])
        return Scene(simulator, everything, velocity, arrival.speed, contact, switch)

    if controller is None:
        return scene(_gains(model, q).ravel())
    of_law = controller_parameters(robot, arrival, controller)
    reacting = np.concatenate([parameters, after_reaction(of_law)])
    return scene(of_law, Switch(controller.reaction_time, reacting))


def _column(vector: Matrix) -> Array:
    return np.array(vector, dtype=float).ravel()


def _balance(model: ImpactModel, q: Array) -> Array:
    """Torques that hold the robot at q; joints without a motor must need none."""
    torques = _column(gravity_torques(model.robot, q, model.gravity))
    for joint, torque in zip(model.robot.joints, torques, strict=True):
        if not joint.actuated and abs(torque) > AT_REST:
            raise InvalidValue(
                "q",
                f"joint '{joint.name}' has no motor and is not at rest there (torque {torque:.3g} "
                "N·m); choose its equilibrium",
            )
    return torques


def _gains(model: ImpactModel, q: Array) -> Array:
    """K_p over all joints, n×n: the motors' block of K0 less what gravity and springs add."""
    n = model.robot.n
    motors = np.array(model.generalised_stiffness(q))[:n, :n]
    return np.asarray(motors - np.array(stiffness_of_potential(model.robot, q, model.gravity)))


@lru_cache(maxsize=16)
def _full_simulator(
    robot: Robot,
    tip: str,
    elastic: tuple[bool, ...],
    gravity: Gravity,
    law: LawBuilder,
    kind: BodyKind,
    tolerance: float,
) -> Simulator:
    return build_simulator(_mechanism(robot, tip, elastic, gravity, law), kind, tolerance)


def _mechanism(
    robot: Robot, tip: str, elastic: tuple[bool, ...], gravity: Gravity, law: LawBuilder
) -> Mechanism:
    """Equations over the links' and the elastic joints' motors' motion since first touch.

    M(q) q̈ + h(q, q̇) = τ − Jᵀ n f_c with τ from the spring (elastic joints, whose rotor follows
    B θ̈ = τ_m − τ) or the motor (rigid joints, whose rotor turns with the link).
    """
    n, E = robot.n, [i for i, is_elastic in enumerate(elastic) if is_elastic]
    position, velocity = ca.SX.sym("z", n + len(E)), ca.SX.sym("dz", n + len(E))
    force = ca.SX.sym("f_c")
    q0, direction, start = ca.SX.sym("q0", n), ca.SX.sym("n", 3), ca.SX.sym("p0")
    balance, rotors, springs = (ca.SX.sym(name, n) for name in ("g0", "B", "k_s"))

    moved, rate = position[:n], velocity[:n]
    q = q0 + moved
    motors, motor_rates = ca.SX(moved), ca.SX(rate)
    motors[E], motor_rates[E] = position[n:], velocity[n:]
    driven = law(Motors(robot, gravity, q, rate, motors, motor_rates, rotors), balance)
    control = driven.torque
    spring = springs * (motors - moved)

    torque, carried = ca.SX(control), ca.SX(rotors)
    torque[E], carried[E] = spring[E], 0
    bias = bias_torques(robot, q, rate, WEIGHTLESS) + gravity_torques(robot, q, gravity) - balance
    push = direction_jacobian(robot, tip, q, direction).T * force
    links = Factorisation(mass_matrix(robot, q) + ca.diag(carried)).solve(torque - bias - push)
    return Mechanism(
        position=position,
        velocity=velocity,
        force=force,
        parameters=ca.vertcat(q0, direction, start, balance, rotors, springs, driven.parameters),
        acceleration=ca.vertcat(links, (control[E] - spring[E]) / rotors[E]),
        displacement=ca.dot(direction, frame_pose(robot, tip, q).position) - start,
        memory=driven.memory,
        memory_rate=driven.memory_rate,
    )
