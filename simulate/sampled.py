# SPDX-License-Identifier: BSD-3-Clause
"""Many impacts that differ in posture, direction or the robot's own numbers at once, in NumPy.

As ``many``, but the linear systems differ from sample to sample; what does not depend on the speed
is prepared once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic import Contact, ImpactModel, Motors
from softimpact.symbolic.impact.motors import PRESCRIBED, MotorLaw
from softimpact.symbolic.matrices import Matrix
from softimpact.symbolic.robot.rigid import Array

from .exact_steps import DenseStep, body_system, dense_step, standing_compliance
from .history import HORIZON, PRESSED_UNTIL
from .law_solver import law_solver
from .many import FEWEST_STEPS, PHASE, LargestForces, ManyPeaks
from .robot_steps import DampedSteps, UndampedSteps, robot_steps

AT_ONCE = 2000
"""Most samples that are stepped together, for the memory's sake."""

ALIKE = 1.5
"""Samples whose contacts vibrate at rates within this factor are stepped together."""


@dataclass(frozen=True, eq=False)
class Samples:
    """Where and how a robot's contact point may hit something; each array has S rows.

    Attributes:
        q: link angles, S×n.
        direction: unit vectors n, S×3.
        link_velocity: of the independent joints per 1 m/s along n, S×n.
        values: of the symbols that the model has in place of numbers, S×p.
        symbols: these (SX), length p: rotors, springs or a payload, for example.
    """

    q: Array
    direction: Array
    link_velocity: Array
    values: Array | None = None
    symbols: Matrix | None = None

    def __len__(self) -> int:
        return len(self.q)

    def taken(self, rows: NDArray[np.intp]) -> Samples:
        """Return some of them."""
        values = None if self.values is None else self.values[rows]
        return Samples(
            self.q[rows], self.direction[rows], self.link_velocity[rows], values, self.symbols
        )

    def evaluated(self, build: Callable[[Matrix, Matrix], list[Matrix]]) -> list[Array]:
        """Return matrices of q and n at all samples, each S×rows×columns."""
        count = len(self)
        q, n = ca.SX.sym("q", self.q.shape[1]), ca.SX.sym("n", 3)
        own = ca.SX(0, 1) if self.symbols is None else self.symbols
        values = np.zeros((count, 0)) if self.values is None else self.values
        wanted = [ca.densify(x) for x in build(q, n)]
        function = ca.Function("sampled", [q, n, own], wanted).map(count)
        found = function.call([self.q.T, self.direction.T, values.T])
        return [
            np.array(x).reshape(want.shape[0], count, want.shape[1]).transpose(1, 0, 2)
            for x, want in zip(found, wanted, strict=True)
        ]


@dataclass(frozen=True, eq=False)
class _Systems:
    """M0, K0, D and J_c over all coordinates, S of each; D is None where nothing damps."""

    mass: Array
    stiffness: Array
    damping: Array | None
    jacobian: Array


def _systems(model: ImpactModel, at: Samples) -> _Systems:
    def build(q: Matrix, n: Matrix) -> list[Matrix]:
        damping = model.generalised_damping(q)
        square = [model.generalised_mass(q).matrix, model.generalised_stiffness(q)]
        return [model.contact_jacobian(q, n), *square, *([] if damping is None else [damping])]

    jacobian, mass, stiffness, *damping = at.evaluated(build)
    return _Systems(mass, stiffness, damping[0] if damping else None, jacobian[:, 0])


class SampledImpacts:
    """The impacts of a robot with a body, ready for any speeds."""

    def __init__(
        self,
        model: ImpactModel,
        at: Samples,
        contact: Contact,
        motors: Motors,
        horizon: float = HORIZON,
    ) -> None:
        """Prepare them.

        Args:
            model: the robot.
            at: postures, directions, velocities, and numbers of the model that differ.
            contact: with the body.
            motors: what they do.
            horizon: up to which the largest force counts [s].
        """
        self.count, self.horizon, self.contact, self.motors = len(at), horizon, contact, motors
        self.until = max(horizon, PRESSED_UNTIL) if contact.clamped else horizon
        self.groups = [
            (rows, _Group(model, at.taken(rows), contact, motors, self.until))
            for rows in _alike(model, at, contact)
        ]

    def peaks(self, speeds: Array) -> ManyPeaks:
        """Return the forces at speeds along n [m/s], one for each sample."""
        peak, first, pressing = (np.zeros(self.count) for _ in range(3))
        for rows, group in self.groups:
            found = LargestForces(len(rows), self.horizon)
            group.run(speeds[rows], found)
            peak[rows], first[rows] = found.peak, found.first_contact
            if self.contact.clamped:
                pressing[rows] = found.pressing
        return ManyPeaks(peak, first, pressing)


