# SPDX-License-Identifier: BSD-3-Clause
"""One machine for all scenarios, by exchange.

An NLP holds the few scenarios that matter. All others are screened with what it finds, the worst
of them are added, and so on until none is worse than the NLP says. The last screening is the
certificate: a bound on every scenario, by evaluation. Objectives in which every scenario counts
have all of them in the NLP from the start.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from softimpact.symbolic import InvalidValue
from softimpact.symbolic.record import Record
from softimpact.symbolic.robot.rigid import Array

from .answers import Price, indifferent_ranges, prices_of, worth_of
from .catalogue import Bought, bought
from .certificate import KEEPS, Hardening, Setting, Worst
from .evaluation import equipped, largest_share
from .failure import SolverFailure
from .hardware import Hardware
from .ipopt import FEASIBLE, IN_TURN, Found, Instance, VariableBounds, minimise
from .nlp import NlpShape, Program, task_numbers
from .reach import require_reachable
from .repair import accurate_springs
from .scenarios import Scenarios
from .screening import SCENARIOS_IN_A_JOB, Screened
from .setting import setting_of
from .solve import Outcome
from .study import Study
from .timing import Timing
from .tip_pose import tip_pose
from .variables.cover import Cover
from .workers import Progress, as_completed, cores, workers, works_elsewhere

ROUNDS = 40
"""Most exchanges."""

ADDED_IN_AN_EXCHANGE = 4
"""Scenarios added in an exchange: the worst, each of another pose, point or direction."""

MOST_EXCESS = 1e-4
"""Share by which a scenario may exceed what the NLP says: forces are no better known."""

MOST_AT_ONCE = 300
"""Impacts that an NLP may hold where every scenario counts: it takes minutes then."""


@dataclass(frozen=True, eq=False)
class RobustDesign(Record):
    """One machine for all scenarios, and what the answer means.

    Attributes:
        study: what was asked.
        scenarios: all of them.
        springs: joint stiffness, length n [N·m/rad].
        others: values of the other variables of the hardware.
        postures: of each pose, P×n [rad].
        worst: scenario with this hardware, over all scenarios by evaluation.
        before: the same of the machine as it is.
        equal: the same with springs in the proportions of the nominal ones, as soft or stiff as
            the deflection allows; with these springs.
        bound: share of the limit that the NLP says is the least, over its own scenarios.
        active: scenarios that the NLP held in the end.
        rounds: exchanges.
        indifferent: range of each value of the hardware that costs less than 0.5 % over the active
            scenarios, the others held.
        prices: what each binding bound costs.
        timing: of the impacts.
        compiled: whether they ran as machine code.
        bought: the springs of the catalogue, and what they cost; None without one. ``springs`` are
            then these, and ``bound`` is that of springs of any stiffness.
    """

    UNSHOWN = ("study", "scenarios", "timing")

    study: Study
    scenarios: Scenarios
    springs: Array
    others: Array
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
    bought: Bought | None = None


def robust_design(
    study: Study,
    scenarios: Scenarios,
    executor: Executor | None = None,
    on_progress: Progress | None = None,
    *,
    free: bool = False,
) -> RobustDesign:
    """Find the machine that is best for all scenarios: by default the least worst force.

    Args:
        study: the robot, its variables, bounds and objective.
        scenarios: to bear.
        executor: where screenings and searches run; default a process for each core.
        on_progress: called with what is being done, how much of it is, and how much there is.
        free: whether each pose may move along its self-motion, one posture for all that hits it.

    Raises:
        InvalidValue: as ``scenario_timing``; or more scenarios than the objective can look at.
        Infeasible: no hardware keeps the bounds in every pose.
        SolverFailure: no search was solved.
    """
    if study.objective.all_scenarios and len(scenarios) > MOST_AT_ONCE:
        raise InvalidValue(
            f"{study.source}: objective.kind",
            f"'{study.objective.kind}' looks at every impact at once, and {len(scenarios)} are "
            f"more than {MOST_AT_ONCE}; choose 'worst_force' or fewer scenarios",
        )
    require_lengths(study, scenarios)
    require_reachable(study, scenarios.poses, free=free)
    with workers(min(max(2, len(scenarios) // SCENARIOS_IN_A_JOB), cores()), executor) as pool:
        elsewhere = works_elsewhere(executor)
        setting = setting_of(study, scenarios, pool, on_progress, elsewhere=elsewhere)
        return _exchanged(setting, free)


def require_lengths(study: Study, scenarios: Scenarios) -> None:
    """Raise InvalidValue if the objective does not fit the scenarios, before anything is built."""
    if study.objective.all_scenarios:
        numbers = np.arange(len(scenarios)) // len(scenarios.motors)
        own = study.objective.own(numbers, np.ones(numbers.size), np.ones(numbers.size)).start
        study.objective.value(own, numbers, np.ones(numbers.size))


@dataclass(frozen=True, eq=False)
class ExchangeState:
    """Where an exchange stands."""

    best: Found
    instance: Instance
    at: Hardening
    worst: Worst
    active: tuple[int, ...]
    rounds: int
    unit: float

    @property
    def bound(self) -> float:
        """Share of the limit that the NLP says is the least."""
        return self.best.worst * self.unit


def _exchanged(setting: Setting, free: bool) -> RobustDesign:
    study, given, limits = setting.study, setting.given, setting.limits
    nominal = Hardening(limits.vector(study.nominal), given)
    before, found = setting.worst(nominal)
    equal = equal_springs(setting, given)
    equal_worst, more = setting.worst(Hardening(limits.vector(equal), given))
    starts = [(each, None) for each in (equal, study.upper, study.lower)]
    first = worst_few(setting, [*more[:1], *found], set())
    state = exchange(setting, first, starts, given, equal_worst.share, free=free)
    choice = None
    if study.catalogue:
        choice, state = _bought(setting, state)
    springs, others = limits.parted(state.at.v)
    if choice is not None:  # their logarithms lose a digit
        springs = choice.springs
    require_thick_cover(setting, state.worst, equipped(study, ca.DM(springs), others))
    worth = worth_of(study, state.worst.force / state.worst.share * state.unit)
    return RobustDesign(
        study=study,
        scenarios=setting.scenarios,
        springs=springs,
        others=others,
        postures=state.at.postures,
        worst=state.worst,
        before=before,
        equal=(equal_worst, equal),
        bound=state.bound,
        active=state.active,
        rounds=state.rounds,
        indifferent=indifferent(setting, state),
        prices=prices_of(study, state.instance, state.best, worth, setting.program),
        timing=setting.timing,
        compiled=setting.program.library,
        bought=choice,
    )


def exchange(
    setting: Setting,
    first: Sequence[int],
    starts: Sequence[tuple[Array, Array | None]],
    postures: Array,
    unit: float,
    *,
    free: bool,
) -> ExchangeState:
    """Add the worst scenarios to an NLP until it holds all that decide.

    Args:
        setting: the problem.
        first: scenarios to begin with.
        starts: springs and other values from which the first NLP is solved.
        postures: of each pose, P×n [rad].
        unit: share of a limit that counts as one.
        free: whether the postures are sought as well.
    """
    study, given, limits = setting.study, setting.given, setting.limits
    if study.objective.scales_speed:
        unit = 1.0  # the limits themselves
    everything = study.objective.all_scenarios
    active = list(range(len(setting.scenarios))) if everything else list(first)
    bends = setting.shares_of_bounds(Hardening(limits.vector(study.nominal), given))
    poses = [int(np.argmax(bends))]
    best: Found | None = None
    for rounds in range(1, ROUNDS + 1):
        places = [setting.scenarios[i] for i in active]
        poses = list(dict.fromkeys([*poses, *(place.pose for place in places)]))
        instance = _instance(setting, active, poses, unit)
        if best:
            starts = [(best.springs, best.others)]
        best = _searched(setting, instance, postures[poses], starts, free)
        postures = given.copy()
        postures[poses] = best.postures if free else given[poses]
        factors = _factors(setting, best)
        at = Hardening(limits.vector(best.springs, best.others), postures, factors)
        worst, found = setting.worst(at)
        setting.say("exchange", rounds, ROUNDS)
        state = ExchangeState(best, instance, at, worst, tuple(active), rounds, unit)
        shares = setting.shares_of_bounds(at)
        too_far = int(np.argmax(shares))
        allowed = max(state.bound, 1.0) if factors is not None else state.bound
        worse = [s for s in found if s.share > allowed * (1 + MOST_EXCESS)]
        fresh = [] if everything else worst_few(setting, worse, set(active))
        if shares[too_far] > 1 + KEEPS and too_far not in poses:
            poses = [*poses, too_far]
        elif not fresh:
            break
        active = [*active, *fresh]
    return state


def _factors(setting: Setting, best: Found) -> Array | None:
    """Return the factors on the speed that a search ended with."""
    if not setting.study.objective.scales_speed:
        return None
    return np.asarray(10**best.own)


def worst_few(setting: Setting, screened: Sequence[Screened], known: set[int]) -> list[int]:
    """Return the worst few that are not known, each of another pose, point or direction."""
    kinds: set[tuple[int, ...]] = set()
    fresh: list[int] = []
    for each in screened:
        kind = setting.scenarios[each.index][:3]
        if each.index not in known and kind not in kinds and len(fresh) < ADDED_IN_AN_EXCHANGE:
            kinds.add(kind)
            fresh.append(each.index)
    return fresh


def _instance(setting: Setting, active: list[int], poses: list[int], unit: float) -> Instance:
    study, scenarios = setting.study, setting.scenarios
    places = [scenarios[i] for i in active]
    tasks = [task_numbers(study, *tip_pose(study.model, scenarios.poses[k].q)) for k in poses]
    own = [i // len(scenarios.motors) for i in active]
    numbered = {which: k for k, which in enumerate(dict.fromkeys(own))}
    shape = NlpShape(
        len(poses),
        tuple((poses.index(each.pose), each.point) for each in places),
        tuple(numbered[which] for which in own),
        study.objective,
    )
    return Instance(
        shape,
        np.array(tasks),
        np.array([scenarios.numbers(each, setting.timing.step) for each in places]),
        unit * np.array([scenarios.limit(each) for each in places]),
    )


def _searched(
    setting: Setting,
    instance: Instance,
    postures: Array,
    starts: Sequence[tuple[Array, Array | None]],
    free: bool,
) -> Found:
    """Return the best of the searches from some springs and other values."""
    shared = setting.program, instance, setting.limits, postures
    jobs = [setting.pool.submit(search, *shared, *start, free) for start in starts]
    found = [job.result() for job in as_completed(jobs)]
    good = [each for each in found if each.violation <= FEASIBLE]
    if not good:
        nearest = min(found, key=lambda each: each.violation)
        raise SolverFailure([_as_outcome(nearest, instance, setting)], setting.study)
    return min(good, key=lambda each: each.cost)


def search(
    program: Program,
    instance: Instance,
    limits: VariableBounds,
    postures: Array,
    springs: Array,
    others: Array | None,
    free: bool,
) -> Found:
    """Run ``minimise`` in a worker process."""
    with IN_TURN:
        return minimise(program, instance, limits, postures, springs, others, free=free)


def _as_outcome(found: Found, instance: Instance, setting: Setting) -> Outcome:
    name = setting.scenarios.poses[0].pose.name
    status, force = found.status, float((found.shares * instance.units).max())
    q, k = found.postures[0], found.springs
    return Outcome(
        name, "table", status, False, found.iterations, 1, 0.0, q, k, force, found.violation
    )


def equal_springs(setting: Setting, postures: Array) -> Array:
    """Return springs in the nominal proportions that are just accurate in every pose."""
    study = setting.study
    softest = [accurate_springs(study, q, study.nominal) for q in postures]
    return np.asarray(np.max(softest, axis=0))


def require_thick_cover(setting: Setting, worst: Worst, hardware: Hardware) -> None:
    """Refuse a cover that some impact presses through: its law does not hold then."""
    thickness = [v.thickness for v in setting.study.other_variables if isinstance(v, Cover)]
    if not thickness or thickness[0] is None or hardware.cover is None:
        return
    # a scenario of a lower share may have the larger force
    most = worst.share * float(setting.scenarios.limits.max())
    depth = (most / float(hardware.cover)) ** (2 / 3)
    if depth > thickness[0]:
        raise InvalidValue(
            f"{setting.study.source}: hardware.cover.lower",
            f"{most:.0f} N press the cover by {1e3 * depth:.3g} mm, more than its "
            f"{1e3 * thickness[0]:g} mm; raise it to {most / thickness[0] ** 1.5:.3g} N/m^1.5",
        )


def _decisive(setting: Setting, state: ExchangeState) -> Setting:
    """Return the setting with the scenarios alone that decided."""
    places = np.array([setting.scenarios[i] for i in state.active])
    rows = np.unique(places[:, :6], axis=0)
    return replace(setting, scenarios=replace(setting.scenarios, rows=rows))


def indifferent(setting: Setting, state: ExchangeState) -> Array:
    """Return the range of each value that costs less than 0.5 %, the others held."""
    study = setting.study
    decisive = setting if study.objective.all_scenarios else _decisive(setting, state)

    def cost(v: Array) -> float:
        value = decisive.value(Hardening(v, state.at.postures))[0]
        return 1 / value if study.objective.more_is_better else value

    def keeps(v: Array) -> bool:
        parted = setting.limits.parted(v)
        return all(largest_share(study, q, *parted) <= 1 + KEEPS for q in state.at.postures)

    return indifferent_ranges(setting.limits, state.at.v, cost, keeps)


def _bought(setting: Setting, state: ExchangeState) -> tuple[Bought, ExchangeState]:
    """Take springs of the catalogue instead; the postures stay."""
    choice = bought(setting, _decisive(setting, state), state.at, state.worst)
    return choice, replace(state, at=choice.at, worst=choice.worst)
