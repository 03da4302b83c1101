# SPDX-License-Identifier: BSD-3-Clause
"""Which points of several objectives are beaten by none, and where their front bends."""

from __future__ import annotations

import numpy as np

from softimpact.symbolic.robot.rigid import Array

WORTH = 1e-4
"""Share of an objective that counts as a difference: what forces are known to."""

FLAT = 1e-6
"""Share of a front's height below the plane of its ends from which it counts as bent."""


def undominated(costs: Array, worth: float) -> list[int]:
    """Return the numbers of the points that no other beats, in their order.

    A point goes if another is no worse in anything, to a share of ``worth``. Of points that are
    the same to that share the first stays.

    Args:
        costs: a row a point, all greater than zero; less is better.
        worth: share that counts as a difference.
    """
    order = np.lexsort(np.round(np.log(costs) / worth).T[::-1])
    kept: list[int] = []
    for i in order:
        if not any(np.all(costs[j] <= costs[i] * (1 + worth)) for j in kept):
            kept.append(int(i))
    return sorted(kept)


def knee(places: Array) -> int | None:
    """Return the number of the point where a front bends most: beyond it all costs more.

    It is the one farthest below the plane through the ends of the front, the points best in one
    objective each; the straight line between them for two.

    Args:
        places: a row a point, a column an objective, in whose scale ends are compared; less is
            better.

    Returns:
        None for fewer points than objectives and one, and for those that are nowhere below.
    """
    count, size = places.shape
    low, high = places.min(axis=0), places.max(axis=0)
    wide = high > low
    if wide.sum() < min(2, size) or count <= wide.sum():
        return None
    unit = ((places - low) / np.where(wide, high - low, 1.0))[:, wide]
    # of those best in an objective, the one that is best in the others
    best_in = (np.where(column == 0, unit.sum(axis=1), np.inf) for column in unit.T)
    ends = [int(np.argmin(sums)) for sums in best_in]
    below = 1 - unit @ _normal(unit[ends])
    below[ends] = -np.inf
    best = int(np.argmax(below))
    return best if below[best] > FLAT else None


def _normal(ends: Array) -> Array:
    """Return n of the plane n·x = 1 through the ends, or of an even one if theirs is not."""
    even = np.full(len(ends), 1 / max(float(ends.sum(axis=1).mean()), FLAT))
    if abs(np.linalg.det(ends)) < FLAT:
        return even
    found = np.linalg.solve(ends, np.ones(len(ends)))
    return np.asarray(found) if np.all(found > 0) else even
