# SPDX-License-Identifier: BSD-3-Clause
"""Many impacts of a linear robot at once, in NumPy.

Robot and body are linear but for the law of contact between them, so that each is stepped exactly
for a force that is linear from node to node; what is left in each step is one equation for the
force, law(depth without it − softness · force) = force, solved for all impacts together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from softimpact.symbolic import Contact, ImpactModel, Motors, generalised_velocity
from softimpact.symbolic.impact.motors import MotorLaw
from softimpact.symbolic.robot.rigid import Array

from .approach import Approach, Arrival, arrival_of
from .exact_steps import (
    DenseStep,
    ModalStep,
    body_system,
    dense_step,
    modal_step,
    standing_compliance,
)
from .history import HORIZON, PRESSED_UNTIL
from .law_solver import LawSolver, law_solver
from .linear import LinearSystem, Modes, given_motion, linear_system, modes
from .scene import Motion

PHASE = 0.08
"""Most radians of the contact's vibration in a step: forces are then right to 1e-3."""

FEWEST_STEPS = 40
"""Fewest steps of a stage of the motors."""


@dataclass(frozen=True, eq=False)
class ManyPeaks:
    """Forces of many impacts [N], one entry each; see ``ImpactHistory``.

    Where the force rises to the end, its first peak is where it ends.
    """

    peak: Array
    first_contact: Array
    first_peak: Array
    pressing: Array


def many_peaks(
    model: ImpactModel,
    approach: Approach,
    contact: Contact,
    speeds: ArrayLike,
    *,
    motors: Motors | None = None,
    horizon: float = HORIZON,
) -> ManyPeaks:
    """Return the peaks of one robot's linearised impacts at many speeds.

    Args:
        model: the robot.
        approach: how it arrives, but for the speed.
        contact: what it hits.
        speeds: of the approach [m/s], any number.
        motors: as in ``simulate_impact``.
        horizon: up to which the largest force counts [s].
    """
    arrival = arrival_of(model, approach)
    what = motors or Motors("servo" if model.drives.has_gains else "free")
    v = np.atleast_1d(np.asarray(speeds, dtype=float))
    until = max(horizon, PRESSED_UNTIL) if contact.clamped else horizon
    found = _Found(len(v), horizon)
    body = np.zeros((len(v), body_system(contact.region, contact.clamped)[0].shape[0]))
    force = np.zeros(len(v))
    motion = Motion(np.zeros((model.size, len(v))), np.zeros((model.size, len(v))))
    ends = [begin for begin, _ in what.laws[1:]] + [until]
    for (begin, law), end in zip(what.laws, ends, strict=True):
        if min(end, until) <= begin:
            continue
        stage = _Stage(model, arrival, contact, what, law, motion, begin, min(end, until), v)
        motion, body, force = stage.run(body, force, found)
    return ManyPeaks(found.peak, found.first_contact, found.first_peak, found.pressing)


class _Found:
    """The largest forces of each impact so far."""

    def __init__(self, count: int, horizon: float) -> None:
        self.horizon = horizon
        self.peak, self.first_contact, self.pressing = (np.zeros(count) for _ in range(3))
        self.first_peak = np.zeros(count)
        self.touched, self.fallen, self.parted = (np.zeros(count, dtype=bool) for _ in range(3))
        self.last, self.before, self.time = np.zeros(count), np.zeros(count), 0.0

    def see(self, time: float, force: Array) -> None:
        """Take in the forces at a node; tops are those of parabolas through three nodes."""
        bend = self.before - 2 * self.last + force
        lean = force - self.before
        is_top = (self.last >= self.before) & (self.last >= force) & (bend < 0)
        rise = np.where(is_top, lean * lean / np.where(bend < 0, -8 * bend, 1.0), 0.0)
        top = np.maximum(force, self.last + rise)
        if time <= self.horizon * (1 + 1e-9):
            self.peak = np.maximum(self.peak, top)
        elif self.time < self.horizon:
            share = (self.horizon - self.time) / (time - self.time)
            self.peak = np.maximum(self.peak, self.last + share * (force - self.last))
        self.first_peak = np.where(self.fallen, self.first_peak, top)
        self.fallen |= is_top & (force > 0) | self.touched & ~(force > 0)
        self.touched |= force > 0
        self.first_contact = np.where(
            self.parted, self.first_contact, np.maximum(self.first_contact, top)
        )
        self.parted |= self.touched & ~(force > 0)
        if time >= HORIZON * (1 - 1e-9):
            self.pressing = np.maximum(self.pressing, force)
        self.before, self.last, self.time = self.last, force, time


