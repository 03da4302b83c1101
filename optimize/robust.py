# SPDX-License-Identifier: BSD-3-Clause
"""One set of springs for all scenarios: the least worst force over its limit, by exchange.

An NLP holds the few scenarios that matter. All others are screened with what it finds, the worst
of them are added, and so on until none is worse than the NLP says. The last screening is the
certificate: a bound on every scenario, by evaluation.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from softimpact.symbolic.robot.rigid import Array

from .answers import Price, indifferent_ranges, prices_of
from .failure import Infeasible, SolverFailure
from .impact_program import impact_program
from .nlp import Program, Shape, task_numbers
from .poses import tip_pose
from .problem import study_program
from .repair import accurate_springs, largest_deflection
from .scenarios import Scenarios
from .screening import PIECE, Screened, largest_forces, screen
from .solve import FEASIBLE, IN_TURN, Bounds, Found, Instance, Outcome, minimise
from .stiffest import stiffest
from .study import Study
from .timing import Timing, scenario_timing
from .workers import as_completed, workers

ROUNDS = 40
"""Most exchanges."""

ADDED = 4
"""Scenarios added in an exchange: the worst, each of another pose, point or direction."""

CLOSED = 1e-4
"""Share by which a scenario may exceed what the NLP says: forces are no better known."""

KEEPS = 1e-6
"""Share of the deflection bound by which a design may miss it: Ipopt's tolerance."""


@dataclass(frozen=True, eq=False)
class Worst:
    """The worst scenario under some hardware.

    Attributes:
        index: of the scenario.
        force: its largest peak [N].
        share: of the force over its limit.
        deflection: largest over all poses [m].
    """

    index: int
    force: float
    share: float
    deflection: float


@dataclass(frozen=True, eq=False)
class RobustDesign:
    """One set of springs for all scenarios, and what the answer means.

    Attributes:
        study: what was asked.
        scenarios: all of them.
        springs: joint stiffness, length n [N·m/rad].
        postures: of each pose, P×n [rad].
        worst: scenario under these springs, over all scenarios by evaluation.
        before: the same with the nominal springs.
        equal: the same with springs in the proportions of the nominal ones, as soft or stiff as
            the deflection allows; with these springs.
        bound: share of the limit that the NLP says is the least, over its own scenarios.
        active: scenarios that the NLP held in the end.
        rounds: exchanges.
        indifferent: range of each joint's stiffness that costs less than 0.5 % over the active
            scenarios, the other joints' held, n×2 [N·m/rad].
        prices: what each binding bound costs.
        timing: of the impacts.
        compiled: whether they ran as machine code.
    """

    study: Study
    scenarios: Scenarios
    springs: Array
    postures: Array
    worst: Worst
    before: Worst
    equal: tuple[Worst, Array]
    bound: float
    active: tuple[int, ...]
    rounds: int
    indifferent: Array
    prices: tuple[Price, ...]
    timing: Timing
    compiled: bool


Progress = Callable[[str, int, int], None]


@dataclass(frozen=True, eq=False)
class _Setting:
    """What all exchanges share."""

    study: Study
    scenarios: Scenarios
    program: Program
    timing: Timing
    bounds: Bounds
    pool: Executor
    say: Progress

    @property
    def given(self) -> Array:
        """Postures as given, P×n [rad]."""
        return np.array([pose.q for pose in self.scenarios.poses])

    def worst(self, postures: Array, springs: Array) -> tuple[Worst, list[Screened]]:
        """Screen all scenarios; return the worst, and the worst of each piece, worst first."""
        count = len(self.scenarios)
        step = self.timing.step
        jobs = [
            self.pool.submit(
                screen,
                self.program,
                self.scenarios,
                postures,
                springs,
                step,
                begin,
                min(begin + PIECE, count),
            )
            for begin in range(0, count, PIECE)
        ]
        found: list[Screened] = []
        for i, job in enumerate(as_completed(jobs)):
            found += job.result()
            self.say("screening", i + 1, len(jobs))
        found.sort(key=lambda screened: -screened.share)
        first, deflection = found[0], float(self.deflections(postures, springs).max())
        return Worst(first.index, first.force, first.share, deflection), found

    def deflections(self, postures: Array, springs: Array) -> Array:
        """Return the largest deflection in each pose, P [m]."""
        return np.array([largest_deflection(self.study, q, springs) for q in postures])


