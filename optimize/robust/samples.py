# SPDX-License-Identifier: BSD-3-Clause
"""Hardware at random, about as stiff as the bounds need, of which the best begin searches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from softimpact.symbolic.robot.rigid import Array, Indices

from ..search.ipopt import Nlp, felt
from ..search.minimax_point import values_of_bounds
from .screening import largest_forces

SAMPLES = 128
"""Hardware that is looked at. Optima of springs are many; the worst force of a sample tells which
of them a search from it ends in far better than how stiff or soft it is."""

MOST_BENT = 10
"""Postures, the first of those that are held, in which bounds tell how good a sample is."""

PLACES, FAR = 5, 0.2
"""Places in the range of each value that are tried when the others are known, and the share of the
range that is far enough from where it is: a search that begins nearer comes back."""

HARDLY = 0.01
"""Share of the cost by which a change of what is hardly felt raises it at most."""

HOPELESS = 0.1
"""Share of the cost by which the worst force is larger where it is not worth a search: of ten
problems' better optima each was found from where it is not, whatever the bounds there."""

SEED = 13
"""Of the random numbers: the same study has the same answer."""

SampledHardware = tuple[Array, Array]
"""Springs and other values."""


def promising(
    nlp: Nlp,
    postures: Array,
    known: Sequence[Array],
    count: int,
) -> list[SampledHardware]:
    """Return the best of what is known and of samples, best first.

    Args:
        nlp: what is to be solved.
        postures: that are held, K×n [rad].
        known: log10 of all values, V each.
        count: number of them returned.
    """
    random, bounds = np.random.default_rng(SEED), nlp.bounds
    v = random.uniform(bounds.lower, bounds.upper, (SAMPLES, bounds.lower.size))
    # a deflection over its limit is in proportion to 1/k_s, and its row has the square
    v[:, : bounds.springs] += 0.5 * np.log10(1 + _missed(nlp, postures, v))[:, None]
    v = np.vstack([*known, np.clip(v, bounds.lower, bounds.upper)])
    best = _best(nlp, postures, v, count, range(len(nlp.instance.impacts)))
    return [bounds.parted(each.v) for each in best]


def elsewhere(
    nlp: Nlp,
    postures: Array,
    v: Array,
    shares: Array,
    values: Sequence[int],
) -> list[SampledHardware]:
    """Return for each of some values the best of what differs from v, V, in it alone, and far.

    Other optima are seldom reached by small changes. What impacts hardly feel has optima of its
    own, often one at each end: of it the best above is returned, and the best below. Where forces
    are much larger than with v, whose largest share of each impact is known, nothing is returned.
    """
    found, bounds = [], nlp.bounds
    order, cost = np.argsort(-shares), float(shares.max())
    for i, own in zip(values, v[list(values)], strict=True):
        places = np.linspace(bounds.lower[i], bounds.upper[i], PLACES)
        far = places[abs(places - own) > FAR * (bounds.upper[i] - bounds.lower[i])]
        sides = []
        for side in (far[far < own], far[far > own]):
            moved = np.tile(v, (side.size, 1))
            moved[:, i] = side
            sides += _best(nlp, postures, moved, 1, order)
        sides.sort(key=lambda each: each.cost)
        hardly = [k for k in sides[1:] if k.cost <= cost * (1 + HARDLY)]
        found += [k.v for k in [*sides[:1], *hardly] if k.worst <= cost * (1 + HOPELESS)]
    return [bounds.parted(each) for each in found]


@dataclass(frozen=True, eq=False)
class _Sample:
    """A sample: v, V, its worst share, and that with what bounds are missed by."""

    v: Array
    worst: float
    cost: float


def _best(
    nlp: Nlp,
    postures: Array,
    v: Array,
    count: int,
    order: Sequence[int] | Indices,
) -> list[_Sample]:
    """Return the best of m×V, best first.

    One of the worst impacts tells how good a sample is at most: those that cannot be among the best
    any more are left out.

    Args:
        nlp: what is to be solved.
        postures: that are held, K×n [rad].
        v: log10 of all values, m×V.
        count: of what is returned, at most.
        order: of the impacts, the worst first.
    """
    if not v.size:
        return []
    missed = np.maximum(_missed(nlp, postures, v), 0.0)
    worst = _worst(nlp, postures, v, order[:1])
    least, costs = worst + missed, np.full(len(v), np.inf)
    ranked = np.argsort(least, kind="stable")
    for begin in range(0, len(v), 2 * count):
        some = ranked[begin : begin + 2 * count]
        if np.sort(costs)[min(count, len(v)) - 1] <= least[some[0]]:
            break
        rest = _worst(nlp, postures, v[some], order[1:])
        worst[some] = np.maximum(worst[some], rest)
        costs[some] = worst[some] + missed[some]
    best = np.argsort(costs, kind="stable")[:count]
    return [_Sample(v[i], float(worst[i]), float(costs[i])) for i in best]


def _missed(nlp: Nlp, postures: Array, v: Array) -> Array:
    """Return the largest row of any bound for each sample, below zero where all are kept."""
    some, tasks = postures[:MOST_BENT], nlp.instance.tasks[:MOST_BENT]
    q, b = np.tile(some, (len(v), 1)), np.tile(tasks, (len(v), 1))
    rows = values_of_bounds(nlp.program, q, np.repeat(v, len(some), axis=0), b)
    return np.asarray(rows.reshape(len(v), -1).max(axis=1))


def _worst(nlp: Nlp, postures: Array, v: Array, which: Sequence[int] | Indices) -> Array:
    """Return the largest share of each sample in some impacts; zero without any."""
    instance = nlp.instance
    y = felt(nlp.program, v)
    shares = np.zeros((len(v), len(which)))
    points = np.array([instance.shape.impacts[i][1] for i in which])
    for point in np.unique(points):
        at = [i for i, own in zip(which, points, strict=True) if own == point]
        poses = postures[[instance.shape.impacts[i][0] for i in at]]
        x = np.column_stack([np.tile(poses, (len(v), 1)), np.repeat(y, len(at), axis=0)])
        numbers = np.tile(instance.impacts[at], (len(v), 1))
        forces = largest_forces(nlp.program, int(point), x, numbers)
        shares[:, points == point] = forces.reshape(len(v), -1) / instance.units[at]
    return np.asarray(shares.max(axis=1, initial=0.0))
