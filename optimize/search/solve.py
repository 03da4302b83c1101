# SPDX-License-Identifier: BSD-3-Clause
"""Search springs and posture from some starts; everything here runs in a worker process."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import Literal

from softimpact.symbolic.robot.rigid import Array

from ..solver_options import FEASIBLE
from .deciding import minimise_deciding
from .ipopt import (
    IN_TURN,
    NO_OTHERS,
    Begin,
    Found,
    Instance,
    Nlp,
    Rank,
    minimise,
    rank,
    ranked,
)
from .minimax import ROUGH, WHOLE, Effort, least_worst, serves

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


def solve(nlp: Nlp, start: Start) -> Outcome:
    """Search from all points of a start, and from its fallbacks as long as Ipopt fails.

    Returns:
        The solved point of least force; if there is none, the feasible point of least force, else
        the one of least violation.
    """
    with IN_TURN:
        return _search(nlp, start)


def _search(nlp: Nlp, start: Start) -> Outcome:
    begin = time.perf_counter()
    found = _held(nlp, start)
    if not any(outcome.solved for outcome in found):
        found += [_attempt(nlp, start, *point) for point in start.points]
    for point in start.fallbacks:
        if any(outcome.solved for outcome in found):
            break
        found.append(_attempt(nlp, start, *point))
    return replace(
        min(found, key=preference),
        iterations=sum(outcome.iterations for outcome in found),
        attempts=len(start.points) if len(found) == 1 else len(found),
        seconds=time.perf_counter() - begin,
    )


def _held(nlp: Nlp, start: Start) -> list[Outcome]:
    """Search a held posture roughly from each point, and from the best end of these to the end.

    Nothing where ``least_worst`` does not serve.
    """
    instance = nlp.instance
    if start.mode == "free" or not serves(instance.shape.objective, free=False):
        return []
    points = [Begin(q[None, :], springs) for q, springs in start.points]
    if len(points) == 1:
        found = least_worst(nlp, points[0])
        return [_outcome(start, instance, found, found.iterations)]
    rough = [least_worst(nlp, point, ROUGH) for point in points]
    best = min(rough, key=lambda end: (end.violation > FEASIBLE, end.cost))
    found = least_worst(nlp, best.end)
    iterations = found.iterations + sum(end.iterations for end in rough)
    return [_outcome(start, instance, found, iterations)]


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


def _attempt(nlp: Nlp, start: Start, q: Array, springs: Array) -> Outcome:
    free = start.mode == "free"
    found = minimise_deciding(nlp, Begin(q[None, :], springs), free=free)
    iterations = found.iterations
    if not found.solved and serves(nlp.instance.shape.objective, free=free):
        again = least_worst(nlp, found.end)
        found = min(found, again, key=rank)
        iterations += again.iterations
    return _outcome(start, nlp.instance, found, iterations)


def _outcome(start: Start, instance: Instance, found: Found, iterations: int) -> Outcome:
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


def search(nlp: Nlp, begin: Begin, free: bool, effort: Effort = WHOLE) -> Found:
    """Run ``least_worst`` or, where it does not serve or fails, ``minimise``, too."""
    with IN_TURN:
        if not serves(nlp.instance.shape.objective, free=free):
            return minimise(nlp, begin, free=free)
        found = least_worst(nlp, begin, effort)
        if found.solved or effort != WHOLE:
            return found
        return min(found, minimise(nlp, begin, free=free), key=rank)
