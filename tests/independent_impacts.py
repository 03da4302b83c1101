# SPDX-License-Identifier: BSD-3-Clause
"""Impacts integrated by SciPy from the equations of links y and motors θ, written out anew.

With y and θ since first touch (springs unbent, both at q̇0), f the contact force:

    M ÿ + h = −k_s (y − θ) − D_joint (ẏ − q̇0) − Jᵀn f
    B θ̈     =  k_s (y − θ) + τ

A rigid joint has y = θ, and B beside M. ``linearised`` keeps M and J of first touch and takes
h = K_pot y; ``full`` takes all from Pinocchio, h less the torques that hold the robot at first
touch. τ is the motors' law; driven, braking and stopped motors have θ̈ given instead.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from oracles import Pinocchio
from scipy.integrate import solve_ivp

from softimpact.simulate import Approach
from softimpact.symbolic import Contact, ImpactModel, Motors
from softimpact.symbolic.robot.rigid import Array

Dynamics = Callable[[Array, Array], tuple[Array, Array, Array, float]]
"""From y and ẏ to M, h, Jᵀn and x_c."""


@dataclass(frozen=True, eq=False)
class Arm:
    """What the equations need, as numbers; vectors have one entry a joint."""

    dynamics: Dynamics
    rotors: Array
    springs: Array
    elastic: Array
    damping: Array
    gains: Array
    damping_gains: Array
    torque_limits: Array
    velocity: Array


def arm_of(model: ImpactModel, approach: Approach, *, full: bool) -> Arm:
    """Return an arm of elastic and rigid joints that all have motors, by Pinocchio."""
    oracle, q0 = Pinocchio.of_robot(model.robot), np.array(approach.q, dtype=float)
    n = np.array(approach.direction) / np.linalg.norm(approach.direction)
    nothing = np.zeros(len(q0))

    def push(q: Array) -> Array:
        return np.asarray(oracle.jacobian(model.tip, q)[:3].T @ n)

    def place(q: Array) -> float:
        return float(n @ oracle.pose(model.tip, q).translation)

    held, start = oracle.bias(q0, nothing, model.gravity), place(q0)
    M0, J0 = oracle.mass_matrix(q0), push(q0)
    step = 1e-5
    potential = np.column_stack(
        [
            oracle.bias(q0 + step * e, nothing, model.gravity)
            - oracle.bias(q0 - step * e, nothing, model.gravity)
            for e in np.eye(len(q0))
        ]
    ) / (2 * step)

    def linear(y: Array, dy: Array) -> tuple[Array, Array, Array, float]:
        return M0, potential @ y, J0, float(J0 @ y)

    def nonlinear(y: Array, dy: Array) -> tuple[Array, Array, Array, float]:
        q = q0 + y
        return (
            oracle.mass_matrix(q),
            oracle.bias(q, dy, model.gravity) - held,
            push(q),
            place(q) - start,
        )

    def numbers(vector: object) -> Array:
        return nothing if vector is None else np.array(vector, dtype=float).ravel()

    drives, given = model.drives, approach.link_velocity
    least = np.linalg.pinv(oracle.jacobian(model.tip, q0)[:3]) @ n
    velocity = np.asarray(least if given is None else given)
    gains = np.diag(numbers(drives.gains))
    if drives.computed_torque_gain is not None:
        gains = gains + float(drives.computed_torque_gain) * (M0 + np.diag(numbers(drives.rotors)))
    unlimited = np.full(len(q0), np.inf)
    limits = unlimited if drives.torque_limits is None else drives.torque_limits
    return Arm(
        nonlinear if full else linear,
        numbers(drives.rotors),
        numbers(drives.springs),
        np.array(drives.elastic),
        model.robot.damping,
        gains,
        numbers(drives.damping_gains),
        np.array(limits) if full else unlimited,
        approach.speed * velocity,
    )


Skin = Callable[[float], float]
"""Force [N] of skin and cover over their depth [m]."""


def hertz(contact: Contact) -> Skin:
    """Return Hertz's law of a contact."""
    return lambda depth: float(contact.hertz_stiffness * max(depth, 0.0) ** 1.5)


