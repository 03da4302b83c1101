# SPDX-License-Identifier: BSD-3-Clause
"""Co-design of joint stiffness and posture: every pose of a study, in both modes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from softimpact.symbolic import InvalidValue, Motors
from softimpact.symbolic.record import Record, Row
from softimpact.symbolic.robot.rigid import Array

from .answers import Price
from .evaluation import keeps_bounds, largest_deflection
from .impact.timing import Timing, study_impacts
from .meaning import meaning
from .running.workers import as_completed, awake, cores, workers, works_elsewhere
from .search.accurate_springs import accurate_springs
from .search.branches import branches
from .search.failure import SolverFailure
from .search.ipopt import IN_TURN, Begin, Nlp, minimise
from .search.optima import Optimum, distinct
from .search.problem import Problem, felt_numbers, peak_force, prepare
from .search.reach import infeasible, reach, reachable
from .search.solve import Mode, Outcome, Start, better, solve
from .study.poses import Candidate, candidates, leaves_a_choice
from .study.study import Study

MODES: tuple[Mode, ...] = ("table", "free")

LAGS_BEHIND = 1.003
"""Force over the best found from which on a free search is given another start."""


@dataclass(frozen=True, eq=False)
class PoseResult:
    """What the design found for one pose.

    Attributes:
        candidate: the pose.
        force_before: peak force with the nominal stiffness [N].
        deflection_before: largest deflection with the nominal stiffness [m].
        table: outcome with the posture held, None if that mode was not asked for.
        free: outcome with the posture sought as well, None likewise.
        keeps_before: whether the nominal stiffness keeps all bounds.
        fair: peak force [N] with springs in the nominal proportions that keep the bounds: the
            nominal ones where they do, else just stiff enough ones; None: ``force_before``.
    """

    candidate: Candidate
    force_before: float
    deflection_before: float
    table: Outcome | None
    free: Outcome | None
    keeps_before: bool = True
    fair: float | None = None

    @property
    def compared(self) -> float:
        """Peak force [N] to compare designs with."""
        return self.force_before if self.fair is None else self.fair


@dataclass(frozen=True, eq=False)
class Gains:
    """Where the gain over the task's pose comes from; forces in N.

    Attributes:
        before: the task's pose, nominal stiffness; where that breaks a bound, springs in its
            proportions that are just stiff enough.
        springs: the task's pose, best stiffness.
        posture: best of the given poses, likewise.
        both: best posture and stiffness.
    """

    before: float
    springs: float
    posture: float
    both: float


@dataclass(frozen=True, eq=False)
class DesignReference:
    """The design to compare with: the task's pose, springs in the nominal proportions.

    They are the nominal ones where these keep the bound on the deflection, else just stiff enough.

    Attributes:
        springs: joint stiffness, length n [N·m/rad].
        force: largest peak [N].
        deflection: under the study's forces [m].
    """

    springs: Array
    force: float
    deflection: float


@dataclass(frozen=True, eq=False)
class Answers:
    """What the winner's numbers mean.

    Attributes:
        deflection: of the winner [m].
        indifferent: range of each value of the hardware that costs less than 0.5 %, the others
            held, as many rows as ``study.range`` has names.
        prices: what each binding bound costs.
        worst_motors: under which the winner's force is largest.
        reference: that keeps the bounds, to compare with.
    """

    deflection: float
    indifferent: Array
    prices: tuple[Price, ...]
    worst_motors: Motors
    reference: DesignReference


@dataclass(frozen=True, eq=False)
class Design(Record):
    """Results of a study.

    Attributes:
        study: what was asked.
        poses: results in the study's order.
        winner: the solved outcome of least force.
        gains: what springs and posture bought; None if a mode that the task leaves open was not
            run, or the springs of the task's pose were not solved.
        answers: what the winner's numbers mean.
        timing: of the impacts simulated.
        compiled: whether the NLP ran as machine code.
        optima: different ones that free searches ended in before those that lag began again.
        branches: pieces of the self-motion that were searched; 0 where there is none.
    """

    UNSHOWN = ("study", "timing")

    study: Study
    poses: tuple[PoseResult, ...]
    winner: Outcome
    gains: Gains | None
    answers: Answers
    timing: Timing
    compiled: bool
    optima: tuple[Optimum, ...] = ()
    branches: int = 0

    def rows(self) -> list[Row]:
        """Return a line for each search: the pose it began with, posture, springs and force."""
        names, springs = self.study.robot.joint_names, self.study.spring_names
        return [
            {
                "pose": found.name,
                "mode": mode,
                "force": found.force,
                "force_before": pose.force_before,
                "deflection": largest_deflection(self.study, found.q, found.springs),
                "solved": found.solved,
                **{f"q_{name}": float(x) for name, x in zip(names, found.q, strict=True)},
                **{f"k_{name}": float(k) for name, k in zip(springs, found.springs, strict=True)},
            }
            for pose in self.poses
            for mode, found in (("table", pose.table), ("free", pose.free))
            if found is not None
        ]

    def outcomes(self, mode: Mode) -> list[Outcome]:
        """Return the outcomes of a mode, in the study's order."""
        found = [pose.table if mode == "table" else pose.free for pose in self.poses]
        return [outcome for outcome in found if outcome is not None]


