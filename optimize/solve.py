# SPDX-License-Identifier: BSD-3-Clause
"""Solve the design NLP from one start; everything here runs in a worker process."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Literal

import casadi as ca
import numpy as np

from softimpact.symbolic.robot.rigid import Array

from .nlp import POSE, Program, Shape, nlp_solver, peak_rows
from .peaks import WINDOWS, hides_a_peak, valley

Mode = Literal["table", "free"]
"""``table``: the posture is given and k_s is sought; ``free``: both are sought."""

IPOPT: dict[str, Any] = {
    "hessian_approximation": "limited-memory",
    "limited_memory_max_history": 20,
    "max_iter": 300,
    "tol": 1e-5,
    "acceptable_tol": 1e-4,
    "acceptable_iter": 8,
}
"""Options of Ipopt: the exact Hessian halves the iterations but costs seven times each."""

EXCHANGES = 3
"""How often an NLP is solved at most, its windows of time set anew in between."""

WORTH_AGAIN = 1e-3
"""Share of the force by which setting the windows anew must help to be done once more."""


def quiet(ipopt: dict[str, Any]) -> dict[str, Any]:
    """Return options of CasADi's nlpsol for an Ipopt that prints nothing and raises nothing."""
    silent = {**ipopt, "print_level": 0, "sb": "yes"}
    return {"ipopt": silent, "print_time": False, "error_on_fail": False}


@dataclass(frozen=True, eq=False)
class Instance:
    """An NLP with its numbers.

    Attributes:
        shape: of the NLP.
        tasks: numbers of each posture's task, K×size.
        impacts: numbers of each impact, C×``NUMBERS``.
        units: force that counts as one in each impact, C [N].
    """

    shape: Shape
    tasks: Array
    impacts: Array
    units: Array


@dataclass(frozen=True, eq=False)
class Start:
    """Where a search begins.

    Attributes:
        name: of the pose.
        mode: table or free.
        points: postures [rad] and stiffnesses [N·m/rad] to start from; the best answer counts.
        fallbacks: the same, to try in turn if no search from the points succeeds.
    """

    name: str
    mode: Mode
    points: tuple[tuple[Array, Array], ...]
    fallbacks: tuple[tuple[Array, Array], ...] = ()


@dataclass(frozen=True, eq=False)
class Bounds:
    """Limits of the variables, length n each."""

    q_lower: Array
    q_upper: Array
    springs_lower: Array
    springs_upper: Array


@dataclass(frozen=True, eq=False)
class Outcome:
    """What a search found.

    Attributes:
        name: of the pose it started from.
        mode: table or free.
        status: Ipopt's.
        solved: whether a local optimum was found.
        iterations: of all attempts.
        attempts: number of searches.
        seconds: wall time.
        q: posture, length n [rad].
        springs: joint stiffness, length n [N·m/rad].
        force: largest peak over all contacts and ends of what the motors may do [N].
        violation: largest violation of a constraint, in the NLP's units (m, rad, shares).
    """

    name: str
    mode: Mode
    status: str
    solved: bool
    iterations: int
    attempts: int
    seconds: float
    q: Array
    springs: Array
    force: float
    violation: float


@dataclass(frozen=True, eq=False)
class Found:
    """Where Ipopt ended.

    Attributes:
        status: Ipopt's.
        success: whether it says that it is a local optimum.
        iterations: of all rounds.
        postures: K×n [rad].
        springs: joint stiffness, length n [N·m/rad].
        shares: largest peak of each impact over its unit, C.
        violation: largest violation of a task.
        multipliers: of all entries of g.
        spring_multipliers: of the bounds on each group's log10 k_s; positive at the upper one.
    """

    status: str
    success: bool
    iterations: int
    postures: Array
    springs: Array
    shares: Array
    violation: float
    multipliers: Array
    spring_multipliers: Array

    @property
    def worst(self) -> float:
        """The largest share."""
        return float(self.shares.max())


FEASIBLE = 1e-5
"""Violation up to which a point counts as feasible."""


