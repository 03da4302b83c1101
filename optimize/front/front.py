# SPDX-License-Identifier: BSD-3-Clause
"""Pareto fronts: designs that no other beats in both accuracy and force."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ..evaluation import largest_deflection
from ..meaning import Meaning
from ..search.solve import Outcome
from ..study.study import Study
from .dominance import WORTH
from .dominance import knee as bend


@dataclass(frozen=True, eq=False)
class ParetoPoint:
    """A design on a front.

    Attributes:
        bound: on the deflection, with which it was sought [m].
        deflection: largest of the tip under the study's forces, by the springs [m].
        outcome: of the search that found it.
        meaning: prices of its bounds and indifferent ranges, of points that were asked for them.
    """

    bound: float
    deflection: float
    outcome: Outcome
    meaning: Meaning | None = None

    @property
    def force(self) -> float:
        """Largest peak [N]."""
        return self.outcome.force


@dataclass(frozen=True, eq=False)
class Front:
    """Designs from the most accurate to the one of least force.

    Attributes:
        points: deflection grows and force falls from each to the next.
        outcomes: what was found at each level, None where it is out of reach.
    """

    points: tuple[ParetoPoint, ...]
    outcomes: tuple[Outcome | None, ...]

    @property
    def unsolved(self) -> tuple[Outcome, ...]:
        """Levels within reach that Ipopt did not solve."""
        return tuple(o for o in self.outcomes if o is not None and not o.solved)


def front(study: Study, levels: Sequence[float], outcomes: Sequence[Outcome | None]) -> Front:
    """Return the front of what was found at each level [m]."""
    points = [
        ParetoPoint(level, largest_deflection(study, found.q, found.springs), found)
        for level, found in zip(levels, outcomes, strict=True)
        if found is not None and found.solved
    ]
    return Front(undominated(points), tuple(outcomes))


def undominated(points: Iterable[ParetoPoint]) -> tuple[ParetoPoint, ...]:
    """Return the points that no other beats, the most accurate first.

    A less accurate point must save ``WORTH`` of the force.
    """
    kept: list[ParetoPoint] = []
    for point in sorted(points, key=lambda point: (point.deflection, point.force)):
        if not kept or point.force < kept[-1].force * (1 - WORTH):
            kept.append(point)
    return tuple(kept)


def knee(points: Sequence[ParetoPoint]) -> int | None:
    """Return the number of the point after which more deflection buys least for what it costs.

    It is the point farthest below the straight line between the ends of the front, in force over
    the logarithm of the deflection, each from 0 to 1. None for fronts of two points or less, and
    for those that are nowhere below it.
    """
    places = [(np.log(point.deflection), point.force) for point in points]
    return bend(np.array(places)) if len(points) > 2 else None
