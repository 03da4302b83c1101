# SPDX-License-Identifier: BSD-3-Clause
"""The stages of a linear robot's motors in an impact."""

from __future__ import annotations

from functools import partial

import numpy as np

from softimpact.symbolic import (
    Contact,
    ImpactModel,
    InvalidValue,
    Motors,
    generalised_velocity,
)
from softimpact.symbolic.impact.chain import ChainEnd
from softimpact.symbolic.impact.motors import MotorLaw
from softimpact.symbolic.robot.rigid import Array

from .arrival import Arrival
from .linear import Modes, given_motion, linear_system, modal_simulator, modes
from .mechanism import BodyKind
from .scene import Leg, Motion, Scene, Stage, one_stage


def linear_scene(
    model: ImpactModel,
    arrival: Arrival,
    contact: Contact,
    motors: Motors,
    tolerance: float,
    order: int | None = None,
    end: ChainEnd | None = None,
) -> Scene:
    """Return the scene of the linearised robot's impact, or of a chain of it.

    Its motion is the deviation of motors and deflections from the motion before the impact.

    Args:
        model: the robot.
        arrival: how it arrives.
        contact: with the body.
        motors: what they do.
        tolerance: of the integrator.
        order: number of the chain's masses; None keeps all coordinates.
        end: of the chain, see ``linear_system``.
    """
    begin = partial(_stage, model, arrival, contact, motors, tolerance, order, end)
    stages = tuple(begin(at, law) for at, law in motors.laws)
    still = Motion(np.zeros(model.size), np.zeros(model.size))
    return Scene(stages, still, arrival.speed, contact)


def _stage(
    model: ImpactModel,
    arrival: Arrival,
    contact: Contact,
    motors: Motors,
    tolerance: float,
    order: int | None,
    end: ChainEnd | None,
    begin: float,
    law: MotorLaw,
) -> Stage:
    system = linear_system(model, arrival, law, order, end)
    found = modes(system)
    damped = found.damping is not None
    simulator = modal_simulator(len(found.shape), BodyKind.of(contact), damped, tolerance)
    before = generalised_velocity(model, arrival.link_velocity)
    damping = np.zeros((0, 0)) if found.damping is None else found.damping

    def enter(motion: Motion) -> Leg:
        given, deviation = given_motion(
            system, found, law, motion, before, begin, motors.stopping_time
        )
        numbers = [found.squared_frequency, found.shape, given.force.ravel("F")]
        parameters = np.concatenate(
            [[arrival.speed], *numbers, given.displacement, damping.ravel("F")]
        )
        F = system.moving
        start = Motion(found.into @ motion.position[F], found.into @ motion.velocity[F])

        def whole(own: Motion, elapsed: Array) -> Motion:
            return _all_coordinates(model.size, found, F, system.given, deviation, own, elapsed)

        def torque(own: Motion, elapsed: Array) -> Array:
            return servo_torque(model, arrival, whole(own, elapsed))

        return Leg(
            simulator, parameters, start, np.zeros(1), whole, torque if law == "servo" else None
        )

    return Stage(begin, enter)


def _all_coordinates(
    size: int,
    found: Modes,
    moving: list[int],
    given: list[int],
    deviation: Array,
    own: Motion,
    elapsed: Array,
) -> Motion:
    position, velocity = (np.zeros((size, np.size(elapsed))) for _ in range(2))
    position[moving], velocity[moving] = found.basis @ own.position, found.basis @ own.velocity
    t = np.atleast_1d(elapsed)
    if given:
        position[given] = deviation @ np.array([t**0, t, t**2])
        velocity[given] = deviation @ np.array([0 * t, t**0, 2 * t])
    return Motion(position, velocity)


def servo_torque(model: ImpactModel, arrival: Arrival, motion: Motion) -> Array:
    """Return what a servo adds to the motors' torques for a deviation, n×K [N·m for 1 m/s]."""
    n = len(model.elastic)
    gains = np.array(model.position_gains(arrival.q), dtype=float)
    damping = model.drives.damping_gains
    torque = -gains @ motion.position[:n]
    if damping is None:
        return torque
    rates = np.array(damping, dtype=float)[list(model.independent)]
    return np.asarray(torque - rates * motion.velocity[:n])


def one_mass_scene(
    model: ImpactModel, arrival: Arrival, contact: Contact, tolerance: float
) -> Scene:
    """Return the scene of m_c alone (MSM Eq. 36)."""
    m_c = float(model.reflected_mass(arrival.q, arrival.direction))
    return masses_scene(np.array([m_c]), np.zeros(1), arrival.speed, contact, tolerance)


def two_mass_scene(
    model: ImpactModel, arrival: Arrival, contact: Contact, tolerance: float
) -> Scene:
    """Return the scene of m_c, k_r and m_a (MSM Eq. 1); both arrive with the same speed."""
    reduced = model.reduced(arrival.q, arrival.direction)
    m_c, k_r, m_a = (float(x) for x in (reduced.m_c, reduced.k_r, reduced.m_a))
    if not 0 < m_a < np.inf:
        raise InvalidValue(
            "fidelity",
            f"two_mass needs a spring between motors and contact point, but m_a is {m_a:g} kg; "
            "give a joint stiffness or use another model",
        )
    masses, springs = np.array([m_c, m_a]), np.array([k_r, 0.0])
    return masses_scene(masses, springs, arrival.speed, contact, tolerance)


def masses_scene(
    mass: Array, springs: Array, speed: float, contact: Contact, tolerance: float
) -> Scene:
    """Return the scene of masses in a row that arrive together; the first is hit.

    Args:
        mass: of each [kg].
        springs: behind each [N/m]; the last one leads to a ground that moves on.
        speed: of all [m/s].
        contact: with the body.
        tolerance: of the integrator.
    """
    root = np.sqrt(mass)
    stiffness = np.diag(springs) + np.diag([0.0, *springs[:-1]])
    stiffness -= np.diag(springs[:-1], 1) + np.diag(springs[:-1], -1)
    squared, vectors = np.linalg.eigh(stiffness / np.outer(root, root))
    size = len(mass)
    simulator = modal_simulator(size, BodyKind.of(contact), False, tolerance)
    given = [np.zeros(3 * size), [0.0, 1.0, 0.0]]
    parameters = np.concatenate([[speed], squared, vectors[0] / root[0], *given])
    stages, still = one_stage(simulator, parameters, np.zeros(size), memory=1)
    return Scene(stages, still, speed, contact)
