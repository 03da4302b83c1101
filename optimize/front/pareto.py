# SPDX-License-Identifier: BSD-3-Clause
"""Pareto fronts between accuracy and safety, by the ε-constraint method.

At each of some bounds on the deflection the design NLP is solved for the least peak force: with
each given posture held, and with the posture free. Searches start from what was found at the
neighbouring bounds, on both sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np

from softimpact.symbolic import InvalidValue
from softimpact.symbolic.record import Record, Row
from softimpact.symbolic.robot.rigid import Array

from ..evaluation import largest_deflection
from ..impact.timing import Timing
from ..meaning import meaning
from ..running.workers import Progress, cores, workers, works_elsewhere
from ..search.failure import SolverFailure
from ..search.ipopt import Begin, Nlp
from ..search.problem import Problem, prepare
from ..search.solve import Outcome, Start, better, preference, search, solve
from ..search.stiffest import Stiffest, stiffest
from ..study.study import Study
from .free_posture import first_forces, free_outcomes, softest_design
from .front import Front, front
from .levels import LEAST_ROOM, even_bounds, level_range
from .searches import Searches
from .sweep import Level, sweep

RIGID = 1e-12
"""Deflection [m] that counts as none."""

Outcomes = list[Outcome | None]
"""What was found at each level, None where it is out of reach."""


@dataclass(frozen=True, eq=False)
class FrontReference:
    """The design to improve on: the task's pose with the nominal stiffness.

    Attributes:
        q: posture, length n [rad].
        springs: joint stiffness, length n [N·m/rad].
        deflection: largest of the tip under the study's forces [m].
        force: largest peak [N].
    """

    q: Array
    springs: Array
    deflection: float
    force: float


@dataclass(frozen=True, eq=False)
class Pareto(Record):
    """Fronts of a study.

    Attributes:
        study: what was asked.
        levels: bounds on the deflection, ascending [m].
        free: springs and posture sought.
        given: the best of the given postures, springs sought.
        held: each given posture by name, springs sought.
        reference: the design to improve on.
        timing: of the impacts simulated.
        compiled: whether the NLP ran as machine code.
    """

    UNSHOWN = ("study", "timing")

    study: Study
    levels: Array
    free: Front
    given: Front
    held: dict[str, Front]
    reference: FrontReference
    timing: Timing
    compiled: bool

    @property
    def task(self) -> Front:
        """The front of the task's pose."""
        return self.held[self.study.task_pose.name]

    def rows(self) -> list[Row]:
        """Return a line for each point of the fronts."""
        fronts = {"free": self.free, "given": self.given, **self.held}
        return [
            {
                "front": name,
                "bound": point.bound,
                "deflection": point.deflection,
                "force": point.force,
                "from": point.outcome.name,
            }
            for name, front in fronts.items()
            for point in front.points
        ]

    @property
    def searches(self) -> int:
        """Number of Ipopt's runs at the levels."""
        fronts = (*self.held.values(), self.free)
        return sum(o.attempts for front in fronts for o in front.outcomes if o is not None)


def pareto_fronts(
    study: Study, executor: Executor | None = None, on_progress: Progress | None = None
) -> Pareto:
    """Find the least peak force at every accuracy.

    Args:
        study: the problem; its ``levels`` say at which accuracies.
        executor: where the searches run, as for ``design``.
        on_progress: called when a job ends, with its kind, how many of them ended, and their
            number.

    Raises:
        InvalidValue: the study asks for accuracies where there is nothing to find, or for ends of
            other objectives, or its forces bend no spring.
        SolverFailure: no search with a free posture was solved.
    """
    _require_deflection(study)
    if study.levels.ends:
        raise InvalidValue(
            f"{study.source}: pareto.ends",
            "is for fronts over objectives; a front of postures has pareto.lower and upper, or "
            "name pareto.objectives",
        )
    problem = prepare(study, elsewhere=works_elsewhere(executor))
    ends = {pose.pose.name: stiffest(study, pose.q, "table") for pose in problem.poses}
    accurate = _most_accurate(problem, ends)
    with workers(min(max(len(ends), study.levels.points), cores()), executor) as pool:
        searches = Searches(problem, pool, on_progress or (lambda *_: None))
        soft = softest_design(searches, ends)
        levels = _levels(searches, accurate, ends[study.task_pose.name], soft)
        held = _held(searches, ends, levels)
        free = free_outcomes(searches, levels, list(held.values()), accurate)
        _seed_held(searches, ends, levels, held, free)
        if not any(outcome.solved for outcome in free if outcome is not None):
            raise SolverFailure([outcome for outcome in free if outcome is not None])
        return _explained(searches, _fronts(problem, [level.bound for level in levels], held, free))


def _require_deflection(study: Study) -> None:
    if largest_deflection(study, study.task_pose.q, study.upper) < RIGID:
        raise InvalidValue(
            f"{study.source}: accuracy.forces",
            "none of them bends the springs, so that there is no accuracy to pay for",
        )


