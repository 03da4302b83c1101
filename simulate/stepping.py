# SPDX-License-Identifier: BSD-3-Clause
"""Steps of many linear robots at once, each against a body, in NumPy.

Robot and body are linear but for the law of contact between them, so that each is stepped exactly
for a force that is linear from node to node; what is left in each step is one equation for the
force, law(depth without it − softness · force) = force, solved for all impacts together. A leading
axis S counts impacts; numbers that they share may do without it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from softimpact.symbolic import BodyRegion
from softimpact.symbolic.body.laws import Law, PowerLaw
from softimpact.symbolic.body.laws.series import points_of
from softimpact.symbolic.robot.rigid import Array

from .exact_steps import DenseStep, body_system, dense_step, standing_compliance
from .history import HORIZON
from .law_solver import LawSolver, law_solver
from .linear import Given, LinearSystem, Modes
from .robot_steps import DampedSteps, UndampedSteps, robot_steps
from .scene import Motion

PHASE = 0.08
"""Most radians of the contact's vibration in a step: forces are then right to 1e-3."""

HARD = 500.0
"""Force [N] at which a plate's bounce on the skin must still be resolved."""

FEWEST_STEPS = 40
"""Fewest steps of a stage of the motors."""

SHORTEST = 1e-9
"""Shortest stage [s], for impacts in which it does not happen at all."""


@dataclass(frozen=True, eq=False)
class ManyPeaks:
    """Forces of many impacts [N], one entry each; see ``ImpactHistory``.

    Where the force rises to the end, its first peak is where it ends.
    """

    peak: Array
    first_contact: Array
    first_peak: Array
    pressing: Array


class LargestForces:
    """The largest forces of each impact so far [N].

    Attributes:
        peak: of all contacts up to a horizon.
        first_contact: until robot and body part.
        first_peak: first local maximum; where the force rises to the end, the last.
        pressing: from ``HORIZON`` on, on a clamped body.
    """

    def __init__(self, count: int, horizon: float, clamped: bool) -> None:
        self.horizon, self.clamped = horizon, clamped
        self.peak, self.first_contact, self.pressing = (np.zeros(count) for _ in range(3))
        self.first_peak = np.zeros(count)
        self._touched, self._fallen, self._parted = (np.zeros(count, dtype=bool) for _ in range(3))
        self._last, self._before = np.zeros(count), np.zeros(count)
        self._time = np.zeros(count)

    def see(self, time: Array, force: Array) -> None:
        """Take in the forces at a node; tops are those of parabolas through three nodes."""
        bend = self._before - 2 * self._last + force
        lean = force - self._before
        is_top = (self._last >= self._before) & (self._last >= force) & (bend < 0)
        rise = np.where(is_top, lean * lean / np.where(bend < 0, -8 * bend, 1.0), 0.0)
        top = np.maximum(force, self._last + rise)
        early = time <= self.horizon * (1 + 1e-9)
        crosses = ~early & (self._time < self.horizon)
        until = np.where(crosses, self._force_at(self.horizon, time, force), top)
        self.peak = np.where(early | crosses, np.maximum(self.peak, until), self.peak)
        self.first_peak = np.where(self._fallen, self.first_peak, top)
        self._fallen |= is_top & (force > 0) | self._touched & ~(force > 0)
        self._touched |= force > 0
        self.first_contact = np.where(
            self._parted, self.first_contact, np.maximum(self.first_contact, top)
        )
        self._parted |= self._touched & ~(force > 0)
        self.pressing = np.where(
            self.clamped & (time >= HORIZON * (1 - 1e-9)),
            np.maximum(self.pressing, self._pressing(time, force, top)),
            self.pressing,
        )
        self._before, self._last, self._time = self._last, force, time + 0.0 * force

    def _pressing(self, time: Array, force: Array, top: Array) -> Array:
        """Return the largest force since the node before, or since ``HORIZON`` if that is later."""
        at_horizon = self._force_at(HORIZON, time, force)
        return np.where(self._time < HORIZON, np.maximum(force, at_horizon), top)

    def _force_at(self, when: float, time: Array, force: Array) -> Array:
        """Return the force at a time since the node before, as on a line."""
        share = np.clip((time - when) / np.maximum(time - self._time, SHORTEST), 0.0, 1.0)
        return np.asarray(force + share * (self._last - force))

    @property
    def found(self) -> ManyPeaks:
        """What was seen."""
        return ManyPeaks(self.peak, self.first_contact, self.first_peak, self.pressing)


