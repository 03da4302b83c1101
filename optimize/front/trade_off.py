# SPDX-License-Identifier: BSD-3-Clause
"""Pareto fronts over two or three objectives of one machine for all scenarios.

By the ε-constraint method: one objective is made best while the others are held at each of a grid
of levels, from the loosest to the tightest, each search from what its looser neighbours found.
"""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from softimpact.symbolic import InvalidValue
from softimpact.symbolic.record import Record, Row
from softimpact.symbolic.robot.rigid import Array

from ..answers import Price, prices_of, worth_of
from ..bounds import Deflection
from ..evaluation import equipped
from ..impact.timing import Timing, scenario_timing
from ..robust.catalogue import Bought
from ..robust.certificate import Hardening, Worst
from ..robust.robust import indifferent, require_lengths, require_thick_cover
from ..robust.setting import setting_of
from ..running.workers import Progress, cores, workers, works_elsewhere
from ..search.reach import require_reachable
from ..study.poses import candidates, leaves_a_choice
from ..study.scenarios import Scenarios
from ..study.study import Study
from ..study.study_file import ScenariosSection
from ..study.study_scenarios import scenarios_of
from .axes import Axes, BoundAxis, ObjectiveAxis, asked_axes
from .dominance import WORTH, knee, undominated
from .grid import Grid, GridNode, fill, values_at
from .of_catalogue import bought_designs, within_catalogue
from .ranges import Levels, levels_of
from .trade import Trade

STARTS = 6
"""Poses of a study, at most, from which a free posture is first sought."""


@dataclass(frozen=True, eq=False)
class TradePoint(Record):
    """A design on a front, and what its numbers mean.

    Attributes:
        study: with the objectives held where they were.
        scenarios: likewise.
        values: of the objectives, in their units, as they were asked for.
        springs: joint stiffness, length n [N·m/rad].
        others: values of the other variables of the hardware.
        postures: of each pose, P×n [rad].
        worst: scenario with this hardware, over all scenarios by evaluation.
        bound: share of the limit that the NLP says is the least, over the scenarios that decide.
        status: Ipopt's.
        indifferent: range of each value of the hardware that costs less than 0.5 %, the others
            held.
        prices: what each binding bound costs.
        bought: the springs of the catalogue, and what they cost; None without one. ``bound`` and
            ``prices`` are then those of springs of any stiffness.
    """

    UNSHOWN = ("study", "scenarios")

    study: Study
    scenarios: Scenarios
    values: tuple[float, ...]
    springs: Array
    others: Array
    postures: Array
    worst: Worst
    bound: float
    status: str
    indifferent: Array
    prices: tuple[Price, ...]
    bought: Bought | None = None


@dataclass(frozen=True, eq=False)
class TradeOff(Record):
    """The designs of a study that no other beats in all of two or three objectives.

    Attributes:
        study: what was asked, its objective the one that was sought.
        scenarios: all of them.
        axes: the objectives.
        levels: at which each one that was held was, by its kind; one alone is no choice.
        points: designs, those best in the first objective first.
        knee: number of the point where the front bends, None where it does not.
        before: the machine as it is, over all scenarios.
        before_values: of the objectives.
        searched: levels that were solved.
        out_of_reach: levels that no hardware keeps.
        not_sold: levels that were solved, but that no springs of the catalogue keep.
        unsolved: statuses of Ipopt at levels within reach where it failed.
        timing: of the impacts.
        compiled: whether they ran as machine code.
    """

    UNSHOWN = ("study", "scenarios", "timing", "axes")

    study: Study
    scenarios: Scenarios
    axes: Axes
    levels: dict[str, Array]
    points: tuple[TradePoint, ...]
    knee: int | None
    before: Worst
    before_values: tuple[float, ...]
    searched: int
    out_of_reach: int
    not_sold: int
    unsolved: tuple[str, ...]
    timing: Timing
    compiled: bool

    def rows(self) -> list[Row]:
        """Return a line for each point: its objectives and its hardware."""
        names = [axis.kind for axis in self.axes.all]
        joints = self.study.spring_names
        others = self.study.range.names[max(self.study.groups) + 1 :]
        return [
            {
                **dict(zip(names, point.values, strict=True)),
                "knee": i == self.knee,
                **{f"k_{name}": float(k) for name, k in zip(joints, point.springs, strict=True)},
                **dict(zip(others, point.others.tolist(), strict=True)),
            }
            for i, point in enumerate(self.points)
        ]