def _alike(model: ImpactModel, at: Samples, contact: Contact) -> Iterator[NDArray[np.intp]]:
    """Yield rows that may share their steps in time."""
    if not len(at):
        return
    (mass,) = at.evaluated(lambda q, n: [model.reflected_mass(q, n)])
    rate = np.sqrt(1 / mass.ravel() + _body_mobility(contact))
    level = np.floor(np.log(rate / rate.min()) / np.log(ALIKE)).astype(int)
    for group in np.unique(level):
        rows = np.flatnonzero(level == group)
        for first in range(0, len(rows), AT_ONCE):
            yield rows[first : first + AT_ONCE]


def _body_mobility(contact: Contact) -> float:
    region = contact.region
    plate = 1 / region.plate_mass if region.plate_mass else 0.0
    return plate + (0.0 if contact.clamped else 1 / region.effective_mass)


class _Group:
    """Impacts that are stepped together."""

    def __init__(
        self, model: ImpactModel, at: Samples, contact: Contact, motors: Motors, until: float
    ) -> None:
        free = model.with_drives(model.drives.without_gains())
        self.with_gains, self.without = _systems(model, at), _systems(free, at)
        rate = np.asarray(at.link_velocity)
        still = np.zeros((len(at), model.size - rate.shape[1]))
        self.rate = np.hstack([rate, still])
        self.stopping_time, self.size = motors.stopping_time, model.size
        pulls = self.with_gains if motors.kind == "held" else self.without
        self.drift = np.einsum("sij,sj->si", pulls.stiffness, self.rate)
        ends = [begin for begin, _ in motors.laws[1:]] + [until]
        self.stages = [
            _Stage(self, model, law, begin, min(end, until), contact)
            for (begin, law), end in zip(motors.laws, ends, strict=True)
            if min(end, until) > begin
        ]

    def run(self, speeds: Array, found: LargestForces) -> None:
        """Step through all stages."""
        S = len(speeds)
        position, velocity = np.zeros((S, self.size)), np.zeros((S, self.size))
        body, force = np.zeros((S, self.stages[0].body.transition.shape[-1])), np.zeros(S)
        for stage in self.stages:
            position, velocity, body, force = stage.run(
                speeds, position, velocity, body, force, found
            )