def robust_design(
    study: Study,
    scenarios: Scenarios,
    executor: Executor | None = None,
    on_progress: Progress | None = None,
    *,
    free: bool = False,
) -> RobustDesign:
    """Find the springs of least worst force over its limit among all scenarios.

    Args:
        study: the robot, bounds on springs and deflection, and which joints share a spring.
        scenarios: to bear.
        executor: where screenings and searches run; default a process for each core.
        on_progress: called with what is being done, how much of it is, and how much there is.
        free: whether each pose may move along its self-motion, one posture for all that hits it.

    Raises:
        InvalidValue: as ``scenario_timing``.
        Infeasible: no springs keep the bounds in every pose.
        SolverFailure: no search was solved.
    """
    timing = scenario_timing(study, scenarios)
    impacts = tuple(
        impact_program(study.model, timing.nodes, timing.substeps, point, compiled=True)
        for point in scenarios.points
    )
    bounds = Bounds(*study.robot.limits, study.lower, study.upper)
    with workers(max(2, len(scenarios) // PIECE), executor) as pool:
        setting = _Setting(
            study,
            scenarios,
            study_program(study, impacts),
            timing,
            bounds,
            pool,
            on_progress or (lambda *_: None),
        )
        return _exchanged(setting, free)


def _exchanged(setting: _Setting, free: bool) -> RobustDesign:
    study, given = setting.study, setting.given
    softest = _require_reachable(setting, free)
    before, found = setting.worst(given, study.nominal)
    equal = _equal_springs(setting, given)
    equal_worst, more = setting.worst(given, equal)
    active = _fresh(setting, [*more[:1], *found], set())
    poses = [int(np.argmax(setting.deflections(given, study.nominal)))]
    postures, best, rounds = given, None, 0
    for rounds in range(1, ROUNDS + 1):
        places = [setting.scenarios[i] for i in active]
        poses = list(dict.fromkeys([*poses, *(place.pose for place in places)]))
        instance = _instance(setting, active, poses, equal_worst.share)
        springs = [best.springs] if best else [equal, study.upper, study.lower, softest]
        best = _searched(setting, instance, postures[poses], springs, free)
        postures = given.copy()
        postures[poses] = best.postures if free else given[poses]
        worst, found = setting.worst(postures, best.springs)
        setting.say("exchange", rounds, ROUNDS)
        bends = setting.deflections(postures, best.springs)
        too_far = int(np.argmax(bends))
        bound = best.worst * equal_worst.share
        fresh = _fresh(setting, [s for s in found if s.share > bound * (1 + CLOSED)], set(active))
        if bends[too_far] > study.max_deflection * (1 + KEEPS) and too_far not in poses:
            poses = [*poses, too_far]
        elif not fresh:
            break
        active = [*active, *fresh]
    assert best is not None
    springs_found = best.springs
    return RobustDesign(
        study=study,
        scenarios=setting.scenarios,
        springs=springs_found,
        postures=postures,
        worst=worst,
        before=before,
        equal=(equal_worst, equal),
        bound=bound,
        active=tuple(active),
        rounds=rounds,
        indifferent=_indifferent(setting, active, postures, springs_found),
        prices=prices_of(setting.study, instance, best, worst.force / best.worst, setting.program),
        timing=setting.timing,
        compiled=setting.program.library,
    )


def _fresh(setting: _Setting, screened: Sequence[Screened], known: set[int]) -> list[int]:
    """Return the worst few that are not known, each of another pose, point or direction."""
    kinds: set[tuple[int, ...]] = set()
    fresh: list[int] = []
    for each in screened:
        kind = setting.scenarios[each.index][:3]
        if each.index not in known and kind not in kinds and len(fresh) < ADDED:
            kinds.add(kind)
            fresh.append(each.index)
    return fresh


def _instance(setting: _Setting, active: list[int], poses: list[int], unit: float) -> Instance:
    study, scenarios = setting.study, setting.scenarios
    places = [scenarios[i] for i in active]
    tasks = [task_numbers(study, *tip_pose(study.model, scenarios.poses[k].q)) for k in poses]
    shape = Shape(
        study.groups, len(poses), tuple((poses.index(each.pose), each.point) for each in places)
    )
    return Instance(
        shape,
        np.array(tasks),
        np.array([scenarios.numbers(each, setting.timing.step) for each in places]),
        unit * np.array([scenarios.limit(each) for each in places]),
    )


def _searched(
    setting: _Setting, instance: Instance, postures: Array, springs: Sequence[Array], free: bool
) -> Found:
    """Return the best of the searches from some springs."""
    jobs = [
        setting.pool.submit(search, setting.program, instance, setting.bounds, postures, each, free)
        for each in springs
    ]
    found = [job.result() for job in as_completed(jobs)]
    good = [each for each in found if each.violation <= FEASIBLE]
    if not good:
        nearest = min(found, key=lambda each: each.violation)
        raise SolverFailure([_as_outcome(nearest, setting)])
    return min(good, key=lambda each: each.worst)


def search(
    program: Program,
    instance: Instance,
    bounds: Bounds,
    postures: Array,
    springs: Array,
    free: bool,
) -> Found:
    """Run ``minimise`` in a worker process."""
    with IN_TURN:
        return minimise(program, instance, bounds, postures, springs, free=free)


def _as_outcome(found: Found, setting: _Setting) -> Outcome:
    name = setting.scenarios.poses[0].pose.name
    status, force = found.status, float(found.worst)
    q, k = found.postures[0], found.springs
    return Outcome(
        name, "table", status, False, found.iterations, 1, 0.0, q, k, force, found.violation
    )


def _equal_springs(setting: _Setting, postures: Array) -> Array:
    """Return springs in the nominal proportions that are just accurate in every pose."""
    study = setting.study
    softest = [accurate_springs(study, q, study.nominal) for q in postures]
    return np.asarray(np.max(softest, axis=0))


def _require_reachable(setting: _Setting, free: bool) -> Array:
    """Return the springs of least deflection in the worst pose; raise Infeasible beyond reach."""
    study, given = setting.study, setting.given
    ends = setting.deflections(given, study.upper)
    k = int(np.argmax(ends))
    end = stiffest(study, given[k], "free" if free else "table")
    if end.deflection > study.max_deflection * (1 + KEEPS):
        raise Infeasible.of(study, end, setting.scenarios.poses[k].pose.name, free=free)
    return end.springs


def _indifferent(
    setting: _Setting, active: Sequence[int], postures: Array, springs: Array
) -> Array:
    scenarios, study = setting.scenarios, setting.study
    places = np.array([scenarios[i] for i in active])
    numbers = np.array([scenarios.numbers(scenarios[i], setting.timing.step) for i in active])
    limits = np.array([scenarios.limit(scenarios[i]) for i in active])

    def share(springs: Array) -> float:
        x = np.column_stack([postures[places[:, 0]], np.tile(np.log10(springs), (len(places), 1))])
        force = np.empty(len(places))
        for point in np.unique(places[:, 1]):
            at = np.flatnonzero(places[:, 1] == point)
            force[at] = largest_forces(setting.program, int(point), x[at], numbers[at])
        return float((force / limits).max())

    def keeps(springs: Array) -> bool:
        worst = setting.deflections(postures, springs).max()
        return bool(worst <= study.max_deflection * (1 + KEEPS))

    return indifferent_ranges(study, springs, share, keeps)
