# SPDX-License-Identifier: BSD-3-Clause
"""Linear models whose motors follow a controller.

The computed torque leaves a PID times M_θθ around a reference that moves or stands, which is linear
too. What it adds to MSM Eq. 5 is the reference's motion, damping and the integral.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import casadi as ca
import numpy as np

from softimpact.symbolic import Contact, ImpactModel, chain, generalised_velocity
from softimpact.symbolic.rigid import Array

from .approach import Arrival
from .controller import Controller
from .linear import chain_mass, chain_stiffness, check_order
from .mechanism import BodyKind, Mechanism
from .simulator import Scene, Simulator, Switch, build_simulator


@dataclass(frozen=True, eq=False)
class ControlledSystem:
    """z̈ = −K z − C (k_p e + k_d ė + k_i ∫e dt) − φ f_c with e = z − ż(0) t, or e = z when held.

    Attributes:
        stiffness: K = M⁻¹ times the springs' and gravity's stiffness, N×N.
        motors: C = M⁻¹ times M_θθ on the motors, N×N.
        push: φ = M⁻¹Jᵀ, length N.
        jacobian: J, length N; x_c = J z.
        velocity: ż(0) per 1 m/s of approach, length N.
    """

    stiffness: Array
    motors: Array
    push: Array
    jacobian: Array
    velocity: Array


def controlled(
    model: ImpactModel, arrival: Arrival, controller: Controller, order: int | None = None
) -> ControlledSystem:
    """Return the linearised robot with its controller, or its chain.

    Args:
        model: the robot; the controller takes the place of its K_p.
        arrival: how it arrives.
        controller: of its motors.
        order: number of the chain's masses; None keeps all coordinates.
    """
    springs = _with_gain(model, 0.0)
    linear = springs.linear(arrival.q, arrival.direction)
    M, K, C = (
        np.array(m) for m in (linear.mass.matrix, linear.stiffness, _unit_gain(model, arrival.q))
    )
    J, velocity = (
        np.array(linear.jacobian).ravel(),
        generalised_velocity(model, arrival.link_velocity),
    )
    if order is not None:
        check_order(model, order)
        masses = chain(linear, order, "free", reorthogonalise=True)
        W = np.array(masses.displacement)
        M, K = chain_mass(masses), chain_stiffness(masses)
        S = np.array(linear.mass.solve(ca.DM(W @ M)))
        C, J, velocity = S.T @ C @ S, J @ S, W.T @ velocity
    return ControlledSystem(
        stiffness=np.linalg.solve(M, K),
        motors=np.linalg.solve(M, C),
        push=np.linalg.solve(M, J),
        jacobian=J,
        velocity=velocity,
    )


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
        system.stiffness.ravel("F"), system.motors.ravel("F"), system.push, system.jacobian,
        [moving],
    ]  # fmt: skip
    before = np.concatenate([*fixed, gains])
    after = np.concatenate([*fixed, np.zeros(3)])
    switch = Switch(controller.reaction_time, after)
    return Scene(simulator, before, velocity, arrival.speed, contact, switch)


@lru_cache(maxsize=32)
def _controlled_simulator(size: int, kind: BodyKind, tolerance: float) -> Simulator:
    z, rate, summed = (ca.SX.sym(name, size) for name in ("z", "dz", "s"))
    force, wanted, wanted_speed = (ca.SX.sym(name) for name in ("f_c", "w", "v_w"))
    K, C = ca.SX.sym("K", size, size), ca.SX.sym("C", size, size)
    push, jacobian = ca.SX.sym("phi", size), ca.SX.sym("J", size)
    gains = ca.SX.sym("k", 3)
    pid = gains[0] * z + gains[1] * rate + gains[2] * summed
    robot = Mechanism(
        position=z,
        velocity=rate,
        force=force,
        parameters=ca.vertcat(ca.vec(K), ca.vec(C), push, jacobian, wanted_speed, gains),
        acceleration=-ca.mtimes(K, z) - ca.mtimes(C, pid) - push * force,
        displacement=ca.dot(jacobian, z) + wanted,
        memory=ca.vertcat(wanted, summed),
        memory_rate=ca.vertcat(wanted_speed, z),
    )
    return build_simulator(robot, kind, tolerance)
