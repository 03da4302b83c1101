# SPDX-License-Identifier: BSD-3-Clause
"""Steps of many linear robots at once, each against a body, in NumPy.

Robot and body are linear but for the law of contact between them, so that each is stepped exactly
for a force that is linear from node to node; what is left in each step is one equation for the
force, law(depth without it − softness · force) = force, solved for all impacts together. A leading
axis counts impacts, where the impacts differ.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from softimpact.symbolic import BodyRegion
from softimpact.symbolic.body.laws import Law
from softimpact.symbolic.robot.rigid import Array

from .exact_steps import (
    DenseStep,
    ModalStep,
    body_system,
    dense_step,
    modal_step,
    standing_compliance,
)
from .history import HORIZON
from .law_solver import LawSolver, law_solver
from .linear import Given, LinearSystem, Modes
from .scene import Motion

PHASE = 0.08
"""Most radians of the contact's vibration in a step: forces are then right to 1e-3."""

FEWEST_STEPS = 40
"""Fewest steps of a stage of the motors."""

SHORTEST = 1e-9
"""Shortest stage [s]: one that does not happen in some of many impacts."""


class Largest:
    """The largest forces of each impact so far [N].

    Attributes:
        peak: of all contacts up to a horizon.
        first_contact: until robot and body part.
        pressing: from ``HORIZON`` on.
    """

    def __init__(self, count: int, horizon: float) -> None:
        self.horizon = horizon
        self.peak, self.first_contact, self.pressing = (np.zeros(count) for _ in range(3))
        self._touched, self._parted = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
        self._last, self._before = np.zeros(count), np.zeros(count)

    def see(self, time: Array, force: Array) -> None:
        """Take in the forces at a node; tops are those of parabolas through three nodes."""
        bend = self._before - 2 * self._last + force
        lean = force - self._before
        is_top = (self._last >= self._before) & (self._last >= force) & (bend < 0)
        rise = np.where(is_top, lean * lean / np.where(bend < 0, -8 * bend, 1.0), 0.0)
        top = np.maximum(force, self._last + rise)
        early = time <= self.horizon * (1 + 1e-9)
        self.peak = np.where(early, np.maximum(self.peak, top), self.peak)
        self._touched |= force > 0
        self.first_contact = np.where(
            self._parted, self.first_contact, np.maximum(self.first_contact, top)
        )
        self._parted |= self._touched & ~(force > 0)
        late = time >= HORIZON * (1 - 1e-9)
        self.pressing = np.where(late, np.maximum(self.pressing, force), self.pressing)
        self._before, self._last = self._last, force


@dataclass(frozen=True, eq=False)
class Bodies:
    """What is hit, by all impacts alike or by each its own.

    Attributes:
        law: of contact.
        scale: factor on its force, S or scalar.
        system: A, b of ``body_system``; x_0 is ``out`` times its state.
        out: length m.
        standing: compliance that follows the force at once [m/N].
        fastest: ω of the contact [rad/s] for a robot's mobility [1/kg].
    """

    law: Law
    scale: Array
    system: tuple[Array, Array]
    out: Array
    standing: Array
    stiffness: Array
    mobility: Array

    @staticmethod
    def of(regions: list[BodyRegion], clamped: bool, law: Law, scale: Array) -> Bodies:
        """Return bodies of some regions: one for all impacts, or one for each."""
        systems = [body_system(region, clamped) for region in regions]
        A, b = (np.array([system[i] for system in systems]) for i in (0, 1))
        if len(regions) == 1:
            A, b = A[0], b[0]
        plate = [1 / r.plate_mass if r.plate_mass else 0.0 for r in regions]
        free = [0.0 if clamped else 1 / r.effective_mass for r in regions]
        return Bodies(
            law=law,
            scale=scale,
            system=(A, b),
            out=systems[0][2],
            standing=np.array([standing_compliance(region) for region in regions]),
            stiffness=np.array([region.stiffness for region in regions]),
            mobility=np.array(plate) + np.array(free),
        )

    @property
    def states(self) -> int:
        """Number of a body's states."""
        return len(self.out)


@dataclass(frozen=True, eq=False)
class State:
    """Where many impacts are when the motors begin to follow another law.

    Attributes:
        motion: of the robots' coordinates, S×N.
        body: states of the bodies, S×m.
        force: f_c [N], S.
    """

    motion: Motion
    body: Array
    force: Array


