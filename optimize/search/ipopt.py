# SPDX-License-Identifier: BSD-3-Clause
"""Ipopt on one design NLP, with its windows of time set anew; runs in a worker process."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from softimpact.symbolic.robot.rigid import Array

from ..impact.peaks import NEARLY_AS_LARGE, WINDOWS, hides_a_peak, valley
from ..machine.postures import posture_limits
from ..objectives import Objective, WorstForce
from ..solver_options import FEASIBLE, quiet
from ..study.study import Study
from .nlp import SPEED, NlpShape, Program, nlp_solver, peak_rows
from .rows import by_rows, loaded

CURVATURE = 0.05
"""Of a share of the force over decades of stiffness and radians, where nothing is known yet: a
scale taken from the last step, as is usual, needs half as many steps more and ends in worse
optima, since single springs matter little and others much."""

IPOPT: dict[str, Any] = {
    "hessian_approximation": "limited-memory",
    "limited_memory_max_history": 8,
    "limited_memory_initialization": "constant",
    "limited_memory_init_val": CURVATURE,
    "max_iter": 300,
    "tol": FEASIBLE,
    "acceptable_tol": 1e-4,
    "acceptable_iter": 8,
}
"""Options of Ipopt: the exact Hessian halves the iterations but costs seven times each."""

EXCHANGES = 3
"""How often an NLP is solved at most, its windows of time set anew in between."""

LEAST_GAIN_OF_WINDOWS = 1e-3
"""Share of the force by which setting the windows anew must help to be done once more."""


@dataclass(frozen=True, eq=False)
class Instance:
    """An NLP with its numbers.

    Attributes:
        shape: of the NLP.
        tasks: numbers of each posture's task, K×size.
        impacts: numbers of each impact, C×``NUMBERS``.
        units: force that counts as one in each impact, C [N].
    """

    shape: NlpShape
    tasks: Array
    impacts: Array
    units: Array

    def shares(self, forces: Sequence[Array]) -> Array:
        """Return the largest force of each impact [N] over what counts as one there, C."""
        return np.array([force.max() for force in forces]) / self.units


@dataclass(frozen=True, eq=False)
class VariableBounds:
    """Limits of the variables.

    Attributes:
        q_lower, q_upper: of a posture, length n.
        springs_lower, springs_upper: of the joint stiffness, length n [N·m/rad].
        groups: of each joint, length n; joints of the same group share their spring.
        lower, upper: of v, the log10 of all values of the hardware, springs of groups first.
        start: of v.
    """

    q_lower: Array
    q_upper: Array
    springs_lower: Array
    springs_upper: Array
    groups: tuple[int, ...]
    lower: Array
    upper: Array
    start: Array

    @staticmethod
    def of(study: Study) -> VariableBounds:
        """Return the limits of a study."""
        ends = study.range
        logarithms = (np.log10(each) for each in (ends.lower, ends.upper, ends.start))
        return VariableBounds(
            *posture_limits(study.model), study.lower, study.upper, study.groups, *logarithms
        )

    @property
    def springs(self) -> int:
        """Number of stiffness variables."""
        return max(self.groups) + 1

    def vector(self, springs: Array, others: Array | None = None) -> Array:
        """Return v of some springs, length n, and other values; default those it starts with."""
        first = [self.groups.index(g) for g in range(self.springs)]
        rest = self.start[self.springs :] if others is None else np.log10(others)
        v = np.concatenate([np.log10(springs)[first], rest])
        return np.asarray(np.clip(v, self.lower, self.upper))

    def parted(self, v: Array) -> tuple[Array, Array]:
        """Return the springs, length n [N·m/rad], and the other values of v."""
        values = 10**v
        return values[: self.springs][list(self.groups)], values[self.springs :]


@dataclass(frozen=True, eq=False)
class Nlp:
    """What is to be solved: the functions of a study's NLPs, one with its numbers, and its limits.

    Attributes:
        program: the functions.
        instance: the NLP.
        bounds: on its variables.
    """

    program: Program
    instance: Instance
    bounds: VariableBounds


@dataclass(frozen=True, eq=False)
class Begin:
    """Where a search begins.

    Attributes:
        postures: to start from, or that are held, K×n [rad].
        springs: to start from, length n [N·m/rad].
        others: values of the other variables to start from; None: the machine as it is.
    """

    postures: Array
    springs: Array
    others: Array | None = None


NO_OTHERS = np.empty(0)
"""Values of no other variables."""


@dataclass(frozen=True, eq=False)
class Found:
    """Where Ipopt ended.

    Attributes:
        status: Ipopt's.
        success: whether it says that it is a local optimum.
        iterations: of all rounds.
        postures: K×n [rad].
        springs: joint stiffness, length n [N·m/rad].
        others: values of the other variables of the hardware.
        shares: largest peak of each impact over its unit, C.
        violation: largest violation of a task.
        multipliers: of all entries of g.
        range_multipliers: of the limits of v; positive at the upper one.
        own: the objective's variables.
        speeds: factor on the speed of each impact, C.
        cost: what was made small.
    """

    status: str
    success: bool
    iterations: int
    postures: Array
    springs: Array
    shares: Array
    violation: float
    multipliers: Array
    range_multipliers: Array
    others: Array
    own: Array
    speeds: Array
    cost: float

    @property
    def worst(self) -> float:
        """The largest share."""
        return float(self.shares.max())

    @property
    def solved(self) -> bool:
        """Whether it is a local optimum that keeps all bounds."""
        return self.success and self.violation <= FEASIBLE

    @property
    def end(self) -> Begin:
        """Where another search can go on."""
        return Begin(self.postures, self.springs, self.others)


Rank = tuple[bool, bool, float]
"""Not solved, not feasible, and what was made small; or the violation, where it is not."""


def ranked(solved: bool, violation: float, cost: float) -> Rank:
    """Sort key: solved before feasible before the rest; then by cost, or by violation."""
    feasible = violation <= FEASIBLE
    return not solved, not feasible, cost if feasible else violation


def rank(found: Found) -> Rank:
    """Return how good an end of a search is, less being better."""
    return ranked(found.solved, found.violation, found.cost)


IN_TURN = threading.Lock()
"""Held by a search: MUMPS, Ipopt's linear solver, is not thread-safe."""