def asks_for_trade_off(study: Study) -> bool:
    """Return whether a study's front is one of a machine for scenarios, and not of postures."""
    more = study.scenarios is not None or study.other_variables or study.catalogue
    return bool(more or study.levels.objectives)


def trade_off_front(
    study: Study,
    executor: Executor | None = None,
    on_progress: Progress | None = None,
) -> TradeOff:
    """Find the designs that no other beats in all objectives.

    Args:
        study: the problem; its ``levels`` say which objectives, default its own and accuracy.
        executor: where screenings and searches run; default a process for each core.
        on_progress: called with what is being done, how much of it is, and how much there is.

    Raises:
        InvalidValue: the objectives make no front, or levels lie where there is nothing to find.
        Infeasible: no hardware keeps the other bounds.
        SolverFailure: no search was solved.
        Unavailable: no springs of the catalogue keep any level.
    """
    axes = asked_axes(study, study.levels.objectives or [study.objective.kind, Deflection.kind])
    _require_known_ends(study, axes)
    study = within_catalogue(axes.study(study))
    scenarios, free = _scenarios(study)
    require_lengths(study, scenarios)
    with workers(cores(), executor) as pool:
        trade = _prepared(study, scenarios, axes, pool, on_progress, free=free)
        levels = levels_of(trade)
        return _result(trade, levels, fill(trade, levels))


def _require_known_ends(study: Study, axes: Axes) -> None:
    held = {axis.kind for axis in axes.held}
    for end in ("lower", "upper"):
        if getattr(study.levels, end) is not None:
            raise InvalidValue(
                f"{study.source}: pareto.{end}",
                "is for fronts of postures; a front over objectives takes its levels from "
                "pareto.ends, such as ends = { deflection = [0.0005, 0.002] }",
            )
    for kind in study.levels.ends:
        if kind not in held:
            raise InvalidValue(
                f"{study.source}: pareto.ends.{kind}",
                f"is not held at levels; those that are: {', '.join(sorted(held))}",
            )


def _scenarios(study: Study) -> tuple[Scenarios, bool]:
    """Return the scenarios, and whether postures are free.

    Without a table of them: the study's own impact in the task's pose, the posture free.
    """
    asked = study.scenarios
    if asked is None:
        asked = ScenariosSection(poses=[study.task_pose.name])
        return scenarios_of(replace(study, scenarios=asked)), leaves_a_choice(study)
    return scenarios_of(study), isinstance(asked, ScenariosSection) and asked.posture == "free"


def _prepared(
    study: Study,
    scenarios: Scenarios,
    axes: Axes,
    pool: Executor,
    on_progress: Progress | None,
    *,
    free: bool,
) -> Trade:
    """Return what all searches share; raises Infeasible where the other bounds cannot be kept."""
    loosest = tuple(_loosest(axis, study, scenarios) for axis in axes.held)
    asked = study, scenarios
    for axis, value in zip(axes.held, loosest, strict=True):
        asked = axis.held(*asked, value)
    require_reachable(asked[0], scenarios.poses, free=free)
    elsewhere, timing = works_elsewhere(pool), _timing(study, scenarios, axes)
    setting = setting_of(study, scenarios, pool, on_progress, timing, elsewhere=elsewhere)
    before, _ = setting.worst(Hardening(setting.limits.vector(study.nominal), setting.given))
    given: tuple[Array, ...] = (setting.given,)
    if free and study.scenarios is None:  # any pose of the study may lead to the best posture
        given = tuple(pose.q[None, :] for pose in candidates(study)[:STARTS])
    return Trade(setting, axes, loosest, free, given, before, before.share)


