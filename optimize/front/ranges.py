# SPDX-License-Identifier: BSD-3-Clause
"""At which values a front's objectives are held: from the best that can be reached on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from softimpact.symbolic import InvalidValue
from softimpact.symbolic.robot.rigid import Array

from ..evaluation import figures
from ..robust.exchange import ExchangeState
from ..search.failure import SolverFailure
from ..search.reach import reach
from .axes import BoundAxis, ObjectiveAxis
from .levels import LEAST_ROOM, SAME_FORCE_SHARE
from .trade import Trade

NO_CHOICE = 1.02
"""Times the best value up to which there is one level alone, and nothing to trade."""

SAME = 1.05
"""Times a study's own limit up to which another level is not kept beside it."""

LEAST_LEVEL = 1e-6
"""Share of the loosest value of an objective whose least is zero, in place of that: it is a
thousandth of what the machine as it is has."""

FEW = 5
"""Levels of each of two objectives that are held, unless a study says how many."""


@dataclass(frozen=True, eq=False)
class Levels:
    """Values at which objectives are held, the tightest first, and designs that are known.

    Attributes:
        values: of each objective that is held; the last of a bound is its loosest.
        ends: designs at the ends of each objective, to begin with.
        known: designs at levels, by their places.
    """

    values: tuple[Array, ...]
    ends: tuple[ExchangeState, ...]
    known: dict[tuple[int, ...], ExchangeState]


Place = tuple[float, ...]
"""Values at which all objectives are held."""


def levels_of(trade: Trade) -> Levels:
    """Return the levels of all objectives that are held.

    Those of a bound are from what hardware can reach to where the others are best, evenly along
    the front where the others are loose; with a study's own limit between. Those of an objective
    are even over its span.

    Raises:
        InvalidValue: the study asks for levels where there is nothing to find.
        SolverFailure: the ends were not solved.
    """
    asked, held = trade.setting.study.levels, trade.axes.held
    count = asked.points if len(held) == 1 or "points" in asked.model_fields_set else FEW
    tight = [_tightest(trade, i) for i in range(len(held))]
    found = {trade.loosest: trade.first(trade.loosest)}
    for i in range(len(held)):
        at = _moved(trade, i, tight[i])
        if at not in found:
            found[at] = trade.near(at, [found[trade.loosest]])
    ends = tuple(found.values())
    levels = tuple(_between(trade, i, tight[i], found, count) for i in range(len(held)))
    known = {}
    for values, state in found.items():
        places = [np.flatnonzero(each == v) for each, v in zip(levels, values, strict=True)]
        if all(place.size for place in places):
            known[tuple(int(place[0]) for place in places)] = state
    return Levels(levels, ends, known)


def _moved(trade: Trade, i: int, value: float) -> Place:
    """Return the loosest values with one of them changed."""
    return (*trade.loosest[:i], value, *trade.loosest[i + 1 :])


def _tightest(trade: Trade, i: int) -> float:
    """Return the tightest level of an objective: a little beyond the best that can be reached."""
    axis, study = trade.axes.held[i], trade.setting.study
    ends = study.levels.ends.get(axis.kind)
    if isinstance(axis, ObjectiveAxis):
        span = ends or axis.objective.span
        assert span is not None
        return max(span) if axis.more_is_better else min(span)
    best = best_figure(trade, i)
    wanted = None if ends is None else (max(ends) if axis.more_is_better else min(ends))
    if wanted is None and axis.more_is_better:
        return best / LEAST_ROOM
    if wanted is None:  # levels are even in their logarithms, and zero has none
        return max(best * LEAST_ROOM, LEAST_LEVEL * trade.loosest[i])
    if (wanted > best) if axis.more_is_better else (wanted < best):
        side, change = ("largest", "lower") if axis.more_is_better else ("least", "raise")
        raise InvalidValue(
            f"{study.source}: pareto.ends.{axis.kind}",
            f"{best:.4g} {axis.unit} is the {side} that can be reached; {change} {wanted:.4g}",
        )
    return wanted


def best_figure(trade: Trade, i: int) -> float:
    """Return the best figure of a bound that hardware reaches, all other objectives loose."""
    axis = trade.axes.held[i]
    assert isinstance(axis, BoundAxis)
    now = next(kept.figure for kept in trade.before.bounds if kept.name == axis.bound.name)
    values = list(trade.loosest)
    values[i] = now
    study, limits = trade.at(values).study, trade.setting.limits
    (own,) = (bound for bound in study.bounds if bound.kind == axis.kind)
    found = reach(study, list(trade.postures[0]), study.bounds, [own], free=trade.free)
    parted = limits.parted(found.v)
    each = np.concatenate([figures(own, study, q, *parted) for q in found.postures])
    return float(each.min() if axis.more_is_better else each.max())


def _between(
    trade: Trade, i: int, tight: float, found: dict[Place, ExchangeState], count: int
) -> Array:
    """Return an objective's levels, the tightest first; what is found on the way is added."""
    axis, study = trade.axes.held[i], trade.setting.study
    asked = study.levels.ends.get(axis.kind)
    if isinstance(axis, ObjectiveAxis):
        span = asked or axis.objective.span
        assert span is not None
        loose = min(span) if axis.more_is_better else max(span)
        return np.geomspace(tight, loose, count if loose != tight else 1)
    reached = [axis.value(state.worst, 0.0) for state in found.values()]
    loose = min(reached) if axis.more_is_better else max(reached)
    if asked is not None:
        loose = min(asked) if axis.more_is_better else max(asked)
    ratio = tight / loose if axis.more_is_better else loose / tight
    if ratio < NO_CHOICE:
        return np.array([tight])
    if asked is not None:
        levels = np.geomspace(tight, loose, count)
    else:
        levels = _evenly(trade, i, tight, loose, found, count)
    if axis.own is not None and min(tight, loose) < axis.own < max(tight, loose):
        near = abs(np.log(levels / axis.own)) < np.log(SAME)
        near[[0, -1]] = False
        levels = np.append(levels[~near], axis.own)
    levels = np.unique(levels)
    return np.asarray(levels[::-1] if axis.more_is_better else levels)


def _evenly(
    trade: Trade, i: int, tight: float, loose: float, found: dict[Place, ExchangeState], count: int
) -> Array:
    """Halve the longest piece of the front between the ends again and again.

    Length along it counts the logarithm of the level and what is sought, each from 0 to 1.
    """
    levels, held = [tight, loose], [tight, trade.loosest[i]]
    costs = [trade.cost(found[_moved(trade, i, value)]) for value in held]
    height = max(abs(costs[0] - costs[1]), SAME_FORCE_SHARE * abs(costs[0]))
    width = abs(np.log(tight / loose))
    while len(levels) < count:
        pieces = np.hypot(np.diff(np.log(levels)) / width, np.diff(costs) / height)
        k = int(np.argmax(pieces))
        middle = float(np.sqrt(levels[k] * levels[k + 1]))
        at = _moved(trade, i, middle)
        neighbours = [found[_moved(trade, i, held[j])] for j in (k, k + 1)]
        try:
            found[at] = trade.near(at, neighbours)
        except SolverFailure:  # the grid tries again
            break
        levels.insert(k + 1, middle)
        held.insert(k + 1, middle)
        costs.insert(k + 1, trade.cost(found[at]))
    return np.array(held)
