# SPDX-License-Identifier: BSD-3-Clause
"""Many impacts of one posture: several contact points, directions and bodies in one call."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from softimpact.symbolic import Contact, ImpactModel, InvalidValue, unit_direction
from softimpact.symbolic.record import Record, Row
from softimpact.symbolic.robot.rigid import Array

from .arrival import Approach
from .assessment import Assessment, assess_impact


@dataclass(frozen=True, eq=False)
class AssessedImpact:
    """One of many impacts.

    Attributes:
        point: contact frame.
        direction: unit vector n.
        region: name of what is hit.
        clamped: whether that is held.
        found: the assessment.
    """

    point: str
    direction: Array
    region: str
    clamped: bool
    found: Assessment

    @property
    def row(self) -> Row:
        """The case in a table's line."""
        x, y, z = self.direction.tolist()
        worst = next(row for row in self.found.rows() if row["motors"] == self.found.worst)
        held = {"point": self.point, "x": x, "y": y, "z": z, "region": self.region}
        return {**held, "clamped": self.clamped, **worst, "safe_speed": self.found.safe_speed}


@dataclass(frozen=True, eq=False)
class Assessments(Record):
    """Many impacts, in the order of points, directions and bodies.

    Attributes:
        cases: all of them.
    """

    cases: tuple[AssessedImpact, ...]

    @property
    def worst(self) -> AssessedImpact:
        """The case that takes the largest share of a limit."""
        return max(self.cases, key=lambda case: case.found.verdict.share)

    @property
    def safe_speed(self) -> float | None:
        """Largest speed that keeps every limit in every case [m/s]; None if not asked for."""
        speeds = [case.found.safe_speed for case in self.cases]
        return None if None in speeds else min(speed for speed in speeds if speed is not None)

    def rows(self) -> list[Row]:
        """Return a line for each case: the worst that the motors may do."""
        return [case.row for case in self.cases]


def assess_impacts(
    model: ImpactModel,
    q: ArrayLike,
    directions: Iterable[ArrayLike],
    contacts: Iterable[Contact],
    *,
    speed: float,
    points: Sequence[str] | None = None,
    on_case: Callable[[int, int], None] = lambda done, of: None,
    **options: Any,
) -> Assessments:
    """Assess the product of contact points, directions and bodies.

    Args:
        model: the robot; its contact point is replaced by each of ``points``.
        q: link angles, length n.
        directions: of the impacts, base axes, each of length 3.
        contacts: what is hit.
        speed: of the contact point [m/s].
        points: contact frames, or ``FRAME@x,y,z``; default the model's own.
        on_case: called when a case is done, with how many are, and their number.
        options: of ``assess_impact``, such as ``safe_speed=True``.

    Raises:
        InvalidValue: there is nothing to assess; and as ``assess_impact`` does.
        FrameNotFound: there is no such contact frame.
    """
    frames = [model.robot.frame(p).name for p in points] if points is not None else [model.tip]
    unit = [unit_direction(np.asarray(n, dtype=float)) for n in directions]
    asked = list(product(frames, unit, contacts))
    if not asked:
        raise InvalidValue("directions, contacts", "need one of each at least")
    cases = []
    for point, n, contact in asked:
        at, approach = replace(model, tip=point), Approach(q, n, speed)
        found = assess_impact(at, approach, contact, **options)
        cases.append(AssessedImpact(point, n, contact.region.name, contact.clamped, found))
        on_case(len(cases), len(asked))
    return Assessments(tuple(cases))