def _loosest(axis: BoundAxis | ObjectiveAxis, study: Study, scenarios: Scenarios) -> float:
    found = axis.loosest(study, scenarios)
    if found is not None:
        return found
    assert isinstance(axis, ObjectiveAxis)
    span = study.levels.ends.get(axis.kind) or axis.objective.span
    assert span is not None
    return min(span) if axis.more_is_better else max(span)


def _timing(study: Study, scenarios: Scenarios, axes: Axes) -> Timing:
    """Return time steps that hold the impacts of all levels; slow ones last longest."""
    asked = [scenarios]
    for axis in axes.held:
        if isinstance(axis, ObjectiveAxis):
            span = study.levels.ends.get(axis.kind) or axis.objective.span or ()
            asked += [axis.objective.held(scenarios, value) for value in span]
    return max((scenario_timing(study, each) for each in asked), key=lambda timing: timing.steps)


def _result(trade: Trade, levels: Levels, grid: Grid) -> TradeOff:
    """Return the designs that no other beats, and what they mean."""
    searched = len(grid.found)
    choices: dict[GridNode, Bought] = {}
    if trade.setting.study.catalogue:
        grid, choices = bought_designs(trade, levels, grid)
    nodes = list(grid.found)
    values = np.array([trade.values(grid.found[n], values_at(levels, n)) for n in nodes])
    values = values[:, list(trade.axes.order)]
    more = np.array([axis.more_is_better for axis in trade.axes.all])
    costs = np.where(more, 1 / values, values)
    order = np.lexsort(costs.T[::-1])
    kept = [int(order[i]) for i in undominated(costs[order], WORTH)]
    points = tuple(
        _point(trade, levels, grid, nodes[i], values[i], choices.get(nodes[i])) for i in kept
    )
    logs = np.log(costs[kept])
    logs[:, trade.axes.order.index(0)] = costs[kept, trade.axes.order.index(0)]
    held = (1.0 if isinstance(axis, ObjectiveAxis) else 0.0 for axis in trade.axes.held)
    others = zip(trade.axes.held, held, strict=True)
    before = (trade.before.value, *(axis.value(trade.before, held) for axis, held in others))
    setting = trade.setting
    return TradeOff(
        study=setting.study,
        scenarios=setting.scenarios,
        axes=trade.axes,
        levels={a.kind: v for a, v in zip(trade.axes.held, levels.values, strict=True)},
        points=points,
        knee=knee(logs),
        before=trade.before,
        before_values=tuple(before[i] for i in trade.axes.order),
        searched=searched,
        not_sold=searched - len(nodes),
        out_of_reach=len(grid.beyond),
        unsolved=tuple(grid.unsolved.values()),
        timing=setting.timing,
        compiled=setting.program.library,
    )


def _point(
    trade: Trade,
    levels: Levels,
    grid: Grid,
    node: GridNode,
    values: Array,
    choice: Bought | None,
) -> TradePoint:
    setting, state = trade.at(values_at(levels, node)), grid.found[node]
    study = setting.study
    springs, others = setting.limits.parted(state.at.v)
    if choice is not None:  # their logarithms lose a digit
        springs = choice.springs
    require_thick_cover(setting, state.worst, equipped(study, ca.DM(springs), others))
    worth = worth_of(study, state.worst.force / state.worst.share * state.unit)
    return TradePoint(
        study=study,
        scenarios=setting.scenarios,
        values=tuple(values.tolist()),
        springs=springs,
        others=others,
        postures=state.at.postures,
        worst=state.worst,
        bound=state.bound,
        status=state.best.status,
        indifferent=indifferent(setting, state),
        prices=prices_of(study, state.instance, state.best, worth, setting.program),
        bought=choice,
    )
