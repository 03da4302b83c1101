# SPDX-License-Identifier: BSD-3-Clause
"""Peak forces of impacts in steps so short that they serve as golden results of a package.

Written for clarity and not for speed, and otherwise than the C: links and motors are one linear
system M z̈ + D ż + K z = −Jᵀf − (P q̇0) t beside the motion before the impact, stepped by its matrix
exponential; docs/impacts-in-c.md has the equations.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic.body.laws.points import CubicPoints
from softimpact.symbolic.robot.rigid import Array

ReferenceKind = Literal["free", "driven", "servo"]

STEP = 0.01
"""Radians of the contact's vibration in a step."""

LONGEST = 2e-5
"""Longest step [s]: the skin's force starts like t^1.5."""

TERMS = 16
"""Of the exponential's series, after it was halved until its argument is small."""


@dataclass(frozen=True)
class ReferenceBody:
    """What is hit: k_h [N/m], c_h [N·s/m], m_h [kg] (None if clamped), k_f [N/m^1.5] or a law."""

    stiffness: float
    damping: float
    mass: float | None
    skin: float | CubicPoints


@dataclass(frozen=True, eq=False)
class ReferenceArrival:
    """A robot about to touch.

    Attributes:
        mass: over links, n×n; with rotors where joints are rigid.
        potential: P, curvature of gravity and of the model's own springs, n×n.
        row: of the contact point along n.
        rates: joint velocities for an approach of 1 m/s.
        springs: k_s between links and motors; None where joints are rigid.
        rotors: B behind the springs.
        gains: K_p and K_d of a servo.
        motors: which coordinates have one.
        damping: of the joints' own, against the motion before.
    """

    mass: Array
    potential: Array
    row: Array
    rates: Array
    springs: Array | None
    rotors: Array
    gains: tuple[Array, Array]
    motors: NDArray[np.bool_]
    damping: Array


@dataclass(frozen=True)
class ReferenceMotors:
    """What motors do, and for how long the impact is looked at [s]."""

    kind: ReferenceKind
    reaction_time: float
    horizon: float


def reference_peak(
    arrival: ReferenceArrival, speed: float, body: ReferenceBody, motors: ReferenceMotors
) -> float:
    """Return the largest force [N] over all contacts up to the horizon."""
    kind: ReferenceKind = motors.kind if motors.reaction_time > 0 else "free"
    run = _Run(arrival, speed, body, kind)
    if kind == "free" or motors.reaction_time >= motors.horizon:
        run.until(motors.horizon)
        return run.best
    run.until(motors.reaction_time)
    run.release()
    run.until(motors.horizon)
    return run.best


@dataclass(frozen=True, eq=False)
class _System:
    """M z̈ + D ż + K z = −row f − pull t."""

    mass: Array
    damping: Array
    stiffness: Array
    row: Array
    pull: Array


def _system(arrival: ReferenceArrival, kind: ReferenceKind) -> _System:
    """Return the system over links and motors, or over what motors leave free."""
    n, P = len(arrival.row), arrival.potential
    K_p, K_d = arrival.gains if kind == "servo" else (np.zeros(n), np.zeros(n))
    pull = P @ arrival.rates
    if arrival.springs is None:
        at = ~arrival.motors if kind == "driven" else np.full(n, True)
        held = arrival.motors.astype(float)
        K = P + np.diag(K_p * held)
        grid = np.ix_(at, at)
        D = np.diag(K_d * held + arrival.damping)
        return _System(arrival.mass[grid], D[grid], K[grid], arrival.row[at], pull[at])
    k = np.diag(arrival.springs)
    if kind == "driven":
        return _System(arrival.mass, np.diag(arrival.damping), k + P, arrival.row, pull)
    zero, none = np.zeros((n, n)), np.zeros(n)
    return _System(
        np.block([[arrival.mass, zero], [zero, np.diag(arrival.rotors)]]),
        np.block([[np.diag(arrival.damping), zero], [zero, np.diag(K_d)]]),
        np.block([[k + P, -k], [-k, k + np.diag(K_p)]]),
        np.concatenate([arrival.row, none]),
        np.concatenate([pull, none]),
    )


