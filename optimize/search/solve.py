# SPDX-License-Identifier: BSD-3-Clause
"""Search springs and posture from some starts; everything here runs in a worker process."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import Literal

from softimpact.symbolic.robot.rigid import Array

from .deciding import minimise_deciding
from .ipopt import (
    IN_TURN,
    NO_OTHERS,
    Found,
    Instance,
    Rank,
    VariableBounds,
    minimise,
    rank,
    ranked,
)
from .minimax import WHOLE, Effort, least_worst, serves
from .nlp import Program

Mode = Literal["table", "free"]
"""``table``: the posture is given and k_s is sought; ``free``: both are sought."""


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
        others: values of the other variables of the hardware.
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
    others: Array = field(default_factory=lambda: NO_OTHERS)


def solve(program: Program, start: Start, bounds: VariableBounds, instance: Instance) -> Outcome:
    """Search from all points of a start, and from its fallbacks as long as Ipopt fails.

    Returns:
        The solved point of least force; if there is none, the feasible point of least force, else
        the one of least violation.
    """
    with IN_TURN:
        return _search(program, start, bounds, instance)


def _search(program: Program, start: Start, bounds: VariableBounds, instance: Instance) -> Outcome:
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


def preference(outcome: Outcome) -> Rank:
    """Sort key: solved before feasible before the rest; then by force, or by violation."""
    return ranked(outcome.solved, outcome.violation, outcome.force)


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
    program: Program,
    start: Start,
    q: Array,
    springs: Array,
    bounds: VariableBounds,
    instance: Instance,
) -> Outcome:
    free = start.mode == "free"
    found = minimise_deciding(program, instance, bounds, q[None, :], springs, free=free)
    iterations = found.iterations
    if not found.solved and serves(instance.shape.objective, free=free):
        again = least_worst(program, instance, bounds, q[None, :], found.springs, found.others)
        found = min(found, again, key=rank)
        iterations += again.iterations
    return Outcome(
        name=start.name,
        mode=start.mode,
        status=found.status,
        solved=found.solved,
        iterations=iterations,
        attempts=1,
        seconds=0.0,
        q=found.postures[0],
        springs=found.springs,
        force=float((found.shares * instance.units).max()),
        violation=found.violation,
        others=found.others,
    )


def search(
    program: Program,
    instance: Instance,
    bounds: VariableBounds,
    postures: Array,
    springs: Array,
    others: Array | None,
    free: bool,
    effort: Effort = WHOLE,
) -> Found:
    """Run ``least_worst`` or, where it does not serve or fails, ``minimise``, too."""
    shared = program, instance, bounds, postures, springs, others
    with IN_TURN:
        if not serves(instance.shape.objective, free=free):
            return minimise(*shared, free=free)
        found = least_worst(*shared, effort)
        if found.solved or effort != WHOLE:
            return found
        return min(found, minimise(*shared, free=free), key=rank)
