# SPDX-License-Identifier: BSD-3-Clause
"""What an optimum means: which numbers matter, and what each bound costs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from softimpact.symbolic.robot.rigid import Array

from .bounds import STEEPNESS, Bound
from .search.ipopt import Found, Instance, VariableBounds
from .search.nlp import Program
from .study.study import Study, limit_name
from .units import figure_in_words

NO_LOSS = 0.005
"""Share of the force that counts as no loss."""

HALVINGS = 7
"""Bisections of the logarithm of a range: its ends are then right to 5 % or better."""

LEAST_GAIN_NAMED = 3e-6
"""Share of the objective below which a bound is not named: a thousandth of a newton or so."""

PRICED_SHARE = 0.1
"""Share of a limit whose price is told."""


@dataclass(frozen=True)
class Price:
    """What a bound costs: how much a little more room buys, to first order.

    Attributes:
        bound: its name.
        newtons: force saved [N]; None where no force is made small.
        room: in words, such as "0.1 mm more".
        gain: of the objective.
        unit: of ``gain``.
    """

    bound: str
    newtons: float | None
    room: str
    gain: float
    unit: str


def indifferent_ranges(
    bounds: VariableBounds,
    v: Array,
    cost: Callable[[Array], float],
    keeps: Callable[[Array], bool],
) -> Array:
    """Return the range of each value that costs less than 0.5 %, length of v × 2.

    One value is changed at a time, the others held; the ranges do not hold together.

    Args:
        bounds: limits of v.
        v: the optimum, log10 of all values.
        cost: what is minimised, of v; greater than zero.
        keeps: whether all bounds are kept, of v.
    """
    least = cost(v) * (1 + NO_LOSS)
    ranges = np.empty((v.size, 2))

    def good(place: int, value: float) -> bool:
        changed = v.copy()
        changed[place] = value
        return keeps(changed) and cost(changed) <= least

    for i, own in enumerate(v):
        for side, ends in enumerate((bounds.lower, bounds.upper)):
            ranges[i, side] = 10 ** _farthest(partial(good, i), float(own), float(ends[i]))
    return ranges


def by_name(study: Study, rows: Array) -> dict[str, list[float]]:
    """Return a row for each spring, and for each other value of the hardware, by its name."""
    joints = zip(study.spring_names, study.groups, strict=True)
    springs = max(study.groups) + 1
    found = {name: rows[group].tolist() for name, group in joints}
    return found | dict(zip(study.range.names[springs:], rows[springs:].tolist(), strict=True))


def _farthest(good: Callable[[float], bool], own: float, end: float) -> float:
    """Return how far towards an end a logarithm may go, by bisection."""
    if own == end or good(end):
        return end
    near, far = own, end
    for _ in range(HALVINGS):
        middle = (near + far) / 2
        near, far = (middle, far) if good(middle) else (near, middle)
    return near


def prices_of(
    study: Study, instance: Instance, found: Found, worth: tuple[float, str], program: Program
) -> tuple[Price, ...]:
    """Return what each binding bound costs, the dearest first.

    Args:
        study: whose bounds they are.
        instance: the NLP that was solved.
        found: its optimum.
        worth: what the objective counts as one, with its unit.
        program: its functions.
    """
    one, unit = worth

    def price(bound: str, gain: float, room: str) -> Price:
        return Price(bound, gain * one if unit == "N" else None, room, gain * one, unit)

    tasks = found.multipliers[: instance.shape.postures * program.rows]
    by_row = tasks.reshape(-1, program.rows)[:, program.held :].sum(axis=0)
    pieces = np.split(by_row, np.cumsum(program.bound_rows)[:-1])
    prices = [
        price(bound.name, STEEPNESS[bound.sense] * float(piece.sum()) * PRICED_SHARE, _room(bound))
        for bound, piece in zip(study.bounds, pieces, strict=True)
    ]
    for i, multiplier in enumerate(found.range_multipliers):
        up, spring = multiplier > 0, i <= max(study.groups)
        end, more = ("upper", "stiffer" if spring else "more") if up else ("lower", "less")
        if spring and not up:
            more = "softer"
        name = " of ".join(limit_name(study, i, end))
        if study.range.lower[i] == study.range.upper[i]:
            name = f"{name}, which is held"
        gain = abs(float(multiplier)) * float(np.log10(1 + PRICED_SHARE))
        prices.append(price(name, gain, f"10 % {more}"))
    kept = [each for each in prices if each.gain > LEAST_GAIN_NAMED * one]
    return tuple(sorted(kept, key=lambda each: -each.gain))


def _room(bound: Bound) -> str:
    """Return a tenth of a limit in words."""
    more = "more" if bound.sense == "most" else "less"
    return f"{figure_in_words(PRICED_SHARE * bound.limit, bound.unit, 3)} {more}"


def worth_of(study: Study, force: float) -> tuple[float, str]:
    """Return what an objective's cost of one is worth, and its unit.

    Args:
        study: whose objective it is.
        force: that counts as one [N].
    """
    if study.objective.scales_speed:  # costs are logarithms, or shares of a time
        return 100.0, "%"
    return force, "N"