IN_TURN = threading.Lock()
"""Held by a search: MUMPS, Ipopt's linear solver, is not thread-safe."""


@lru_cache(maxsize=16)
def _solver(program: Program, shape: Shape) -> ca.Function:
    return nlp_solver(program, shape, quiet(IPOPT))


def solve(program: Program, start: Start, bounds: Bounds, instance: Instance) -> Outcome:
    """Search from all points of a start, and from its fallbacks as long as Ipopt fails.

    Returns:
        The solved point of least force; if there is none, the feasible point of least force, else
        the one of least violation.
    """
    with IN_TURN:
        return _search(program, start, bounds, instance)


def _search(program: Program, start: Start, bounds: Bounds, instance: Instance) -> Outcome:
    begin = time.perf_counter()
    found = [_attempt(program, start, *point, bounds, instance) for point in start.points]
    for point in start.fallbacks:
        if any(outcome.solved for outcome in found):
            break
        found.append(_attempt(program, start, *point, bounds, instance))
    return replace(
        min(found, key=preference),
        iterations=sum(outcome.iterations for outcome in found),
        attempts=len(found),
        seconds=time.perf_counter() - begin,
    )


def preference(outcome: Outcome) -> tuple[bool, bool, float]:
    """Sort key: solved before feasible before the rest; then by force, or by violation."""
    feasible = outcome.violation <= FEASIBLE
    return not outcome.solved, not feasible, outcome.force if feasible else outcome.violation


def better(first: Outcome, second: Outcome) -> Outcome:
    """Return the preferred of two outcomes of one start, with the effort of both."""
    best = min(first, second, key=preference)
    return replace(
        best,
        iterations=first.iterations + second.iterations,
        attempts=first.attempts + second.attempts,
        seconds=first.seconds + second.seconds,
    )


def _attempt(
    program: Program, start: Start, q: Array, springs: Array, bounds: Bounds, instance: Instance
) -> Outcome:
    free = start.mode == "free"
    found = minimise(program, instance, bounds, q[None, :], springs, free=free)
    return Outcome(
        name=start.name,
        mode=start.mode,
        status=found.status,
        solved=found.success and found.violation <= FEASIBLE,
        iterations=found.iterations,
        attempts=1,
        seconds=0.0,
        q=found.postures[0],
        springs=found.springs,
        force=float((found.shares * instance.units).max()),
        violation=found.violation,
    )


def minimise(
    program: Program,
    instance: Instance,
    bounds: Bounds,
    postures: Array,
    springs: Array,
    *,
    free: bool,
) -> Found:
    """Run Ipopt, again with other windows of time where one of them hid a peak that matters.

    Args:
        program: the functions.
        instance: the NLP.
        bounds: on its variables.
        postures: to start from, or that are held, K×n [rad].
        springs: to start from, length n [N·m/rad].
        free: whether the postures are sought as well.
    """
    best = _round(program, instance, bounds, postures, springs, free)
    iterations = best[0].iterations
    for _ in range(EXCHANGES - 1):
        found, boundaries = best
        at = found.postures, found.springs
        forces = impact_forces(program, instance, *at)
        shares = np.array([f.max() for f in forces]) / instance.units
        active = shares > 0.98 * shares.max()
        hidden = [
            a and hides_a_peak(f, b) for a, f, b in zip(active, forces, boundaries, strict=True)
        ]
        if not any(hidden):
            break
        again = _round(program, instance, bounds, *at, free)
        iterations += again[0].iterations
        gained = 1 - again[0].worst / found.worst
        if _order(again[0]) < _order(found):
            best = again
        if gained < WORTH_AGAIN:
            break
    return replace(best[0], iterations=iterations)


def _order(found: Found) -> tuple[bool, float]:
    feasible = found.violation <= FEASIBLE
    return not (found.success and feasible), found.worst if feasible else found.violation


