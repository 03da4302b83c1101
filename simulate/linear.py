# SPDX-License-Identifier: BSD-3-Clause
"""Linear models of the robot, from a single mass to all its coordinates, as vibration modes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from softimpact.symbolic import (
    Chain,
    Contact,
    ImpactModel,
    InvalidValue,
    generalised_velocity,
)
from softimpact.symbolic.impact.chain import ChainEnd
from softimpact.symbolic.robot.rigid import Array

from .mechanism import BodyKind, Mechanism
from .simulator import Scene, Simulator, build_simulator


@dataclass(frozen=True, eq=False)
class LinearSystem:
    """M z̈ + K z = −Jᵀ f_c, which starts from z = 0.

    Attributes:
        mass: M, N×N.
        stiffness: K, N×N.
        jacobian: J, length N; x_c = J z.
        velocity: ż(0) per 1 m/s of approach, length N.
    """

    mass: Array
    stiffness: Array
    jacobian: Array
    velocity: Array


def one_mass(model: ImpactModel, q: Array, direction: Array) -> LinearSystem:
    """Return m_c alone (MSM Eq. 36)."""
    m_c = _array(model.reflected_mass(q, direction))
    return LinearSystem(m_c, np.zeros((1, 1)), np.ones(1), np.ones(1))


def two_mass(model: ImpactModel, q: Array, direction: Array) -> LinearSystem:
    """Return m_c, k_r and m_a (MSM Eq. 1); both masses arrive with the contact point's speed."""
    reduced = model.reduced(q, direction)
    m_c, k_r, m_a = (float(x) for x in (reduced.m_c, reduced.k_r, reduced.m_a))
    if not 0 < m_a < np.inf:
        raise InvalidValue(
            "fidelity",
            f"two_mass needs a spring between motors and contact point, but m_a is {m_a:g} kg; "
            "give a joint stiffness or use another model",
        )
    K = k_r * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return LinearSystem(np.diag([m_c, m_a]), K, np.array([1.0, 0.0]), np.ones(2))


def linearised(
    model: ImpactModel, q: Array, direction: Array, link_velocity: Array
) -> LinearSystem:
    """Return the whole robot around rest (MSM Eq. 5).

    Args:
        model: the robot.
        q: link angles, length n.
        direction: unit vector n.
        link_velocity: per 1 m/s of approach, length n.
    """
    linear = model.linear(q, direction)
    return LinearSystem(
        _array(linear.mass.matrix),
        _array(linear.stiffness),
        _array(linear.jacobian).ravel(),
        generalised_velocity(model, link_velocity),
    )


def chain_of_masses(
    model: ImpactModel,
    q: Array,
    direction: Array,
    link_velocity: Array,
    order: int,
    end: ChainEnd | None,
) -> LinearSystem:
    """Return the robot as a chain; its masses start with Wᵀ q̇.

    Args:
        model: the robot.
        q: link angles, length n.
        direction: unit vector n.
        link_velocity: per 1 m/s of approach, length n.
        order: number of masses; fewer where the chain closes before.
        end: of the chain; None keeps the last mass's spring to ground where a controller holds the
            motors, and drops it where they are free.
    """
    check_order(model, order)
    end = end or ("grounded" if _is_held(model) else "free")
    masses = model.chain(q, direction, order, end, reorthogonalise=True)
    velocity = _array(masses.displacement).T @ generalised_velocity(model, link_velocity)
    first = np.eye(masses.order)[0]
    return LinearSystem(_chain_mass(masses), chain_stiffness(masses), first, velocity)


def check_order(model: ImpactModel, order: int) -> None:
    """Raise InvalidValue if a robot has no chain of so many masses."""
    if not 1 <= order <= model.size:
        raise InvalidValue("order", f"must be from 1 to {model.size}, the robot's coordinates")


def _is_held(model: ImpactModel) -> bool:
    return bool(model.drives.computed_torque_gain) or bool(np.any(_array(model.drives.gains)))


def _chain_mass(masses: Chain) -> Array:
    return np.diag([float(m) for m in masses.mass])


def chain_stiffness(masses: Chain) -> Array:
    """Return the stiffness matrix of a chain's springs, r×r."""
    K = np.zeros((masses.order, masses.order))
    for i, stiffness in enumerate(masses.stiffness):
        K[i, i] += float(stiffness)
        if i + 1 < masses.order:
            K[i + 1, i + 1] += float(stiffness)
            K[i, i + 1] = K[i + 1, i] = -float(stiffness)
    return K


def _array(matrix: ArrayLike) -> Array:
    return np.array(matrix, dtype=float)


@dataclass(frozen=True, eq=False)
class Modes:
    """A linear system by its modes y, of mass one: ÿ + ω² y = −φ f_c and x_c = φᵀ y.

    Attributes:
        squared_frequency: ω², length N [1/s²].
        shape: φ, length N [1/√kg].
        velocity: ẏ(0) per 1 m/s of approach, length N.
    """

    squared_frequency: Array
    shape: Array
    velocity: Array


def modes(system: LinearSystem) -> Modes:
    """Return the modes of a linear system."""
    root = np.linalg.cholesky(system.mass)
    half = np.linalg.solve(root, system.stiffness)
    squared_frequency, shapes = np.linalg.eigh(np.linalg.solve(root, half.T))
    shape = shapes.T @ np.linalg.solve(root, system.jacobian)
    return Modes(squared_frequency, shape, shapes.T @ (root.T @ system.velocity))


def modal_scene(system: LinearSystem, speed: float, contact: Contact, tolerance: float) -> Scene:
    """Return the scene of a linear system's impact.

    Args:
        system: the robot.
        speed: of the approach [m/s].
        contact: with the body.
        tolerance: of the integrator.
    """
    found = modes(system)
    simulator = modal_simulator(len(found.shape), BodyKind.of(contact), tolerance)
    parameters = np.concatenate([found.squared_frequency, found.shape])
    return Scene(simulator, parameters, found.velocity, speed, contact)


@lru_cache(maxsize=64)
def modal_simulator(size: int, kind: BodyKind, tolerance: float) -> Simulator:
    """Return the simulator of any linear system with ``size`` coordinates.

    Its parameters are ω² and φ.
    """
    y, rate, force = ca.SX.sym("y", size), ca.SX.sym("dy", size), ca.SX.sym("f_c")
    squared_frequency, shape = ca.SX.sym("w2", size), ca.SX.sym("phi", size)
    robot = Mechanism(
        position=y,
        velocity=rate,
        force=force,
        parameters=ca.vertcat(squared_frequency, shape),
        acceleration=-squared_frequency * y - shape * force,
        displacement=ca.dot(shape, y),
    )
    return build_simulator(robot, kind, tolerance)