@dataclass(frozen=True, eq=False)
class Bodies:
    """What is hit, by all impacts alike or by each its own.

    Attributes:
        law: of contact.
        scale: factor on its force.
        system: A and b of ``body_system``.
        out: x_0 is this times the body's state, length m.
        standing: compliance that follows the force at once [m/N].
        stiffness: that a robot vibrates against at most [N/m]: k_h, or the law's where a plate has
            a mass, on which the skin bounces.
        mobility: that the body adds to the robot's [1/kg].
    """

    law: Law
    scale: float | Array
    system: tuple[Array, Array]
    out: Array
    standing: Array
    stiffness: Array
    mobility: Array

    @staticmethod
    def of(
        regions: Sequence[BodyRegion], clamped: bool, law: Law, scale: float | Array = 1.0
    ) -> Bodies:
        """Return bodies of some regions: one for all impacts, or one for each."""
        systems = [body_system(region, clamped) for region in regions]
        A, b = (np.array([system[i] for system in systems]) for i in (0, 1))
        if len(regions) == 1:
            A, b = A[0], b[0]
        bouncing = float(np.max(scale)) * _tangent(law, HARD)
        plate = [1 / r.plate_mass if r.plate_mass else 0.0 for r in regions]
        free = [0.0 if clamped else 1 / r.effective_mass for r in regions]
        return Bodies(
            law=law,
            scale=scale,
            system=(A, b),
            out=systems[0][2],
            standing=np.array([standing_compliance(region) for region in regions]),
            stiffness=np.array(
                [max(r.stiffness, bouncing if r.plate_mass else 0.0) for r in regions]
            ),
            mobility=np.array(plate) + np.array(free),
        )

    def frequency(self, robot_mobility: Array) -> Array:
        """Return ω of a contact [rad/s] with a robot of some mobility at its point [1/kg]."""
        return np.asarray(np.sqrt(self.stiffness * (robot_mobility + self.mobility)))


def _tangent(law: Law, force: float) -> float:
    """Return the slope of a law [N/m] at a force [N]."""
    if isinstance(law, PowerLaw):
        n = law.exponent
        return float(n * law.stiffness ** (1 / n) * force ** (1 - 1 / n))
    points = points_of(law)
    depth = np.interp(force, points.forces, points.depth)
    return float(points.evaluated(np.array([depth]))[1][0])


@dataclass(frozen=True, eq=False)
class State:
    """Where many impacts are when their motors begin to follow another law.

    Attributes:
        motion: of the robots' coordinates, S×N.
        body: states of the bodies, S×m.
        force: f_c [N], S.
    """

    motion: Motion
    body: Array
    force: Array


def at_first_touch(count: int, size: int, bodies: Bodies) -> State:
    """Return the state of many impacts at first touch, in deviations from the motion before."""
    still = Motion(np.zeros((count, size)), np.zeros((count, size)))
    return State(still, np.zeros((count, len(bodies.out))), np.zeros(count))