def design(
    study: Study,
    modes: Sequence[Mode] = MODES,
    executor: Executor | None = None,
    on_outcome: Callable[[Outcome], None] | None = None,
) -> Design:
    """Find the joint stiffness and the posture of least peak force.

    Args:
        study: the problem.
        modes: ``table`` seeks k_s for each pose, ``free`` k_s and the posture from each pose; see
            ``applicable``.
        executor: where the searches run; default a process for each core. Threads of one process
            take turns, because Ipopt's linear solver is not thread-safe.
        on_outcome: called with every outcome as it arrives.

    Raises:
        InvalidValue: a pose, the stiffness or the modes do not fit the task.
        SolverFailure: no search was solved.
    """
    modes = applicable(study, modes)
    require_a_reachable_pose(study, modes)
    outcomes: dict[tuple[str, Mode], Outcome] = {}
    with workers(min(len(study.poses), cores()), executor) as pool:
        awake(pool, len(study.poses))
        problem = prepare(study, elsewhere=works_elsewhere(executor))
        poses = problem.poses
        for mode in modes:
            starts = [_start(study, p, mode, outcomes.get((p.pose.name, "table"))) for p in poses]
            for outcome in _run(problem, starts, pool):
                outcomes[outcome.name, outcome.mode] = outcome
                if on_outcome is not None:
                    on_outcome(outcome)
        found = branches(problem) if "free" in modes else []
        elsewhere = [Start(study.task_pose.name, "free", ((b.q, b.springs),)) for b in found]
        for outcome in _run(problem, elsewhere, pool):
            key = outcome.name, outcome.mode
            outcomes[key] = better(outcomes[key], outcome)
        optima = distinct([o for (_, mode), o in outcomes.items() if mode == "free"])
        for begin in (_stiffest_of, _best_of) if "free" in modes else ():
            for outcome in _run(problem, _laggards(study, poses, outcomes, begin), pool):
                key = outcome.name, outcome.mode
                outcomes[key] = better(outcomes[key], outcome)
    solved = [outcome for outcome in outcomes.values() if outcome.solved]
    if not solved:
        raise SolverFailure(list(outcomes.values()), study)
    results = tuple(
        PoseResult(
            pose,
            force,
            largest_deflection(study, pose.q, study.nominal),
            outcomes.get((pose.pose.name, "table")),
            outcomes.get((pose.pose.name, "free")),
            fair is None,
            fair,
        )
        for pose, force, fair in zip(
            poses, problem.before, (_fair(problem, pose.q) for pose in poses), strict=True
        )
    )
    winner = min(solved, key=lambda outcome: outcome.force)
    gains = _gains(study, results, winner.force)
    answers = _answers(problem, winner, results)
    compiled = problem.program.library
    return Design(
        study, results, winner, gains, answers, problem.timing, compiled, optima, len(found)
    )


def _answers(problem: Problem, winner: Outcome, results: Sequence[PoseResult]) -> Answers:
    """Return what the winner means: bounds that bind, numbers that matter, and a fair reference."""
    study, instance, free = problem.study, problem.numbers(), winner.mode == "free"
    with IN_TURN:
        end = Begin(winner.q[None, :], winner.springs, winner.others)
        again = minimise(Nlp(problem.program, instance, problem.bounds), end, free=free)
    meant = meaning(problem, winner, instance, again)
    task = next(r for r in results if r.candidate.pose.name == study.task_pose.name)
    at = task.candidate.q
    accurate = study.nominal if task.keeps_before else accurate_springs(study, at, study.nominal)
    return Answers(
        deflection=largest_deflection(study, winner.q, winner.springs, winner.others),
        indifferent=meant.indifferent,
        prices=meant.prices,
        worst_motors=_worst_motors(problem, winner),
        reference=DesignReference(
            accurate,
            task.compared,
            largest_deflection(study, at, accurate),
        ),
    )


