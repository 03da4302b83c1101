# SPDX-License-Identifier: BSD-3-Clause
"""A search that carries only the impacts that decide it, and looks at the others when it ends.

Where it is not known what motors do, an impact has two ends of which one is nearly always the
worse; the derivatives of the other are most of its price.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from softimpact.symbolic.robot.rigid import Array, Indices

from .ipopt import Begin, Found, Instance, Nlp, impact_forces, minimise
from .nlp import NlpShape

CARRIED_FROM = 0.98
"""Share of the worst force from which on an impact is carried from the start."""

MOST_EXCESS = 1e-4
"""Share by which an impact that is left out may exceed the worst: forces are no better known."""


def minimise_deciding(nlp: Nlp, begin: Begin, *, free: bool) -> Found:
    """Return what ``minimise`` does, the largest of all forces made small.

    Impacts are carried that are near the worst where the search starts, and those that turn out to
    be worse where it ends; from there it goes on.
    """
    shares = _shares(nlp, begin)
    carried = np.flatnonzero(shares >= CARRIED_FROM * shares.max())
    iterations = 0
    while True:
        some = replace(nlp, instance=_some(nlp.instance, carried))
        found = minimise(some, begin, free=free)
        iterations += found.iterations
        begin = found.end
        shares = _shares(nlp, begin)
        worse = np.flatnonzero(shares > found.worst * (1 + MOST_EXCESS))
        fresh = np.setdiff1d(worse, carried)
        shares[carried] = found.shares
        found = replace(found, shares=shares, iterations=iterations)
        if not fresh.size:
            return found
        carried = np.union1d(carried, fresh)


def _shares(nlp: Nlp, at: Begin) -> Array:
    """Return the largest share of each impact."""
    v = nlp.bounds.vector(at.springs, at.others)
    return nlp.instance.shares(impact_forces(nlp.program, nlp.instance, at.postures, v))


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
