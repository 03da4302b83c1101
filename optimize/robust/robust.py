# SPDX-License-Identifier: BSD-3-Clause
"""One machine for all scenarios, by exchange.

An NLP holds the few scenarios that matter. All others are screened with what it finds, the worst
of them are added, and so on until none is worse than the NLP says. The last screening is the
certificate: a bound on every scenario, by evaluation. Objectives in which every scenario counts
have all of them in the NLP from the start.
"""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from softimpact.symbolic import InvalidValue
from softimpact.symbolic.record import Record
from softimpact.symbolic.robot.rigid import Array

from ..answers import Price, indifferent_ranges, prices_of, worth_of
from ..evaluation import equipped, keeps_bounds
from ..impact.timing import Timing
from ..machine.hardware import Hardware
from ..running.workers import Progress, awake, cores, workers, works_elsewhere
from ..search.accurate_springs import accurate_springs
from ..search.minimax import serves
from ..search.reach import require_reachable
from ..study.scenarios import Scenarios
from ..study.study import Study
from ..variables.cover import Cover
from .catalogue import Bought, bought
from .certificate import Hardening, Setting, Worst
from .exchange import ExchangeState, exchange, worst_few
from .screening import SCENARIOS_IN_A_JOB
from .setting import setting_of

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
        shares: of its limit that the force of each of them is, as the NLP has it.
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
    shares: tuple[float, ...]
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
    processes = min(max(2, len(scenarios) // SCENARIOS_IN_A_JOB), cores())
    with workers(processes, executor) as pool:
        awake(pool, processes)
        elsewhere = works_elsewhere(executor)
        setting = setting_of(study, scenarios, pool, on_progress, elsewhere=elsewhere)
        return _exchanged(setting, free)


def require_lengths(study: Study, scenarios: Scenarios) -> None:
    """Raise InvalidValue if the objective does not fit the scenarios, before anything is built."""
    if study.objective.all_scenarios:
        numbers = np.arange(len(scenarios)) // len(scenarios.motors)
        own = study.objective.own(numbers, np.ones(numbers.size), np.ones(numbers.size)).start
        study.objective.value(own, numbers, np.ones(numbers.size))


def _exchanged(setting: Setting, free: bool) -> RobustDesign:
    study, given, limits = setting.study, setting.given, setting.limits
    nominal = Hardening(limits.vector(study.nominal), given)
    before, found = setting.worst(nominal)
    equal = accurate_springs(study, given, study.nominal)
    equal_worst, more = setting.worst(Hardening(limits.vector(equal), given))
    starts = [(equal, None)]
    if not serves(study.objective, free=free):
        starts += [(each, None) for each in (study.upper, study.lower)]
    first = worst_few(setting, [*more[:1], *found], set())
    state = exchange(setting, first, starts, given, equal_worst.share, free=free, thorough=True)
    choice = None
    if study.catalogue:
        choice, state = with_catalogue(setting, state)
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
        shares=tuple((state.best.shares * state.unit).tolist()),
        rounds=state.rounds,
        indifferent=indifferent(setting, state),
        prices=prices_of(study, state.instance, state.best, worth, setting.program),
        timing=setting.timing,
        compiled=setting.program.library,
        bought=choice,
    )


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
        return keeps_bounds(study, state.at.postures, *setting.limits.parted(v))

    return indifferent_ranges(setting.limits, state.at.v, cost, keeps)


def with_catalogue(setting: Setting, state: ExchangeState) -> tuple[Bought, ExchangeState]:
    """Take springs of the catalogue instead, and return these; the postures stay.

    Raises:
        Unavailable: no combination was found that keeps all bounds.
    """
    choice = bought(setting, _decisive(setting, state), state.at, state.worst)
    return choice, replace(state, at=choice.at, worst=choice.worst)