def force_by_scipy(
    arm: Arm,
    contact: Contact,
    motors: Motors,
    times: Array,
    tolerance: float = 1e-9,
    skin: Skin | None = None,
) -> Array:
    """Return the contact force at some times [N], the first of which is first touch.

    ``skin`` is the law of skin and cover where that is not Hertz's.
    """
    law_of = hertz(contact) if skin is None else skin
    n = len(arm.velocity)
    state = np.concatenate([np.zeros(2 * n), arm.velocity, arm.velocity, np.zeros(3)])
    found = [np.zeros((len(state), 0))]
    begins = [begin for begin, _ in motors.laws]
    ends = [*begins[1:], float(times[-1])]
    for (begin, law), end in zip(motors.laws, ends, strict=True):
        until = min(end, float(times[-1]))
        if until <= begin:
            continue
        rate = _rate(arm, contact, law_of, law, state[3 * n : 4 * n].copy(), motors)
        inside = times[(times >= begin) & (times < until)]
        solved = solve_ivp(
            rate,
            (begin, until),
            state,
            "LSODA",
            np.append(inside, until),
            rtol=tolerance,
            atol=1e-3 * tolerance,
            max_step=1e-3,
        )
        assert solved.success, solved.message
        state = solved.y[:, -1]
        found.append(solved.y[:, :-1])
    states = np.column_stack([*found, state])
    return np.array([_force(arm, law_of, s) for s in states.T])


def _force(arm: Arm, skin: Skin, state: Array) -> float:
    n = len(arm.velocity)
    x_c = arm.dynamics(state[:n], state[2 * n : 3 * n])[3]
    return skin(x_c - state[-1])


def _rate(
    arm: Arm, contact: Contact, skin: Skin, law: str, at_begin: Array, motors: Motors
) -> Callable[[float, Array], Array]:
    """Return the rate of y, θ, ẏ, θ̇, x_h, ẋ_h and x_0; ``at_begin`` is θ̇ as the law begins."""
    n, v, E = len(arm.velocity), arm.velocity, arm.elastic
    R, region = np.logical_not(E), contact.region
    prescribed = {
        "driven": np.zeros(n),
        "braking": -at_begin / motors.stopping_time,
        "stopped": np.zeros(n),
    }.get(law)

    def torque(t: float, theta: Array, speed: Array) -> Array:
        if law == "held":
            return -arm.gains @ theta
        if law == "servo":
            asked = arm.gains @ (v * t - theta) + arm.damping_gains * (v - speed)
            return np.clip(asked, -arm.torque_limits, arm.torque_limits)
        return np.zeros(n)

    def rate(t: float, state: Array) -> Array:
        y, theta, dy, dtheta = state[: 4 * n].reshape(4, n)
        x_h, v_h, x_0 = state[4 * n :]
        M, h, push, x_c = arm.dynamics(y, dy)
        f = skin(x_c - x_0)
        spring = np.where(E, arm.springs * (y - theta), 0.0)
        tau = torque(t, theta, dtheta)
        forces = -h - spring - arm.damping * (dy - v) - push * f
        if prescribed is None:
            whole = M + np.diag(np.where(R, arm.rotors, 0.0))
            ddy = np.linalg.solve(whole, forces + np.where(R, tau, 0.0))
            ddtheta = ddy.copy()
            ddtheta[E] = (spring + tau)[E] / arm.rotors[E]
        else:
            ddy, ddtheta = prescribed.copy(), prescribed
            if E.any():
                free = forces[E] - M[np.ix_(E, R)] @ prescribed[R]
                ddy[E] = np.linalg.solve(M[np.ix_(E, E)], free)
        a_h = 0.0 if contact.clamped else f / region.effective_mass
        slip = (f - region.stiffness * (x_0 - x_h)) / region.damping
        return np.concatenate([dy, dtheta, ddy, ddtheta, [v_h, a_h, v_h + slip]])

    return rate