def _most_accurate(problem: Problem, ends: dict[str, Stiffest]) -> tuple[str, Stiffest]:
    """Return the most accurate design of all, with the name of the pose that led to it."""
    found = {name: stiffest(problem.study, end.q, problem.freest) for name, end in ends.items()}
    return min(found.items(), key=lambda item: item[1].deflection)


def _levels(
    searches: Searches, accurate: tuple[str, Stiffest], task: Stiffest, soft: Outcome
) -> list[Level]:
    """Return levels that are evenly spaced along a first front.

    The study's own bound and the most accurate design of the task's pose are added.
    """
    problem = searches.problem
    study = problem.study

    def placed(bounds: Array) -> list[Level]:
        return [Level(float(bound), problem.numbers(float(bound))) for bound in bounds]

    ideal = largest_deflection(study, soft.q, soft.springs)
    lower, upper = level_range(study, accurate[1].deflection, ideal)
    bounds = np.unique(np.geomspace(lower, upper, study.levels.points))
    bounds = even_bounds(bounds, first_forces(searches, placed(bounds), accurate, soft))
    more = (study.max_deflection, LEAST_ROOM * task.deflection)
    return placed(np.union1d(bounds, [bound for bound in more if lower < bound < upper]))


def _held(
    searches: Searches, ends: dict[str, Stiffest], levels: Sequence[Level]
) -> dict[str, Outcomes]:
    """Return what is found for each posture at each level."""
    problem = searches.problem
    found: dict[str, Outcomes] = {name: [None] * len(levels) for name in ends}
    jobs = {}
    for name, end in ends.items():
        reached = [level for level in levels if level.bound >= end.deflection]
        if reached:
            jobs[name] = (problem.program, name, end, problem.bounds, reached)
    for name, outcomes in searches.run("postures held", sweep, jobs):
        found[name][-len(outcomes) :] = outcomes
    return found


def _seed_held(
    searches: Searches,
    ends: dict[str, Stiffest],
    levels: Sequence[Level],
    held: dict[str, Outcomes],
    free: Sequence[Outcome | None],
) -> None:
    """Search the held postures from the springs that free ones ended with, too.

    Else an optimum of the springs that held searches missed would count as gained by posture.
    """
    problem = searches.problem
    jobs = {}
    for i, (level, found) in enumerate(zip(levels, free, strict=True)):
        if found is None or not found.solved:
            continue
        for name, end in ends.items():
            if held[name][i] is not None:
                start = Start(name, "table", ((end.q, found.springs),))
                jobs[name, i] = (Nlp(problem.program, level.numbers, problem.bounds), start)
    for (name, i), outcome in searches.run("held from free", solve, jobs):
        known = held[name][i]
        held[name][i] = outcome if known is None else better(known, outcome)


def _fronts(
    problem: Problem, bounds: Sequence[float], held: dict[str, Outcomes], free: Outcomes
) -> Pareto:
    study = problem.study
    given = [_least(column) for column in zip(*held.values(), strict=True)]
    if study.exact:  # a held posture that holds the task exactly is one that a free one may take
        free = [_least(pair) for pair in zip(free, given, strict=True)]
    return Pareto(
        study=study,
        levels=np.array(bounds),
        free=front(study, bounds, free),
        given=front(study, bounds, given),
        held={name: front(study, bounds, outcomes) for name, outcomes in held.items()},
        reference=_reference(problem),
        timing=problem.timing,
        compiled=problem.program.library,
    )


def _explained(searches: Searches, found: Pareto) -> Pareto:
    """Say what the points of the fronts that are told mean: what binds there, and what matters."""
    problem, task = searches.problem, found.study.task_pose.name
    told = {"free": found.free, "given": found.given, "task": found.task}
    points = {id(p.outcome): p for front in told.values() for p in front.points}
    jobs = {}
    for key, point in points.items():
        o, nlp = point.outcome, Nlp(problem.program, problem.numbers(point.bound), problem.bounds)
        jobs[key] = (nlp, Begin(o.q[None, :], o.springs, o.others), o.mode == "free")
    meant = {}
    for key, again in searches.run("prices", search, jobs):
        point, instance = points[key], jobs[key][0].instance
        meant[key] = meaning(problem, point.outcome, instance, again, point.bound)

    def explained(front: Front) -> Front:
        with_ = [replace(p, meaning=meant[id(p.outcome)]) for p in front.points]
        return replace(front, points=tuple(with_))

    held = {**found.held, task: explained(found.task)}
    return replace(found, free=explained(found.free), given=explained(found.given), held=held)


def _least(outcomes: Sequence[Outcome | None]) -> Outcome | None:
    """Return the best outcome of a level."""
    found = [outcome for outcome in outcomes if outcome is not None]
    return min(found, key=preference, default=None)


def _reference(problem: Problem) -> FrontReference:
    study = problem.study
    names = [pose.pose.name for pose in problem.poses]
    i = names.index(study.task_pose.name)
    q = problem.poses[i].q
    deflection = largest_deflection(study, q, study.nominal)
    return FrontReference(q, study.nominal, deflection, problem.before[i])