def _fair(problem: Problem, q: Array) -> float | None:
    """Return the force [N] of springs just stiff enough, None where the nominal ones are."""
    study = problem.study
    if keeps_bounds(study, q, study.nominal):
        return None
    springs = accurate_springs(study, q, study.nominal)
    return peak_force(study, problem.program.impacts[0], problem.timing, q, springs)


def _worst_motors(problem: Problem, winner: Outcome) -> Motors:
    """Return what the motors do where the winner's force is largest."""
    impact = problem.program.impacts[0]
    y = felt_numbers(problem.study, impact.parts, winner.springs, winner.others)
    x, peaks = np.concatenate([winner.q, y]), impact["peaks"]
    rows = study_impacts(problem.study, problem.timing.step)
    forces = [np.array(peaks(x, row, 0)).max() for row in rows]
    return problem.study.motors[int(np.argmax(forces))]


def require_a_reachable_pose(study: Study, modes: Sequence[Mode]) -> None:
    """Raise Infeasible if no hardware keeps the bounds in any pose, moved if that is sought."""
    poses, free = candidates(study), "free" in modes
    if any(reachable(study, pose.q, free=free) for pose in poses):
        return
    nearest = min(poses, key=lambda pose: reach(study, [pose.q], study.bounds, free=free).excess)
    raise infeasible(study, [nearest], free=free)


def applicable(study: Study, modes: Sequence[Mode]) -> tuple[Mode, ...]:
    """Return those of some modes that a study's task leaves open, in the order of ``MODES``.

    Raises:
        InvalidValue: there are none.
    """
    left = tuple(mode for mode in MODES if mode in modes)
    if not leaves_a_choice(study):
        left = tuple(mode for mode in left if mode == "table")
    if not left:
        raise InvalidValue(
            "mode", "the task leaves this arm no other posture to seek; choose 'table'"
        )
    return left


def _start(study: Study, candidate: Candidate, mode: Mode, table: Outcome | None) -> Start:
    """Begin with the stiffest and with the softest springs, which lead to different local optima.

    Where springs were sought for the posture as given, a free one begins with these, so that
    freedom does not end in a worse optimum; who lags behind begins again, and a single pose, which
    lags behind none, with all. If all fail, the task's own posture is the last resort.
    """
    springs = [study.upper, study.lower]
    if table is not None:
        springs = [table.springs, *([] if len(study.poses) > 1 else springs)]
    points = tuple((candidate.q, each) for each in springs)
    fallbacks = ((study.task_pose.q, study.upper),) if mode == "free" else ()
    return Start(candidate.pose.name, mode, points, fallbacks)


BeginAgain = Callable[[Study, Candidate, Outcome], tuple[Array, Array]]
"""Where a laggard begins again: posture and springs, by the study, its pose and the best found."""


def _stiffest_of(study: Study, pose: Candidate, best: Outcome) -> tuple[Array, Array]:
    return pose.q, study.upper


def _best_of(study: Study, pose: Candidate, best: Outcome) -> tuple[Array, Array]:
    return best.q, best.springs


def _laggards(
    study: Study,
    poses: Sequence[Candidate],
    outcomes: dict[tuple[str, Mode], Outcome],
    begin: BeginAgain,
) -> list[Start]:
    """Return another start for free searches that failed or end above the best."""
    found = {name: outcome for (name, mode), outcome in outcomes.items() if mode == "free"}
    solved = [outcome for outcome in found.values() if outcome.solved]
    if not solved:
        return []
    best = min(solved, key=lambda outcome: outcome.force)
    late = {n for n, o in found.items() if not o.solved or o.force > LAGS_BEHIND * best.force}
    return [
        Start(pose.pose.name, "free", (begin(study, pose, best),))
        for pose in poses
        if pose.pose.name in late
    ]


def _run(problem: Problem, starts: Sequence[Start], pool: Executor) -> Iterator[Outcome]:
    nlp = Nlp(problem.program, problem.numbers(), problem.bounds)
    futures = [pool.submit(solve, nlp, start) for start in starts]
    for future in as_completed(futures):
        yield future.result()


def _gains(study: Study, results: Sequence[PoseResult], best: float) -> Gains | None:
    task = next(r for r in results if r.candidate.pose.name == study.task_pose.name)
    if task.table is None or not task.table.solved:
        return None
    if leaves_a_choice(study) and task.free is None:
        return None
    return Gains(
        before=task.compared,
        springs=task.table.force,
        posture=min(result.compared for result in results),
        both=best,
    )