@dataclass(frozen=True, eq=False)
class SteppedStage:
    """Many impacts while their motors follow one law, ready to be stepped.

    Attributes:
        system: the robots.
        modes: of these.
        bodies: that they hit.
        begin: of the stage [s since first touch], one number or one for each impact.
        h: time step [s], likewise.
        steps: how many.
    """

    system: LinearSystem
    modes: Modes
    bodies: Bodies
    begin: Array
    h: Array
    steps: int
    _robot: UndampedSteps | DampedSteps
    _body: DenseStep
    _solver: LawSolver

    @staticmethod
    def of(
        system: LinearSystem,
        found: Modes,
        bodies: Bodies,
        begin: Array,
        end: Array,
        phase: float = PHASE,
    ) -> SteppedStage:
        """Prepare the steps of a stage.

        Args:
            system: the robots.
            found: their modes.
            bodies: that they hit.
            begin: of the stage, one number or one for each impact [s since first touch].
            end: of the stage, likewise.
            phase: most radians of the contact's vibration in a step.
        """
        span = np.maximum(np.asarray(end - begin), SHORTEST)
        rate = bodies.frequency((found.shape**2).sum(axis=-1))
        steps = max(FEWEST_STEPS, int(np.ceil((span * rate).max() / phase)))
        h = span / steps
        robot = robot_steps(found.squared_frequency, found.shape, found.damping, h)
        body = dense_step(*bodies.system, h)
        softness = bodies.standing + body.after[..., 0] @ bodies.out + robot.softness
        solver = law_solver(bodies.law, softness, bodies.scale)
        return SteppedStage(system, found, bodies, np.asarray(begin), h, steps, robot, body, solver)

    def run(self, given: Given, deviation: Array, state: State, largest: LargestForces) -> State:
        """Step through the stage; return where the impacts are then.

        Args:
            given: forces and displacements that do not depend on the impact, S×r×3 and S×3.
            deviation: of the motors whose motion is given, S×P×3.
            state: at the beginning.
            largest: forces so far; those of the stage are added.
        """
        F, shape, out = self.system.moving, self.modes.shape, self.bodies.out
        y = (self.modes.into @ state.motion.position[:, F, None])[..., 0]
        rate = (self.modes.into @ state.motion.velocity[:, F, None])[..., 0]
        body, force, nothing = state.body, state.force, np.zeros((len(state.force), 1))
        push_body = self._body.after[..., 0]
        has_given, depth, modal = bool(np.any(given.force)), None, given.force[..., 0]
        for k in range(1, self.steps + 1):
            t = k * self.h
            later = _at(given.force, t) if has_given else modal
            y, rate = self._robot.moved(y, rate, force, modal, later)
            body = self._body.moved(body, force[:, None], nothing)
            pushed = (y * shape).sum(axis=-1) + _at(given.displacement, t) - body @ out
            force, depth = self._solver.solve(pushed, depth)
            y, rate = self._robot.pushed(y, rate, force)
            body = body + push_body * force[:, None]
            modal = later
            largest.see(self.begin + t, force)
        return State(self._motion(deviation, y, rate), body, force)

    def _motion(self, deviation: Array, y: Array, rate: Array) -> Motion:
        F, P, T = self.system.moving, self.system.given, self.steps * self.h
        position, velocity = (np.zeros((len(y), len(F) + len(P))) for _ in range(2))
        position[:, F] = (self.modes.basis @ y[..., None])[..., 0]
        velocity[:, F] = (self.modes.basis @ rate[..., None])[..., 0]
        position[:, P] = _at(deviation, T)
        slope = np.stack([deviation[..., 1], 2 * deviation[..., 2], 0 * deviation[..., 0]], axis=-1)
        velocity[:, P] = _at(slope, T)
        return Motion(position, velocity)


def faster(given: Given, deviation: Array, speeds: Array) -> tuple[Given, Array]:
    """Return what is given for 1 m/s at each of some speeds [m/s]."""
    v, count = speeds[:, None], len(speeds)
    force = np.broadcast_to(given.force, (count, *given.force.shape[-2:]))
    ahead = np.broadcast_to(given.displacement, (count, 3))
    return Given(v[..., None] * force, v * ahead), v[..., None] * deviation


def slower(motion: Motion, speeds: Array) -> Motion:
    """Return motions at some speeds [m/s] as they would be at 1 m/s."""
    return Motion(motion.position / speeds[:, None], motion.velocity / speeds[:, None])


def _at(polynomial: Array, t: Array) -> Array:
    """Return c_0 + c_1 t + c_2 t² for coefficients on the last axis and t of shape () or (S,)."""
    t = t.reshape(t.shape + (1,) * (polynomial.ndim - 1 - t.ndim)) if t.ndim else t
    return np.asarray(polynomial[..., 0] + t * (polynomial[..., 1] + t * polynomial[..., 2]))
