# SPDX-License-Identifier: BSD-3-Clause
"""Hardware at random, about as stiff as the bounds need, of which the best begin searches."""

from __future__ import annotations

import numpy as np

from softimpact.symbolic.robot.rigid import Array

from ..search.ipopt import Instance, VariableBounds, felt
from ..search.minimax_point import bound_rows
from ..search.nlp import Program
from .screening import largest_forces

SAMPLES = 128
"""Hardware that is looked at. Optima of springs are many; the worst force of a sample tells which
of them a search from it ends in far better than how stiff or soft it is."""

SCALED = 2
"""How often samples are scaled to what the bounds allow."""

PLACES, HERE, HOPS = 5, 0.1, 2
"""Places in the range of each value that are tried when the others are known; the share of it that
counts as the same place; and searches that begin there."""

SEED = 13
"""Of the random numbers: the same study has the same answer."""


def promising(
    program: Program, instance: Instance, bounds: VariableBounds, postures: Array, count: int
) -> list[tuple[Array, Array]]:
    """Return the springs and other values of the best samples.

    Args:
        program: the functions.
        instance: the NLP.
        bounds: on its variables.
        postures: that are held, K×n [rad].
        count: number of samples returned.
    """
    random = np.random.default_rng(SEED)
    v = random.uniform(bounds.lower, bounds.upper, (SAMPLES, bounds.lower.size))
    for _ in range(SCALED):
        missed = _missed(program, instance, postures, v)
        # a deflection over its limit is in proportion to 1/k_s, and its row has the square
        v[:, : bounds.springs] += 0.5 * np.log10(1 + missed)[:, None]
        v = np.clip(v, bounds.lower, bounds.upper)
    return _best(program, instance, bounds, postures, v, count)


def elsewhere(
    program: Program, instance: Instance, bounds: VariableBounds, postures: Array, v: Array
) -> list[tuple[Array, Array]]:
    """Return the best of what differs from v, V, in one value, the others held.

    What impacts hardly feel has optima of its own, often one at each end.
    """
    found = []
    for i, own in enumerate(v):
        places = np.linspace(bounds.lower[i], bounds.upper[i], PLACES)
        for place in places[abs(places - own) > HERE * (bounds.upper[i] - bounds.lower[i])]:
            moved = v.copy()
            moved[i] = place
            found.append(moved)
    if not found:
        return []
    return _best(program, instance, bounds, postures, np.array(found), HOPS)


def _best(
    program: Program,
    instance: Instance,
    bounds: VariableBounds,
    postures: Array,
    v: Array,
    count: int,
) -> list[tuple[Array, Array]]:
    """Return the springs and other values of those of m×V that are best."""
    missed = np.maximum(_missed(program, instance, postures, v), 0.0)
    order = np.argsort(_worst(program, instance, postures, v) + missed)[:count]
    return [bounds.parted(v[i]) for i in order]


def _missed(program: Program, instance: Instance, postures: Array, v: Array) -> Array:
    """Return the largest row of any bound for each sample, below zero where all are kept."""
    q, b = np.tile(postures, (len(v), 1)), np.tile(instance.tasks, (len(v), 1))
    rows = bound_rows(program, q, np.repeat(v, len(postures), axis=0), b)[0]
    return np.asarray(rows.reshape(len(v), -1).max(axis=1))


def _worst(program: Program, instance: Instance, postures: Array, v: Array) -> Array:
    """Return the largest share of each sample."""
    y = np.array([felt(program, each) for each in v])
    shares = np.empty((len(v), len(instance.impacts)))
    for i, (k, point) in enumerate(instance.shape.impacts):
        x = np.column_stack([np.tile(postures[k], (len(v), 1)), y])
        numbers = np.tile(instance.impacts[i], (len(v), 1))
        shares[:, i] = largest_forces(program, point, x, numbers) / instance.units[i]
    return np.asarray(shares.max(axis=1))
