# SPDX-License-Identifier: BSD-3-Clause
"""Springs that can be bought: the best of a catalogue, by rounding and repair."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np

from softimpact.symbolic.robot.rigid import Array

from ..evaluation import keeps_bounds, kept_in_all
from ..search.failure import Unavailable
from ..study.study import Study
from .certificate import Hardening, Setting, Worst

ROUNDS = 20
"""Most rounds of exchange of springs."""


@dataclass(frozen=True, eq=False)
class Bought:
    """Springs of a catalogue.

    Attributes:
        at: the machine with them.
        worst: over all scenarios with them.
        springs: joint stiffness, length n [N·m/rad].
        ideal: springs of any stiffness, length n [N·m/rad].
        loss: share of the objective that the catalogue costs against these.
        tried: combinations evaluated.
    """

    at: Hardening
    worst: Worst
    springs: Array
    ideal: Array
    loss: float
    tried: int


def bought(setting: Setting, decisive: Setting, at: Hardening, ideal: Worst) -> Bought:
    """Return the best springs of a study's catalogue that were found.

    Each spring is rounded to the next stiffer entry; then one or two of them at a time are
    exchanged for others, as long as that helps. What is found is optimal among its neighbours of
    two, which need not be the best of all.

    Args:
        setting: with all scenarios, over which the result is evaluated.
        decisive: with those that decide.
        at: the machine with springs of any stiffness.
        ideal: the worst with these.

    Raises:
        Unavailable: no combination was found that keeps all bounds.
    """
    study, limits = setting.study, setting.limits
    entries = _entries(study)
    seen: dict[tuple[int, ...], float] = {}

    def machine(places: tuple[int, ...]) -> Hardening:
        v = at.v.copy()
        v[: len(places)] = [each[i] for each, i in zip(entries, places, strict=True)]
        return replace(at, v=v, factors=None)

    def cost(places: tuple[int, ...]) -> float:
        if places not in seen:
            seen[places] = _cost(decisive, machine(places))
        return seen[places]

    stiffer = tuple(
        min(int(np.searchsorted(each, own - 1e-9)), each.size - 1)
        for each, own in zip(entries, at.v, strict=False)
    )
    best = stiffer
    starts = [stiffer, tuple(each.size - 1 for each in entries)]
    for start in starts:
        best = min(best, _descended(start, entries, cost), key=cost)
    if not np.isfinite(cost(best)):
        found = machine(best)
        each = kept_in_all(study, at.postures, *limits.parted(found.v))
        broken = max((k for row in each for k in row), key=lambda k: k.share)
        raise Unavailable(broken.name, broken.share)
    found = machine(best)
    worst, _ = setting.worst(found)
    value, free = worst.value, ideal.value
    loss = free / value - 1 if study.objective.more_is_better else value / free - 1
    (springs, _), (own, _) = limits.parted(at.v), limits.parted(found.v)
    catalogue = np.array(study.catalogue)
    own = catalogue[abs(np.log(own[:, None] / catalogue)).argmin(axis=1)]
    return Bought(replace(found, factors=worst.factors), worst, own, springs, loss, len(seen))


def _entries(study: Study) -> list[Array]:
    """Return log10 of the entries that each group of joints may take, rising."""
    springs = max(study.groups) + 1
    catalogue, ends = np.array(study.catalogue), study.range
    return [
        np.log10(catalogue[(low <= catalogue) & (catalogue <= high)])
        for low, high in zip(ends.lower[:springs], ends.upper[:springs], strict=True)
    ]


def _cost(decisive: Setting, at: Hardening) -> float:
    """Return what is made small; infinite where a bound is broken."""
    parted = decisive.limits.parted(at.v)
    if not keeps_bounds(decisive.study, at.postures, *parted):
        return np.inf
    value = decisive.value(at)[0]
    return 1 / value if decisive.study.objective.more_is_better else value


def _descended(start: tuple[int, ...], entries: list[Array], cost: object) -> tuple[int, ...]:
    """Return what exchanges of one or two springs lead to."""
    assert callable(cost)
    best = start
    for _ in range(ROUNDS):
        better = min(_neighbours(best, entries), key=cost, default=best)
        if not cost(better) < cost(best):
            break
        best = better
    return best


def _neighbours(places: tuple[int, ...], entries: list[Array]) -> Iterator[tuple[int, ...]]:
    """Yield places with one spring changed to any entry, or two by one entry each."""
    for i, each in enumerate(entries):
        for k in range(each.size):
            if k != places[i]:
                yield (*places[:i], k, *places[i + 1 :])
    for i, j in combinations(range(len(entries)), 2):
        for a, b in product((-1, 1), repeat=2):
            moved = list(places)
            moved[i] += a
            moved[j] += b
            if all(0 <= moved[k] < entries[k].size for k in (i, j)):
                yield tuple(moved)