class _Stage:
    """The impacts while the motors follow one law."""

    def __init__(
        self,
        model: ImpactModel,
        arrival: Arrival,
        contact: Contact,
        motors: Motors,
        law: MotorLaw,
        motion: Motion,
        begin: float,
        end: float,
        speeds: Array,
    ) -> None:
        self.system: LinearSystem = linear_system(model, arrival, law)
        self.modes: Modes = modes(self.system)
        self.size, self.begin, self.speeds = model.size, begin, speeds
        F = self.system.moving
        self.start = (
            (self.modes.into @ motion.position[F]).T,
            (self.modes.into @ motion.velocity[F]).T,
        )
        before = generalised_velocity(model, arrival.link_velocity)
        per_sample = [
            given_motion(
                self.system,
                self.modes,
                law,
                Motion(motion.position[:, s] / v, motion.velocity[:, s] / v),
                before,
                begin,
                motors.stopping_time,
            )
            for s, v in enumerate(speeds)
        ]
        self.given = speeds[:, None, None] * np.array([g.force for g, _ in per_sample])
        self.ahead = speeds[:, None] * np.array([g.displacement for g, _ in per_sample])
        self.deviation = speeds[:, None, None] * np.array([d for _, d in per_sample])
        region = contact.region
        mobility = float((self.modes.shape**2).sum())
        mobility += 1 / region.plate_mass if region.plate_mass else 0.0
        mobility += 0.0 if contact.clamped else 1 / region.effective_mass
        rate = np.sqrt(region.stiffness * mobility)
        self.steps = max(FEWEST_STEPS, int(np.ceil((end - begin) * rate / PHASE)))
        self.h = (end - begin) / self.steps
        A, b, self.out = body_system(region, contact.clamped)
        self.body: DenseStep = dense_step(A, b, self.h)
        self.robot = _robot_step(self.modes, self.h)
        softness = standing_compliance(region) + float(self.out @ self.body.after[:, 0])
        self.solver: LawSolver = law_solver(contact.law, softness + self.robot.softness)
        self.standing = standing_compliance(region)

    def run(self, body: Array, force: Array, found: _Found) -> tuple[Motion, Array, Array]:
        """Step through the stage; return motion, body and force at its end."""
        y, rate = self.start
        nothing = np.zeros((len(force), 1))
        has_given = bool(np.any(self.given))
        powers = np.array([1.0, 0.0, 0.0])
        given = self.given @ powers
        depth = None
        for k in range(1, self.steps + 1):
            t = k * self.h
            powers = np.array([1.0, t, t * t])
            later = self.given @ powers if has_given else given
            y, rate = self.robot.moved(y, rate, force, given, later)
            body = self.body.moved(body, force[:, None], nothing)
            pushed = y @ self.modes.shape + self.ahead @ powers - body @ self.out
            force, depth = self.solver.solve(pushed, depth)
            y, rate = self.robot.pushed(y, rate, force)
            body = body + self.body.after[:, 0] * force[:, None]
            given = later
            found.see(self.begin + t, force)
        return self._motion(y, rate), body, force

    def _motion(self, y: Array, rate: Array) -> Motion:
        position, velocity = (np.zeros((self.size, len(y))) for _ in range(2))
        F, P, t = self.system.moving, self.system.given, self.h * self.steps
        position[F], velocity[F] = self.modes.basis @ y.T, self.modes.basis @ rate.T
        if P:
            position[P] = (self.deviation @ [1.0, t, t * t]).T
            velocity[P] = (self.deviation @ [0.0, 1.0, 2 * t]).T
        return Motion(position, velocity)


@dataclass(frozen=True, eq=False)
class _UndampedRobot:
    """Steps of modes that only meet in the contact force."""

    step: ModalStep
    shape: Array

    @property
    def softness(self) -> float:
        """What a unit force at the last node takes from the depth [m/N]."""
        return float(self.shape @ (self.step.after * self.shape))

    def moved(
        self, y: Array, rate: Array, force: Array, given: Array, later: Array
    ) -> tuple[Array, Array]:
        """Return modes after a step without the new force."""
        return self.step.moved(y, rate, given - force[:, None] * self.shape, later)

    def pushed(self, y: Array, rate: Array, force: Array) -> tuple[Array, Array]:
        """Return modes with the new force, too."""
        push = force[:, None] * self.shape
        return y - self.step.after * push, rate - self.step.after_rate * push


@dataclass(frozen=True, eq=False)
class _DampedRobot:
    """The same for modes that a damping couples."""

    step: DenseStep
    shape: Array

    @property
    def softness(self) -> float:
        n = len(self.shape)
        return float(self.shape @ self.step.after[:n] @ self.shape)

    def moved(
        self, y: Array, rate: Array, force: Array, given: Array, later: Array
    ) -> tuple[Array, Array]:
        n = len(self.shape)
        x = np.hstack([y, rate])
        x = self.step.moved(x, given - force[:, None] * self.shape, later)
        return x[:, :n], x[:, n:]

    def pushed(self, y: Array, rate: Array, force: Array) -> tuple[Array, Array]:
        n = len(self.shape)
        push = self.step.after @ self.shape
        return y - force[:, None] * push[:n], rate - force[:, None] * push[n:]


def _robot_step(found: Modes, h: float) -> _UndampedRobot | _DampedRobot:
    if found.damping is None:
        return _UndampedRobot(modal_step(found.squared_frequency, h), found.shape)
    n = len(found.shape)
    eye, zero = np.eye(n), np.zeros((n, n))
    A = np.block([[zero, eye], [-np.diag(found.squared_frequency), -found.damping]])
    return _DampedRobot(dense_step(A, np.vstack([zero, eye]), h), found.shape)
