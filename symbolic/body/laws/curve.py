# SPDX-License-Identifier: BSD-3-Clause
"""A law of contact from measured points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

import numpy as np

from ...errors import InvalidValue
from ...matrices import Matrix
from ...robot.rigid import Array
from .law import Law
from .points import CubicPoints

SOLID = 1e8
"""Stiffness [N/m] that is as good as solid: a hundred times that of skin under 500 N."""


@dataclass(frozen=True)
class Curve(Law):
    """A law through points (δ, f), rising and once differentiable between them.

    Between points it is the monotone cubic of Fritsch and Butland (SIAM J. Sci. Stat. Comput. 5,
    1984). Beyond the last point nothing is known; there it is as good as solid, the worse case.

    Attributes:
        depths: δ of the points [m], from 0 on, rising.
        forces: f of the points [N], from 0 on, rising.

    Raises:
        InvalidValue: the points are not a law.
    """

    depths: tuple[float, ...]
    forces: tuple[float, ...]

    kind: ClassVar[str] = "curve"

    def __init__(self, depths: Sequence[float], forces: Sequence[float]) -> None:
        for field, values in (("depths", depths), ("forces", forces)):
            object.__setattr__(self, field, tuple(float(value) for value in values))
        self.check()

    @property
    def reach(self) -> float:
        """Force of the last point [N]."""
        return self.forces[-1]

    def force(self, depth: Matrix) -> Matrix:
        """Return f(δ) [N]."""
        return self.points.force(depth)

    @property
    def points(self) -> CubicPoints:
        """The points with their slopes."""
        depth, force = np.array(self.depths), np.array(self.forces)
        slopes = monotone_slopes(depth, force)
        return CubicPoints(depth, force, slopes, slopes, max(SOLID, float(slopes[-1])))

    def check(self) -> None:
        """Raise InvalidValue if the points are not a law."""
        if len(self.depths) != len(self.forces) or len(self.depths) < 2:
            raise InvalidValue("forces", "needs as many values as 'depths', and at least two")
        for field, values in (("depths", self.depths), ("forces", self.forces)):
            if not np.isfinite(values).all():
                raise InvalidValue(field, "must hold finite numbers")
            if values[0] != 0:
                raise InvalidValue(field, f"must start at 0, not at {values[0]:g}")
            for a, b in pairwise(values):
                if not a < b:
                    raise InvalidValue(field, f"must rise throughout, but {b:g} follows {a:g}")


def monotone_slopes(depth: Array, force: Array) -> Array:
    """Return slopes at points for a cubic between them that never falls.

    Inside the weighted harmonic mean of the slopes beside a point; at the ends the three-point
    formula, which is below twice the slope beside it, but not where it would fall.
    """
    h, chord = np.diff(depth), np.diff(force) / np.diff(depth)
    if len(chord) == 1:
        return np.array([chord[0], chord[0]])
    left, right = 2 * h[1:] + h[:-1], h[1:] + 2 * h[:-1]
    inner = (left + right) / (left / chord[:-1] + right / chord[1:])

    def end(h_0: float, h_1: float, c_0: float, c_1: float) -> float:
        return max(0.0, float((2 * h_0 + h_1) * c_0 - h_0 * c_1) / (h_0 + h_1))

    first = end(h[0], h[1], chord[0], chord[1])
    last = end(h[-1], h[-2], chord[-1], chord[-2])
    return np.array([first, *inner, last])
