# SPDX-License-Identifier: BSD-3-Clause
"""Linear models whose motors follow a controller.

The computed torque leaves a PID times M_θθ around a reference that moves or stands, which is linear
too. What it adds to MSM Eq. 5 is the reference's motion, damping and the integral.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from softimpact.symbolic import (
    Chain,
    Contact,
    ImpactModel,
    LinearModel,
    chain,
    generalised_velocity,
)
from softimpact.symbolic.robot.rigid import Array

from .arrival import Arrival
from .controller import Controller
from .linear import chain_stiffness, check_order
from .mechanism import BodyKind, Mechanism
from .scene import Leg, Motion, Scene, Stage, unchanged
from .simulator import Simulator, build_simulator

DEPENDENT = 1e-12
"""Share of a motion's energy that the motions before it may leave for it to be no new one."""


@dataclass(frozen=True, eq=False)
class ControlledSystem:
    """z̈ = −K z − C (k_p z + k_d ż + k_i ∫z dt) − d w − φ f_c around the motors' reference.

    The reference moves the contact point by w, which grows with the speed of arrival or stays 0.

    Attributes:
        stiffness: K = M⁻¹ times what springs and gravity pull beyond the computed torque, N×N.
        motors: C = M⁻¹ times M_θθ on the motors, N×N.
        drift: d, what gravity pulls beyond the torque as the reference moves, length N.
        push: φ = M⁻¹Jᵀ, length N.
        jacobian: J, length N; x_c = J z + w.
        velocity: ż(0) per 1 m/s of approach, length N.
    """

    stiffness: Array
    motors: Array
    drift: Array
    push: Array
    jacobian: Array
    velocity: Array


def controlled(
    model: ImpactModel, arrival: Arrival, controller: Controller, order: int | None = None
) -> ControlledSystem:
    """Return the linearised robot with its controller, or a chain of it.

    The chain is that of the springs alone: its end is free, and the controller pushes on its
    masses as it does on the motors behind them. Where it closes before ``order`` masses, further
    motions follow that only the controller excites: that of the arrival, then those of K_p.

    Args:
        model: the robot; the controller takes the place of its K_p.
        arrival: how it arrives.
        controller: of its motors.
        order: number of the chain's masses; None keeps all coordinates.
    """
    linear = _with_gain(model, 0.0).linear(arrival.q, arrival.direction)
    M, K, C = _array(linear.mass.matrix), _array(linear.stiffness), _unit_gain(model, arrival.q)
    J = _array(linear.jacobian).ravel()
    velocity = generalised_velocity(model, arrival.link_velocity)
    K[np.flatnonzero(model.actuated)] = 0  # the computed torque holds potential forces everywhere
    drift = K @ velocity
    if order is not None:
        check_order(model, order)
        springs = chain(linear, order, "free", reorthogonalise=True)
        S = _shapes(linear, springs)
        if springs.order < order:
            held = _with_gain(model, controller.proportional).linear(arrival.q, arrival.direction)
            more = _shapes(held, chain(held, order, reorthogonalise=True))
            S = _extended(S, np.column_stack([velocity, more]), M, order)
        velocity = _array(np.linalg.solve(S.T @ M @ S, S.T @ M @ velocity))
        cut = springs.order == order < model.size
        K = chain_stiffness(springs) if cut else S.T @ K @ S
        M, C, J, drift = S.T @ M @ S, S.T @ C @ S, J @ S, S.T @ drift
    return ControlledSystem(
        stiffness=_array(np.linalg.solve(M, K)),
        motors=_array(np.linalg.solve(M, C)),
        drift=_array(np.linalg.solve(M, drift)),
        push=_array(np.linalg.solve(M, J)),
        jacobian=J,
        velocity=velocity,
    )


def _shapes(linear: LinearModel, masses: Chain) -> Array:
    """Return how the coordinates move with each mass of a chain, N×r."""
    W = _array(masses.displacement)
    return _array(linear.mass.solve(ca.DM(W * [float(m) for m in masses.mass])))