@lru_cache(maxsize=16)
def _solver(program: Program, shape: NlpShape) -> ca.Function:
    return nlp_solver(program, shape, quiet(IPOPT))


def minimise(nlp: Nlp, begin: Begin, *, free: bool) -> Found:
    """Run Ipopt, again with other windows of time where one of them hid a peak that matters.

    With ``free`` the postures are sought as well.
    """
    instance, bounds = nlp.instance, nlp.bounds
    best = _round(nlp, begin.postures, bounds.vector(begin.springs, begin.others), free)
    iterations = best[0].iterations
    for _ in range(EXCHANGES - 1):
        found, boundaries = best
        v = bounds.vector(found.springs, found.others)
        forces = impact_forces(nlp.program, instance, found.postures, v, found.speeds)
        shares = instance.shares(forces)
        active = shares > NEARLY_AS_LARGE * shares.max()
        hidden = [
            a and hides_a_peak(f, b) for a, f, b in zip(active, forces, boundaries, strict=True)
        ]
        if not any(hidden):
            break
        again = _round(nlp, found.postures, v, free)
        iterations += again[0].iterations
        gained = (found.cost - again[0].cost) / abs(found.cost)
        if rank(again[0]) < rank(found):
            best = again
        if gained < LEAST_GAIN_OF_WINDOWS:
            break
    return replace(best[0], iterations=iterations)


def impact_forces(
    program: Program, instance: Instance, postures: Array, v: Array, speeds: Array | None = None
) -> list[Array]:
    """Return the force of each impact over time [N].

    Args:
        program: the functions.
        instance: the NLP.
        postures: K×n [rad].
        v: log10 of the hardware's values.
        speeds: factor on the speed of each impact; default 1.
    """
    y = felt(program, v)
    factors = np.ones(len(instance.impacts)) if speeds is None else speeds
    scaled = instance.shape.objective.scales_speed
    found = []
    for (k, point), p, factor in zip(
        instance.shape.impacts, instance.impacts, factors, strict=True
    ):
        x = np.concatenate([postures[k], y, [np.log10(factor)] if scaled else []])
        found.append(np.array(program.impacts[point]["forces"](x, p)).ravel())
    return found


def felt(program: Program, v: Array) -> Array:
    """Return log10 of what impacts feel of the hardware; of each row of several."""
    found = by_rows(loaded(program.hardware), np.atleast_2d(v))[0]
    return found if v.ndim > 1 else found[0]


