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
from softimpact.symbolic.impact.motors import MotorLaw
from softimpact.symbolic.matrices import Matrix
from softimpact.symbolic.robot.rigid import Array

from .history import HORIZON, PRESSED_UNTIL
from .linear import LinearSystem, given_motion, modes
from .stepping import (
    PHASE,
    Bodies,
    LargestForces,
    ManyPeaks,
    SteppedStage,
    at_first_touch,
    faster,
    slower,
)

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


class SampledImpacts:
    """The impacts of a robot with a body, ready for any speeds."""

    def __init__(
        self,
        model: ImpactModel,
        at: Samples,
        contact: Contact,
        motors: Motors,
        horizon: float = HORIZON,
        phase: float = PHASE,
    ) -> None:
        """Prepare them.

        Args:
            model: the robot.
            at: postures, directions, velocities, and numbers of the model that differ.
            contact: with the body.
            motors: what they do.
            horizon: up to which the largest force counts [s].
            phase: most radians of the contact's vibration in a step.
        """
        self.count, self.horizon, self.contact, self.motors = len(at), horizon, contact, motors
        self.until = max(horizon, PRESSED_UNTIL) if contact.clamped else horizon
        bodies = Bodies.of([contact.region], contact.clamped, contact.law)
        self.groups = [
            (rows, _Group(model, at.taken(rows), bodies, motors, self.until, phase))
            for rows in _alike(model, at, bodies)
        ]

    def peaks(self, speeds: Array) -> ManyPeaks:
        """Return the forces at speeds along n [m/s], one for each sample."""
        all_found = ManyPeaks(*(np.zeros(self.count) for _ in range(4)))
        for rows, group in self.groups:
            found = LargestForces(len(rows), self.horizon, self.contact.clamped)
            group.run(speeds[rows], found)
            for name, forces in vars(found.found).items():
                getattr(all_found, name)[rows] = forces
        if not self.contact.clamped:  # what gives way cannot be pressed
            all_found.pressing[:] = 0.0
        return all_found


def _alike(model: ImpactModel, at: Samples, bodies: Bodies) -> Iterator[NDArray[np.intp]]:
    """Yield rows that may share their steps in time."""
    if not len(at):
        return
    (mass,) = at.evaluated(lambda q, n: [model.reflected_mass(q, n)])
    rate = bodies.frequency(1 / mass.ravel())
    level = np.floor(np.log(rate / rate.min()) / np.log(ALIKE)).astype(int)
    for group in np.unique(level):
        rows = np.flatnonzero(level == group)
        for first in range(0, len(rows), AT_ONCE):
            yield rows[first : first + AT_ONCE]


class _Group:
    """Impacts that are stepped together."""

    def __init__(
        self,
        model: ImpactModel,
        at: Samples,
        bodies: Bodies,
        motors: Motors,
        until: float,
        phase: float,
    ) -> None:
        self.bodies, self.size, self.stopping_time = bodies, model.size, motors.stopping_time
        free = model.with_drives(model.drives.without_gains())
        with_gains, without = _matrices(model, at), _matrices(free, at)
        still = np.zeros((len(at), model.size - at.link_velocity.shape[1]))
        self.rate = np.hstack([at.link_velocity, still])
        pulls = with_gains if motors.kind == "held" else without
        drift = np.einsum("sij,sj->si", pulls[1], self.rate)
        ends = [begin for begin, _ in motors.laws[1:]] + [until]
        self.stages: list[tuple[MotorLaw, SteppedStage]] = []
        for (begin, law), end in zip(motors.laws, ends, strict=True):
            if min(end, until) > begin:
                whole = with_gains if law in ("servo", "held") else without
                system = _system(model.moving(law), whole, drift)
                span = np.array(begin), np.array(min(end, until))
                self.stages.append(
                    (law, SteppedStage.of(system, modes(system), bodies, *span, phase))
                )

    def run(self, speeds: Array, found: LargestForces) -> None:
        """Step through all stages."""
        state = at_first_touch(len(speeds), self.size, self.bodies)
        for law, stage in self.stages:
            given = given_motion(
                stage.system,
                stage.modes,
                law,
                slower(state.motion, speeds),
                self.rate,
                stage.begin,
                self.stopping_time,
            )
            state = stage.run(*faster(*given, speeds), state, found)


def _matrices(model: ImpactModel, at: Samples) -> tuple[Array, Array, Array | None, Array]:
    """Return M0, K0, D and J_c over all coordinates, S of each; D is None where nothing damps."""

    def build(q: Matrix, n: Matrix) -> list[Matrix]:
        damping = model.generalised_damping(q)
        square = [model.generalised_mass(q).matrix, model.generalised_stiffness(q)]
        return [model.contact_jacobian(q, n), *square, *([] if damping is None else [damping])]

    jacobian, mass, stiffness, *damping = at.evaluated(build)
    return mass, stiffness, damping[0] if damping else None, jacobian[:, 0]


def _system(
    moving: list[int], whole: tuple[Array, Array, Array | None, Array], drift: Array
) -> LinearSystem:
    mass, stiffness, damping, jacobian = whole
    block = np.ix_(range(len(mass)), moving, moving)
    return LinearSystem(
        shapes=np.eye(len(moving)),
        mass=mass[block],
        stiffness=stiffness[block],
        damping=None if damping is None else damping[block],
        jacobian=jacobian[:, moving],
        moving=moving,
        given=[i for i in range(mass.shape[-1]) if i not in moving],
        whole=(mass, stiffness, np.zeros_like(mass) if damping is None else damping, jacobian),
        drift=drift,
    )
