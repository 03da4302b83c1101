# SPDX-License-Identifier: BSD-3-Clause
"""At which values a front's objectives are held: from the best that can be reached on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from softimpact.symbolic import InvalidValue
from softimpact.symbolic.robot.rigid import Array

from .axes import BoundAxis, ObjectiveAxis
from .evaluation import figures
from .levels import ROOM
from .reach import reach
from .robust import State
from .trade import Trade

NO_CHOICE = 1.02
"""Times the best value up to which there is one level alone, and nothing to trade."""

FEW = 5
"""Levels of each of two objectives that are held, unless a study says how many."""


@dataclass(frozen=True, eq=False)
class Levels:
    """Values at which objectives are held, the tightest first, and what is known of their ends.

    Attributes:
        values: of each objective that is held; the last of a bound is its loosest.
        ends: designs at the ends of each objective, to begin with.
        known: those of them that were sought at levels, by their places.
    """

    values: tuple[Array, ...]
    ends: tuple[State, ...]
    known: dict[tuple[int, ...], State]


def levels_of(trade: Trade) -> Levels:
    """Return the levels of all objectives that are held.

    Those of a bound are from what hardware can reach to where the others are best; with a study's
    own limit between. Those of an objective are even over its span.

    Raises:
        InvalidValue: the study asks for levels where there is nothing to find.
        SolverFailure: the ends were not solved.
    """
    asked, held = trade.setting.study.levels, trade.axes.held
    count = asked.points if len(held) == 1 or "points" in asked.model_fields_set else FEW
    tight = [_tightest(trade, i) for i in range(len(held))]
    ideal = trade.first(trade.loosest)
    at, ends = [list(trade.loosest)], [ideal]
    for i in range(len(held)):
        at.append([*trade.loosest[:i], tight[i], *trade.loosest[i + 1 :]])
        ends.append(trade.near(at[-1], [ideal]))
    levels = [_between(trade, i, tight[i], ends, count) for i in range(len(held))]
    known = {}
    for values, state in zip(at, ends, strict=True):
        places = [np.flatnonzero(each == v) for each, v in zip(levels, values, strict=True)]
        if all(place.size for place in places):
            known[tuple(int(place[0]) for place in places)] = state
    return Levels(tuple(levels), tuple(ends), known)


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
    if wanted is None:
        return best / ROOM if axis.more_is_better else best * ROOM
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


def _between(trade: Trade, i: int, tight: float, ends: list[State], count: int) -> Array:
    """Return an objective's levels, the tightest first."""
    axis, study = trade.axes.held[i], trade.setting.study
    asked = study.levels.ends.get(axis.kind)
    if isinstance(axis, ObjectiveAxis):
        span = asked or axis.objective.span
        assert span is not None
        return np.geomspace(tight, min(span) if axis.more_is_better else max(span), count)
    reached = [axis.value(state.worst, 0.0) for state in ends]
    loose = min(reached) if axis.more_is_better else max(reached)
    if asked is not None:
        loose = min(asked) if axis.more_is_better else max(asked)
    ratio = tight / loose if axis.more_is_better else loose / tight
    if ratio < NO_CHOICE:
        return np.array([tight])
    levels = np.geomspace(tight, loose, count)
    if axis.own is not None and min(tight, loose) < axis.own < max(tight, loose):
        levels = np.unique(np.append(levels, axis.own))
        levels = levels[::-1] if axis.more_is_better else levels
    if asked is None:
        levels[-1] = trade.loosest[i]
    return np.asarray(levels)