def _extended(shapes: Array, more: Array, mass: Array, count: int) -> Array:
    """Return ``count`` independent motions, those of ``shapes`` first."""
    found = shapes
    for motion in more.T:
        rest = motion
        for _ in range(2):
            rest = rest - found @ np.linalg.solve(found.T @ mass @ found, found.T @ mass @ rest)
        share = (rest @ mass @ rest) / (motion @ mass @ motion)
        if share > DEPENDENT and found.shape[1] < count:
            found = np.column_stack([found, rest / np.sqrt(rest @ mass @ rest)])
    return found


def _array(matrix: ArrayLike) -> Array:
    return np.array(matrix, dtype=float)


def _with_gain(model: ImpactModel, gain: float) -> ImpactModel:
    drives = replace(model.drives, gains=0 * model.drives.gains, computed_torque_gain=gain)
    return replace(model, drives=drives)


def _unit_gain(model: ImpactModel, q: Array) -> Array:
    """Return M_θθ on the motors, zero elsewhere, N×N: what K0 gains per unit of k_p."""
    with_gain, without = (
        np.array(_with_gain(model, gain).generalised_stiffness(q)) for gain in (1.0, 0.0)
    )
    return np.asarray(with_gain - without)


def controlled_scene(
    system: ControlledSystem,
    arrival: Arrival,
    controller: Controller,
    contact: Contact,
    tolerance: float,
) -> Scene:
    """Return the scene of a controlled linear robot's impact."""
    size = len(system.push)
    simulator = _controlled_simulator(size, BodyKind.of(contact), tolerance)
    follows = controller.reference == "moving"
    moving = arrival.speed if follows else 0.0
    velocity = 0 * system.velocity if follows else system.velocity
    gains = [controller.proportional, controller.derivative, controller.integral]
    fixed = [
        system.stiffness.ravel("F"),
        system.motors.ravel("F"),
        system.drift,
        system.push,
        system.jacobian,
        [moving],
    ]

    def stage(begin: float, gains: Sequence[float]) -> Stage:
        def enter(motion: Motion) -> Leg:
            memory = np.concatenate([[moving / arrival.speed * begin], np.zeros(size)])
            return Leg(simulator, np.concatenate([*fixed, gains]), motion, memory, unchanged)

        return Stage(begin, enter)

    stages: tuple[Stage, ...] = (stage(0.0, gains),)
    if np.isfinite(controller.reaction_time):
        stages = (*stages, stage(controller.reaction_time, [0.0, 0.0, 0.0]))
    still = Motion(np.zeros_like(velocity), velocity)
    return Scene(stages, still, arrival.speed, contact)


@lru_cache(maxsize=32)
def _controlled_simulator(size: int, kind: BodyKind, tolerance: float) -> Simulator:
    z, rate, summed = (ca.SX.sym(name, size) for name in ("z", "dz", "s"))
    force, wanted, wanted_speed = (ca.SX.sym(name) for name in ("f_c", "w", "v_w"))
    K, C = ca.SX.sym("K", size, size), ca.SX.sym("C", size, size)
    drift, push, jacobian = (ca.SX.sym(name, size) for name in ("d", "phi", "J"))
    gains = ca.SX.sym("k", 3)
    pid = gains[0] * z + gains[1] * rate + gains[2] * summed
    robot = Mechanism(
        position=z,
        velocity=rate,
        force=force,
        parameters=ca.vertcat(ca.vec(K), ca.vec(C), drift, push, jacobian, wanted_speed, gains),
        acceleration=-ca.mtimes(K, z) - ca.mtimes(C, pid) - drift * wanted - push * force,
        displacement=ca.dot(jacobian, z) + wanted,
        memory=ca.vertcat(wanted, summed),
        memory_rate=ca.vertcat(wanted_speed, z),
    )
    return build_simulator(robot, kind, tolerance)