class _Run:
    """Integrates one impact; positions are deviations z from the motion before."""

    def __init__(
        self, arrival: ReferenceArrival, speed: float, body: ReferenceBody, kind: ReferenceKind
    ) -> None:
        self.arrival, self.speed, self.body, self.kind = arrival, speed, body, kind
        self.system = _system(arrival, kind)
        size = len(self.system.row)
        self.z, self.rate = np.zeros(size), np.zeros(size)
        self.given = np.zeros(2)  # way and velocity of a body that gives way
        self.time = self.best = self.force = self.depth = self.slope = self.x = 0.0

    def release(self) -> None:
        """Let the motors go, whose deviation was none while they drove."""
        free = _system(self.arrival, "free")
        if self.kind == "driven":
            size, n = len(free.row), len(self.arrival.row)
            at = ~self.arrival.motors if self.arrival.springs is None else np.arange(n)
            z, rate = np.zeros(size), np.zeros(size)
            z[:n][at], rate[:n][at] = self.z, self.rate
            self.z, self.rate = z, rate
        self.system = free

    def until(self, end: float) -> None:
        """Step to a time."""
        s, body = self.system, self.body
        inverse = np.linalg.inv(s.mass) if len(s.row) else s.mass
        mobility = float(s.row @ inverse @ s.row) + (1 / body.mass if body.mass else 0)
        rate = math.sqrt(body.stiffness * mobility) + body.damping * mobility
        steps = math.ceil((end - self.time) / min(LONGEST, STEP / rate if rate else LONGEST))
        h = (end - self.time) / steps
        # state: z, ż, time, f at the start, and the change of f over the step
        size = len(s.row)
        A = np.zeros((2 * size + 4, 2 * size + 4))
        A[:size, size : 2 * size] = np.eye(size)
        A[size : 2 * size, :size] = -inverse @ s.stiffness
        A[size : 2 * size, size : 2 * size] = -inverse @ s.damping
        A[size : 2 * size, 2 * size] = -inverse @ s.pull * self.speed
        A[2 * size, 2 * size + 1] = 1
        A[size : 2 * size, 2 * size + 2] = -inverse @ s.row
        A[2 * size + 2, 2 * size + 3] = 1 / h
        E = _exponential(A * h)
        move = E[: 2 * size, : 2 * size]
        lead, pushed = E[: 2 * size, 2 * size : 2 * size + 2], E[: 2 * size, 2 * size + 2 :]
        state = np.concatenate([self.z, self.rate])
        row = np.concatenate([s.row, np.zeros(size)]), np.concatenate([np.zeros(size), s.row])
        both = np.array(row)
        gives = np.array([[h * h / 2, h * h / 6], [h, h / 2]]) / body.mass if body.mass else None
        soft = -both @ pushed[:, 1] + (gives[:, 1] if gives is not None else 0)
        for k in range(steps):
            t = self.time + k * h
            state = move @ state + lead @ [t, 1.0] + pushed[:, 0] * self.force
            x, v = both @ state + self.speed * np.array([t + h, 1.0])
            if gives is not None:
                self.given = np.array([self.given[0] + h * self.given[1], self.given[1]])
                self.given += gives[:, 0] * self.force
                x, v = x - self.given[0], v - self.given[1]
            # without the change of the force over the step, which ``change`` is
            before = self.force
            self._press(x + soft[0] * before, v + soft[1] * before, soft, h)
            change = self.force - before
            state = state + pushed[:, 1] * change
            if gives is not None:
                self.given += gives[:, 1] * change
        self.z, self.rate, self.time = state[:size], state[size:], end

    def _press(self, x: float, v: float, soft: Array, h: float) -> None:
        """Solve f = k s + c ṡ, s = x − soft f − δ, f = f(δ₊) for δ at the end of a step.

        Out of contact δ < 0 is the gap. δ̇ is a trapezoid's; the first one in a contact an Euler's.
        """
        k, c, skin = self.body.stiffness, self.body.damping, self.body.skin
        lag, memory = 1 / h, -self.depth / h
        if self.force > 0:
            lag, memory = 2 / h, -2 * self.depth / h - self.slope
        slack = 1 + k * soft[0] + c * soft[1]
        right = k * x + c * (v - memory)
        depth = 0.0
        if right > 0 and isinstance(skin, CubicPoints):
            depth, self.force = _pressed(skin, slack, k + c * lag, right)
        elif right > 0:
            depth = _depth(skin * slack, k + c * lag, right)
            self.force = skin * depth**1.5
        else:
            # s relaxes: c ṡ = −k s, and the gap is what is left
            rest = (self.x - self.depth) * (math.exp(-k * h / c) if c else 0.0)
            depth = min(0.0, x - rest)
            self.force = 0.0
        self.slope = lag * depth + memory
        self.depth, self.x = depth, x - soft[0] * self.force
        self.best = max(self.best, self.force)


def _depth(cubic: float, square: float, right: float) -> float:
    """Return δ > 0 with cubic δ^1.5 + square δ = right, by Newton's method on √δ from above."""
    u = float(min(math.sqrt(right / square), (right / cubic) ** (1 / 3)))
    for _ in range(50):
        over = u * u * (square + cubic * u) - right
        change = over / (u * (2 * square + 3 * cubic * u))
        u -= change
        if abs(change) < 1e-14 * u:
            break
    return u * u


def _pressed(law: CubicPoints, slack: float, square: float, right: float) -> tuple[float, float]:
    """Return δ and f(δ) with slack f(δ) + square δ = right, by Newton's method within bounds."""
    low, high, depth = 0.0, right / square, right / square
    for _ in range(200):
        force, slope = law.at(depth)
        over = slack * force + square * depth - right
        low, high = (low, depth) if over > 0 else (depth, high)
        change = over / (slack * slope + square)
        if abs(change) < 1e-13 * depth:
            break
        depth = depth - change if low < depth - change < high else (low + high) / 2
    return depth, law.at(depth)[0]


def _exponential(A: Array) -> Array:
    """Return e^A by its series, squared as often as A was halved."""
    halved = max(0, math.ceil(math.log2(max(float(abs(A).sum(axis=1).max()), 1e-300))) + 1)
    small = A / 2.0**halved
    total = term = np.eye(len(A))
    for i in range(1, TERMS):
        term = term @ small / i
        total = total + term
    for _ in range(halved):
        total = total @ total
    return np.asarray(total)


def reference_bracket(
    arrival: ReferenceArrival, speed: float, body: ReferenceBody, motors: ReferenceMotors
) -> float:
    """Return the worse of free motors and motors that drive on."""
    kinds: tuple[ReferenceKind, ...] = ("free", "driven")
    return max(reference_peak(arrival, speed, body, replace(motors, kind=kind)) for kind in kinds)