def _round(nlp: Nlp, postures: Array, v: Array, free: bool) -> tuple[Found, list[int]]:
    """Run Ipopt once; return what it found and the boundaries of its windows."""
    program, instance, bounds = nlp.program, nlp.instance, nlp.bounds
    shape, n = instance.shape, program.n
    K, V = shape.postures, program.variables
    postures = np.clip(postures, bounds.q_lower, bounds.q_upper)
    forces = impact_forces(program, instance, postures, v)
    boundaries = [valley(f) for f in forces]
    p = np.concatenate(
        [
            instance.tasks.ravel(),
            np.column_stack([instance.impacts, instance.units, boundaries]).ravel(),
        ]
    )
    scenarios = np.array(shape.scenarios)
    shares = instance.shares(forces)
    own = shape.objective.own(scenarios, shares, instance.impacts[:, SPEED])
    held = postures.ravel(), postures.ravel()
    limits = np.tile(bounds.q_lower, K), np.tile(bounds.q_upper, K)
    q_least, q_most = limits if free else held
    least = np.concatenate([bounds.lower, q_least, own.lower])
    most = np.concatenate([bounds.upper, q_most, own.upper])
    lower, upper = constraint_bounds(program, shape, free=free)
    solver = _solver(program, shape)
    solution = solver(
        x0=np.concatenate([v, postures.ravel(), own.start]),
        p=p,
        lbx=least,
        ubx=most,
        lbg=lower,
        ubg=upper,
    )
    x = np.clip(np.array(solution["x"]).ravel(), least, most)  # Ipopt relaxes bounds by 1e-8
    g, stats = np.array(solution["g"]).ravel(), solver.stats()
    rows = peak_rows(program, shape)
    violated = np.maximum(np.maximum(lower - g, g - upper), 0.0)
    if not shape.objective.scales_speed:  # peaks may pass levels that the objective moves
        violated = violated[: rows.start]
    # where Ipopt gave up, the levels need not bound the forces
    ended = np.array(solution["x"]).ravel()[V + K * n :]
    levels = np.array(ca.DM(shape.objective.levels(ca.DM(ended), scenarios))).ravel()
    speeds = 10 ** np.array(ca.DM(shape.objective.speeds(ca.DM(ended), scenarios))).ravel()
    shares = levels + g[rows].reshape(-1, WINDOWS).max(axis=1)
    objective, given = shape.objective, instance.impacts[:, SPEED]
    if not objective.scales_speed:  # what the objective is with the forces that there are
        ended = objective.own(scenarios, shares, given).start
    springs, others = bounds.parted(x[:V])
    ended_at = x[V : V + K * n].reshape(K, n)
    found = Found(
        status=stats["return_status"],
        success=bool(stats["success"]) and assembled_alike(program, postures, ended_at),
        iterations=int(stats["iter_count"]),
        postures=ended_at,
        springs=springs,
        others=others,
        shares=shares,
        violation=float(violated.max()),
        multipliers=np.array(solution["lam_g"]).ravel(),
        range_multipliers=np.array(solution["lam_x"]).ravel()[:V],
        own=ended,
        speeds=speeds,
        cost=float(objective.cost(ca.DM(ended), scenarios, ca.DM(given))),
    )
    return found, boundaries


def assembled_alike(program: Program, before: Array, after: Array) -> bool:
    """Return whether loops are assembled the same way in postures, K×n each."""
    if not program.side:
        return True
    side = loaded(program.side)
    pairs = zip(before, after, strict=True)
    return all(float(side(first)) * float(side(last)) > 0 for first, last in pairs)


def constraint_bounds(program: Program, shape: NlpShape, *, free: bool) -> tuple[Array, Array]:
    """Bounds on g: a free posture holds the tip's pose and loops; all else is at most zero."""
    lower = np.full(peak_rows(program, shape).stop, -np.inf)
    upper = np.zeros(lower.size)
    for k in range(shape.postures):
        held = slice(k * program.rows, k * program.rows + program.held)
        lower[held], upper[held] = (0.0, 0.0) if free else (-np.inf, np.inf)
    return lower, upper


def one_posture(ends: int, objective: Objective | None = None) -> NlpShape:
    """Return the shape of an NLP with one posture, hit under each of some ends of the motors."""
    return NlpShape(1, ((0, 0),) * ends, (0,) * ends, objective or WorstForce())
