# SPDX-License-Identifier: BSD-3-Clause
"""Springs and posture sought together, at one accuracy after another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from softimpact.symbolic.robot.rigid import Array

from ..search.branches import branches
from ..search.ipopt import Nlp
from ..search.solve import Mode, Outcome, Start, better, preference, solve
from ..search.stiffest import Stiffest
from .dominance import WORTH
from .levels import NO_BOUND
from .searches import Searches
from .sweep import Level, rescaled

POSTURES_TRIED_FIRST = 3
"""Held postures, the best at a level, from which the free one is first sought there."""

LevelStart = tuple[int, Start]
"""A level, by its place, and where to start there."""


def softest_design(searches: Searches, ends: dict[str, Stiffest]) -> Outcome:
    """Return the design of least force without a bound on the deflection.

    Args:
        searches: where they run.
        ends: postures to start from, by the pose's name.
    """
    level = Level(NO_BOUND, searches.problem.numbers(NO_BOUND))
    springs = searches.problem.bounds.springs_lower
    mode = searches.problem.freest
    tasks = [(0, Start(name, mode, ((end.q, springs),))) for name, end in ends.items()]
    best: dict[int, Outcome] = {}
    _improve(searches, "least force", [level], tasks, best)
    return best[0]


def first_forces(
    searches: Searches, levels: Sequence[Level], accurate: tuple[str, Stiffest], soft: Outcome
) -> Array:
    """Return the forces found at each level from the two ends of the front, NaN for none [N].

    Args:
        searches: where they run.
        levels: the stiffest first.
        accurate: the most accurate design, with the name of its pose.
        soft: the design of least force.
    """
    name, end = accurate
    limits, mode = searches.problem.bounds, searches.problem.freest
    tasks: list[LevelStart] = []
    for i, level in enumerate(levels):
        stiffer = rescaled(end.springs, end.deflection, level.bound, limits)
        softer = rescaled(soft.springs, levels[-1].bound, level.bound, limits)
        tasks.append((i, Start(name, mode, ((end.q, stiffer),))))
        tasks.append((i, Start(soft.name, mode, ((soft.q, softer),))))
    best: dict[int, Outcome] = {}
    _improve(searches, "levels", levels, tasks, best)
    return np.array([best[i].force if best[i].solved else np.nan for i in range(len(levels))])


def free_outcomes(
    searches: Searches,
    levels: Sequence[Level],
    held: Sequence[Sequence[Outcome | None]],
    accurate: tuple[str, Stiffest],
) -> list[Outcome | None]:
    """Return the best found at each level.

    The first searches begin where the best of the held postures ended. Then neighbours start each
    other, from both sides, for as long as that helps.

    Args:
        searches: where they run.
        levels: the stiffest first.
        held: what was found for each held posture at each level.
        accurate: the most accurate design, with the name of its pose.
    """
    name, end = accurate
    best: dict[int, Outcome] = {}
    mode = searches.problem.freest
    first = [(0, Start(name, mode, ((end.q, end.springs),))), *_from_held(held, mode)]
    if mode == "free":
        first += _from_branches(searches, levels)
    changed = _improve(searches, "free posture", levels, first, best)
    for _ in levels:
        tasks = _from_neighbours(searches, levels, best, changed)
        changed = _improve(searches, "exchange of neighbours", levels, tasks, best)
        if not changed:
            break
    return [best.get(i) for i in range(len(levels))]


def _from_held(held: Sequence[Sequence[Outcome | None]], mode: Mode) -> list[LevelStart]:
    tasks = []
    for i, column in enumerate(zip(*held, strict=True)):
        solved = sorted((o for o in column if o is not None and o.solved), key=preference)
        for outcome in solved[:POSTURES_TRIED_FIRST]:
            tasks.append((i, Start(outcome.name, mode, ((outcome.q, outcome.springs),))))
    return tasks


def _from_branches(searches: Searches, levels: Sequence[Level]) -> list[LevelStart]:
    """Start on every piece of the self-motion, where forces are least before any search."""
    name = searches.problem.study.task_pose.name
    return [
        (i, Start(name, "free", ((found.q, found.springs),)))
        for i, level in enumerate(levels)
        for found in branches(searches.problem, level.bound)
    ]


def _from_neighbours(
    searches: Searches, levels: Sequence[Level], best: dict[int, Outcome], changed: set[int]
) -> list[LevelStart]:
    """Start each level from its neighbours that changed, as stiff as it needs."""
    tasks, mode = [], searches.problem.freest
    for j in sorted(changed):
        if not best[j].solved:
            continue
        for i in (j - 1, j + 1):
            if 0 <= i < len(levels):
                bounds = levels[j].bound, levels[i].bound
                springs = rescaled(best[j].springs, *bounds, searches.problem.bounds)
                tasks.append((i, Start(best[j].name, mode, ((best[j].q, springs),))))
    return tasks


def _improve(
    searches: Searches,
    what: str,
    levels: Sequence[Level],
    tasks: Sequence[LevelStart],
    best: dict[int, Outcome],
) -> set[int]:
    """Put what is found into ``best``; return the levels that gained by more than rounding."""
    before, problem = dict(best), searches.problem
    jobs = {
        k: (Nlp(problem.program, levels[i].numbers, problem.bounds), start)
        for k, (i, start) in enumerate(tasks)
    }
    for k, outcome in searches.run(what, solve, jobs):
        i = tasks[k][0]
        best[i] = better(best[i], outcome) if i in best else outcome
    return {i for i in best if i not in before or _gained(before[i], best[i])}


def _gained(before: Outcome, after: Outcome) -> bool:
    if not (before.solved and after.solved):
        return after.solved and not before.solved
    return after.force < before.force * (1 - WORTH)
