# SPDX-License-Identifier: BSD-3-Clause
"""A search that carries only the impacts that decide it, and looks at the others when it ends.

Where it is not known what motors do, an impact has two ends of which one is nearly always the
worse; the derivatives of the other are most of its price.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from softimpact.symbolic.robot.rigid import Array, Indices

from .ipopt import Found, Instance, VariableBounds, impact_forces, minimise
from .nlp import NlpShape, Program

CARRIED_FROM = 0.98
"""Share of the worst force from which on an impact is carried from the start."""

MOST_EXCESS = 1e-4
"""Share by which an impact that is left out may exceed the worst: forces are no better known."""


def minimise_deciding(
    program: Program,
    instance: Instance,
    bounds: VariableBounds,
    postures: Array,
    springs: Array,
    others: Array | None = None,
    *,
    free: bool,
) -> Found:
    """Return what ``minimise`` does, the largest of all forces made small.

    Impacts are carried that are near the worst where the search starts, and those that turn out to
    be worse where it ends; from there it goes on.
    """
    v = bounds.vector(springs, others)
    shares = instance.shares(impact_forces(program, instance, postures, v))
    carried = np.flatnonzero(shares >= CARRIED_FROM * shares.max())
    iterations = 0
    while True:
        some = _some(instance, carried)
        found = minimise(program, some, bounds, postures, springs, others, free=free)
        iterations += found.iterations
        v = bounds.vector(found.springs, found.others)
        shares = instance.shares(impact_forces(program, instance, found.postures, v))
        worse = np.flatnonzero(shares > found.worst * (1 + MOST_EXCESS))
        fresh = np.setdiff1d(worse, carried)
        shares[carried] = found.shares
        found = replace(found, shares=shares, iterations=iterations)
        if not fresh.size:
            return found
        carried = np.union1d(carried, fresh)
        postures, springs, others = found.postures, found.springs, found.others


def _some(instance: Instance, carried: Indices) -> Instance:
    """Return the NLP with some of its impacts."""
    shape, places = instance.shape, [int(i) for i in carried]
    return Instance(
        NlpShape.of(
            shape.postures,
            [shape.impacts[i] for i in places],
            [shape.scenarios[i] for i in places],
            shape.objective,
        ),
        instance.tasks,
        instance.impacts[places],
        instance.units[places],
    )