def impact_forces(
    program: Program, instance: Instance, postures: Array, springs: Array
) -> list[Array]:
    """Return the force of each impact over time [N]."""
    s = np.log10(springs)
    return [
        np.array(program.impacts[point]["forces"](np.concatenate([postures[k], s]), p)).ravel()
        for (k, point), p in zip(instance.shape.impacts, instance.impacts, strict=True)
    ]


def _round(
    program: Program,
    instance: Instance,
    bounds: Bounds,
    postures: Array,
    springs: Array,
    free: bool,
) -> tuple[Found, list[int]]:
    """Run Ipopt once; return what it found and the boundaries of its windows."""
    shape, n = instance.shape, program.n
    K, G = shape.postures, shape.springs
    first = [shape.groups.index(g) for g in range(G)]
    postures = np.clip(postures, bounds.q_lower, bounds.q_upper)
    springs = np.clip(springs, bounds.springs_lower, bounds.springs_upper)[first][
        list(shape.groups)
    ]
    forces = impact_forces(program, instance, postures, springs)
    boundaries = [valley(f) for f in forces]
    p = np.concatenate(
        [
            instance.tasks.ravel(),
            np.column_stack([instance.impacts, instance.units, boundaries]).ravel(),
        ]
    )
    worst = max(f.max() / unit for f, unit in zip(forces, instance.units, strict=True))
    held = postures.ravel(), postures.ravel()
    limits = np.tile(bounds.q_lower, K), np.tile(bounds.q_upper, K)
    q_least, q_most = limits if free else held
    h = [_tightest(bounds, shape, g) for g in range(G)]
    least = np.concatenate([[low for low, _ in h], q_least, [0.0]])
    most = np.concatenate([[high for _, high in h], q_most, [np.inf]])
    lower, upper = constraint_bounds(program, shape, free=free)
    solver = _solver(program, shape)
    solution = solver(
        x0=np.concatenate([np.log10(springs[first]), postures.ravel(), [worst]]),
        p=p,
        lbx=least,
        ubx=most,
        lbg=lower,
        ubg=upper,
    )
    x = np.clip(np.array(solution["x"]).ravel(), least, most)  # Ipopt relaxes bounds by 1e-8
    g, stats = np.array(solution["g"]).ravel(), solver.stats()
    rows = peak_rows(program, shape)
    violated = np.maximum(np.maximum(lower - g, g - upper), 0.0)[: rows.start]
    # where Ipopt gave up, F need not bound the forces
    shares = float(solution["x"][-1]) + g[rows].reshape(-1, WINDOWS).max(axis=1)
    found = Found(
        status=stats["return_status"],
        success=bool(stats["success"]),
        iterations=int(stats["iter_count"]),
        postures=x[G:-1].reshape(K, n),
        springs=10 ** x[:G][list(shape.groups)],
        shares=shares,
        violation=float(violated.max()),
        multipliers=np.array(solution["lam_g"]).ravel(),
        spring_multipliers=np.array(solution["lam_x"]).ravel()[:G],
    )
    return found, boundaries


def _tightest(bounds: Bounds, shape: Shape, group: int) -> tuple[float, float]:
    """Return the bounds on log10 k_s that all joints of a group keep."""
    joints = [i for i, g in enumerate(shape.groups) if g == group]
    lower, upper = bounds.springs_lower[joints].max(), bounds.springs_upper[joints].min()
    return float(np.log10(lower)), float(np.log10(upper))


def constraint_bounds(program: Program, shape: Shape, *, free: bool) -> tuple[Array, Array]:
    """Bounds on g: the tip's pose is held where the posture is free, all else is at most zero."""
    lower = np.full(peak_rows(program, shape).stop, -np.inf)
    upper = np.zeros(lower.size)
    for k in range(shape.postures):
        pose = slice(k * program.rows, k * program.rows + POSE)
        lower[pose], upper[pose] = (0.0, 0.0) if free else (-np.inf, np.inf)
    return lower, upper


def one_posture(groups: Sequence[int], ends: int) -> Shape:
    """Return the shape of an NLP with one posture, hit under each of some ends of the motors."""
    return Shape(tuple(groups), 1, tuple((0, 0) for _ in range(ends)))
