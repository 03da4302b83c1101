# SPDX-License-Identifier: BSD-3-Clause
"""Hardware at random, about as stiff as the bounds need, of which the best begin searches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from softimpact.symbolic.robot.rigid import Array

from ..search.ipopt import Instance, VariableBounds, felt
from ..search.minimax_point import values_of_bounds
from ..search.nlp import Program
from .screening import largest_forces

SAMPLES = 128
"""Hardware that is looked at. Optima of springs are many; the worst force of a sample tells which
of them a search from it ends in far better than how stiff or soft it is."""

SCALED = 2
"""How often samples are scaled to what the bounds allow."""

PLACES, FAR = 5, 0.25
"""Places in the range of each value that are tried when the others are known, and the share of the
range that is far enough from where it is: a search that begins nearer comes back."""

HARDLY = 0.01
"""Share of the cost by which a change of what is hardly felt raises it at most."""

SEED = 13
"""Of the random numbers: the same study has the same answer."""

SampledHardware = tuple[Array, Array]
"""Springs and other values."""


def promising(
    program: Program,
    instance: Instance,
    bounds: VariableBounds,
    postures: Array,
    known: Sequence[Array],
    count: int,
) -> list[SampledHardware]:
    """Return the best of what is known and of samples, best first.

    Args:
        program: the functions.
        instance: the NLP.
        bounds: on its variables.
        postures: that are held, K×n [rad].
        known: log10 of all values, V each.
        count: number of them returned.
    """
    random = np.random.default_rng(SEED)
    v = random.uniform(bounds.lower, bounds.upper, (SAMPLES, bounds.lower.size))
    for _ in range(SCALED):
        missed = _missed(program, instance, postures, v)
        # a deflection over its limit is in proportion to 1/k_s, and its row has the square
        v[:, : bounds.springs] += 0.5 * np.log10(1 + missed)[:, None]
        v = np.clip(v, bounds.lower, bounds.upper)
    v = np.vstack([*known, v])
    best = _best(program, instance, postures, v, count)
    return [bounds.parted(each) for _, each in best]


def elsewhere(
    program: Program,
    instance: Instance,
    bounds: VariableBounds,
    postures: Array,
    v: Array,
    values: Sequence[int],
) -> list[SampledHardware]:
    """Return for each of some values the best of what differs from v, V, in it alone, and far.

    Other optima are seldom reached by small changes. What impacts hardly feel has optima of its
    own, often one at each end: of it the best above is returned, and the best below.
    """
    found = []
    (cost, _), *_ = _best(program, instance, postures, v[None], 1)
    for i, own in zip(values, v[list(values)], strict=True):
        places = np.linspace(bounds.lower[i], bounds.upper[i], PLACES)
        far = places[abs(places - own) > FAR * (bounds.upper[i] - bounds.lower[i])]
        sides = []
        for side in (far[far < own], far[far > own]):
            moved = np.tile(v, (side.size, 1))
            moved[:, i] = side
            sides += _best(program, instance, postures, moved, 1)
        sides.sort(key=lambda each: each[0])
        found += [each for k, (c, each) in enumerate(sides) if not k or c <= cost * (1 + HARDLY)]
    return [bounds.parted(each) for each in found]


def _best(
    program: Program, instance: Instance, postures: Array, v: Array, count: int
) -> list[tuple[float, Array]]:
    """Return the best of m×V with what they cost, best first.

    The first impact, one of the worst, tells how good a sample is at most: those that cannot be
    among the best any more are left out.
    """
    if not v.size:
        return []
    missed = np.maximum(_missed(program, instance, postures, v), 0.0)
    least = _worst(program, instance, postures, v, range(1)) + missed
    order, costs = np.argsort(least, kind="stable"), np.full(len(v), np.inf)
    others = range(1, len(instance.impacts))
    for begin in range(0, len(v), 2 * count):
        some = order[begin : begin + 2 * count]
        if np.sort(costs)[min(count, len(v)) - 1] <= least[some[0]]:
            break
        rest = _worst(program, instance, postures, v[some], others) + missed[some]
        costs[some] = np.maximum(least[some], rest)
    best = np.argsort(costs, kind="stable")[:count]
    return [(float(costs[i]), v[i]) for i in best]


def _missed(program: Program, instance: Instance, postures: Array, v: Array) -> Array:
    """Return the largest row of any bound for each sample, below zero where all are kept."""
    q, b = np.tile(postures, (len(v), 1)), np.tile(instance.tasks, (len(v), 1))
    rows = values_of_bounds(program, q, np.repeat(v, len(postures), axis=0), b)
    return np.asarray(rows.reshape(len(v), -1).max(axis=1))


def _worst(program: Program, instance: Instance, postures: Array, v: Array, which: range) -> Array:
    """Return the largest share of each sample in some impacts; zero without any."""
    y = np.array([felt(program, each) for each in v])
    shares = np.zeros((len(v), len(which)))
    points = np.array([instance.shape.impacts[i][1] for i in which])
    for point in np.unique(points):
        at = [i for i, own in zip(which, points, strict=True) if own == point]
        poses = postures[[instance.shape.impacts[i][0] for i in at]]
        x = np.column_stack([np.tile(poses, (len(v), 1)), np.repeat(y, len(at), axis=0)])
        forces = largest_forces(program, int(point), x, np.tile(instance.impacts[at], (len(v), 1)))
        shares[:, points == point] = forces.reshape(len(v), -1) / instance.units[at]
    return np.asarray(shares.max(axis=1, initial=0.0))