class _Stage:
    """The impacts of a group while the motors follow one law; see ``linear.LinearSystem``."""

    def __init__(
        self,
        group: _Group,
        model: ImpactModel,
        law: MotorLaw,
        begin: float,
        end: float,
        contact: Contact,
    ) -> None:
        self.group, self.law, self.begin = group, law, begin
        self.F = model.moving(law)
        self.P = [i for i in range(model.size) if i not in self.F]
        self.whole = group.with_gains if law in ("servo", "held") else group.without
        M = self.whole.mass[:, self.F][:, :, self.F]
        K = self.whole.stiffness[:, self.F][:, :, self.F]
        squared, self.basis = _modes(M, K)
        self.into = self.basis.transpose(0, 2, 1) @ M
        self.shape = np.einsum("sf,sfr->sr", self.whole.jacobian[:, self.F], self.basis)
        rate = contact.region.stiffness * (
            float((self.shape**2).sum(axis=1).max(initial=0.0)) + _body_mobility(contact)
        )
        self.steps = max(FEWEST_STEPS, int(np.ceil((end - begin) * np.sqrt(rate) / PHASE)))
        self.h = (end - begin) / self.steps
        A, b, self.out = body_system(contact.region, contact.clamped)
        self.body: DenseStep = dense_step(A, b, self.h)
        self.robot = self._robot_steps(squared)
        own = standing_compliance(contact.region) + float(self.out @ self.body.after[:, 0])
        self.solver = law_solver(contact.law, own + self.robot.softness)

    def _robot_steps(self, squared: Array) -> UndampedSteps | DampedSteps:
        D, basis = self.whole.damping, self.basis
        C = None if D is None else basis.transpose(0, 2, 1) @ D[:, self.F][:, :, self.F] @ basis
        return robot_steps(squared, self.shape, C, self.h)

    def run(
        self,
        speeds: Array,
        position: Array,
        velocity: Array,
        body: Array,
        force: Array,
        found: LargestForces,
    ) -> tuple[Array, Array, Array, Array]:
        """Step through the stage; return motion, body and force at its end."""
        deviation, given, ahead = self._given(speeds, position, velocity)
        y = np.einsum("srf,sf->sr", self.into, position[:, self.F])
        rate = np.einsum("srf,sf->sr", self.into, velocity[:, self.F])
        nothing = np.zeros((len(force), 1))
        first, depth = given[..., 0], None
        for k in range(1, self.steps + 1):
            t = k * self.h
            powers = np.array([1.0, t, t * t])
            later = given @ powers
            y, rate = self.robot.moved(y, rate, force, first, later)
            body = self.body.moved(body, force[:, None], nothing)
            pushed = (y * self.shape).sum(axis=1) + ahead @ powers - body @ self.out
            force, depth = self.solver.solve(pushed, depth)
            y, rate = self.robot.pushed(y, rate, force)
            body = body + self.body.after[:, 0] * force[:, None]
            first = later
            found.see(self.begin + t, force)
        T = self.h * self.steps
        position, velocity = np.zeros_like(position), np.zeros_like(velocity)
        position[:, self.F] = np.einsum("sfr,sr->sf", self.basis, y)
        velocity[:, self.F] = np.einsum("sfr,sr->sf", self.basis, rate)
        position[:, self.P] = deviation @ [1.0, T, T * T]
        velocity[:, self.P] = deviation @ [0.0, 1.0, 2 * T]
        return position, velocity, body, force

    def _given(self, speeds: Array, position: Array, velocity: Array) -> tuple[Array, Array, Array]:
        """Return what does not depend on the impact, as coefficients of 1, τ, τ².

        The motors' deviation S×P×3, the forces on the modes S×r×3, and the displacement S×3; see
        ``linear.given_motion``.
        """
        F, P, v = self.F, self.P, speeds[:, None]
        before, drift = v * self.group.rate[:, P], v * self.group.drift[:, F]
        deviation = np.zeros((len(speeds), len(P), 3))
        if self.law in PRESCRIBED:
            at, rate = position[:, P], velocity[:, P]
            bend = -(before + rate) / self.group.stopping_time
            if self.law != "braking":
                bend = np.zeros_like(rate)
            if self.law == "stopped":
                rate = -before
            deviation = np.stack([at, rate, bend / 2], axis=2)
        bent = 2 * deviation[..., 2]
        rates = np.stack([deviation[..., 1], bent, np.zeros_like(bent)], axis=2)
        forces = -self.whole.stiffness[:, F][:, :, P] @ deviation
        if self.whole.damping is not None:
            forces -= self.whole.damping[:, F][:, :, P] @ rates
        forces[..., 0] -= np.einsum("sfp,sp->sf", self.whole.mass[:, F][:, :, P], bent)
        forces[..., 0] -= drift * self.begin
        forces[..., 1] -= drift
        ahead = np.einsum("sp,spk->sk", self.whole.jacobian[:, P], deviation)
        ahead[:, 0] += speeds * self.begin
        ahead[:, 1] += speeds
        return deviation, self.basis.transpose(0, 2, 1) @ forces, ahead


def _modes(M: Array, K: Array) -> tuple[Array, Array]:
    """Return ω² and the modes of mass one, as columns."""
    root = np.linalg.cholesky(M)
    half = np.linalg.solve(root, K)
    squared, vectors = np.linalg.eigh(np.linalg.solve(root, half.transpose(0, 2, 1)))
    return squared, np.linalg.solve(root.transpose(0, 2, 1), vectors)