def run_stage(
    system: LinearSystem,
    found: Modes,
    given: Given,
    deviation: Array,
    bodies: Bodies,
    state: State,
    begin: Array,
    end: Array,
    largest: Largest,
) -> State:
    """Step many impacts through a stage of their motors; return where they are then.

    Args:
        system: the robots.
        found: their modes.
        given: forces and displacements that do not depend on the impact, S×r×3 and S×3.
        deviation: of the motors, whose motion is given, S×P×3.
        bodies: that they hit.
        state: at the beginning.
        begin: of the stage in each impact [s since first touch], S.
        end: of the stage in each, S.
        largest: forces so far; those of the stage are added.
    """
    span = np.maximum(end - begin, SHORTEST)
    stiffest = bodies.stiffness * ((found.shape**2).sum(axis=-1) + bodies.mobility)
    steps = max(FEWEST_STEPS, int(np.ceil((span * np.sqrt(stiffest)).max() / PHASE)))
    h = span / steps if np.ptp(span) else np.array(span[0] / steps)
    robot, shape = _robot_step(found, h), found.shape
    body_step = dense_step(*bodies.system, h)
    push_body = body_step.after[..., 0]
    softness = bodies.standing + push_body @ bodies.out + robot.softness
    solver: LawSolver = law_solver(bodies.law, softness, bodies.scale)
    F = system.moving
    y = (found.into @ state.motion.position[:, F, None])[..., 0]
    rate = (found.into @ state.motion.velocity[:, F, None])[..., 0]
    body, force, nothing = state.body, state.force, np.zeros((len(state.force), 1))
    has_given, depth = bool(np.any(given.force)), None
    modal = given.force[..., 0]
    for k in range(1, steps + 1):
        t = k * h
        later = _at(given.force, t) if has_given else modal
        y, rate = robot.moved(y, rate, force, modal, later)
        body = body_step.moved(body, force[:, None], nothing)
        pushed = (y * shape).sum(axis=-1) + _at(given.displacement, t) - body @ bodies.out
        force, depth = solver.solve(pushed, depth)
        y, rate = robot.pushed(y, rate, force)
        body = body + push_body * force[:, None]
        modal = later
        largest.see(begin + t, force)
    return State(_motion(system, found, deviation, y, rate, steps * h), body, force)


def _at(polynomial: Array, t: Array) -> Array:
    """Return c_0 + c_1 t + c_2 t² for coefficients on the last axis and t of shape () or (S,)."""
    t = t.reshape(t.shape + (1,) * (polynomial.ndim - 1 - t.ndim)) if t.ndim else t
    return np.asarray(polynomial[..., 0] + t * (polynomial[..., 1] + t * polynomial[..., 2]))


def _motion(
    system: LinearSystem, found: Modes, deviation: Array, y: Array, rate: Array, t: Array
) -> Motion:
    size = len(system.moving) + len(system.given)
    position, velocity = (np.zeros((len(y), size)) for _ in range(2))
    F, P = system.moving, system.given
    position[:, F] = (found.basis @ y[..., None])[..., 0]
    velocity[:, F] = (found.basis @ rate[..., None])[..., 0]
    position[:, P] = _at(deviation, t)
    slope = np.stack([deviation[..., 1], 2 * deviation[..., 2], 0 * deviation[..., 0]], axis=-1)
    velocity[:, P] = _at(slope, t)
    return Motion(position, velocity)


@dataclass(frozen=True, eq=False)
class _UndampedRobot:
    """Steps of modes that only meet in the contact force."""

    step: ModalStep
    shape: Array

    @property
    def softness(self) -> Array:
        """What a unit force at the last node takes from the depth [m/N]."""
        return np.asarray((self.shape * self.step.after * self.shape).sum(axis=-1))

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
    def _push(self) -> Array:
        return np.asarray((self.step.after @ self.shape[..., None])[..., 0])

    @property
    def softness(self) -> Array:
        n = self.shape.shape[-1]
        return np.asarray((self.shape * self._push[..., :n]).sum(axis=-1))

    def moved(
        self, y: Array, rate: Array, force: Array, given: Array, later: Array
    ) -> tuple[Array, Array]:
        n = self.shape.shape[-1]
        x = np.hstack([y, rate])
        x = self.step.moved(x, given - force[:, None] * self.shape, later)
        return x[:, :n], x[:, n:]

    def pushed(self, y: Array, rate: Array, force: Array) -> tuple[Array, Array]:
        n = self.shape.shape[-1]
        push = self._push * force[:, None]
        return y - push[:, :n], rate - push[:, n:]


def _robot_step(found: Modes, h: Array) -> _UndampedRobot | _DampedRobot:
    if found.damping is None:
        return _UndampedRobot(modal_step(found.squared_frequency, h[..., None]), found.shape)
    n = found.shape.shape[-1]
    top = np.hstack([np.zeros((n, n)), np.eye(n)])
    squared = found.squared_frequency[..., None] * np.eye(n)
    below = np.concatenate([-squared, -np.broadcast_to(found.damping, squared.shape)], axis=-1)
    A = np.concatenate([np.broadcast_to(top, below.shape), below], axis=-2)
    return _DampedRobot(dense_step(A, np.vstack([np.zeros((n, n)), np.eye(n)]), h), found.shape)
