# SPDX-License-Identifier: BSD-3-Clause
"""A rising curve through points, as an expression and as numbers."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from ...matrices import Matrix
from ...robot.rigid import Array


@dataclass(frozen=True, eq=False)
class CubicPoints:
    """Points of a law and slopes on both sides of each, joined by cubics.

    Attributes:
        depth: of the points [m], rising from 0 on.
        forces: at the points [N], rising from 0 on.
        slope_before: coming from smaller depths [N/m].
        slope_after: coming from larger ones; equal but at corners.
        beyond: slope of the straight line after the last point [N/m].
    """

    depth: Array
    forces: Array
    slope_before: Array
    slope_after: Array
    beyond: float

    @cached_property
    def _cubics(self) -> Array:
        """Coefficients of 1, t, t², t³ over t = (δ − a)/h from 0 to 1, one row an interval."""
        h, rise = np.diff(self.depth), np.diff(self.forces)
        first, last = h * self.slope_after[:-1], h * self.slope_before[1:]
        bend = [first, 3 * rise - 2 * first - last, first + last - 2 * rise]
        return np.column_stack([self.forces[:-1], *bend])

    def force(self, depth: Matrix) -> Matrix:
        """Return the force [N], zero before the points and straight after them.

        A sum of what each interval adds, without branches, so that it is an expression of any kind
        and shape; each interval's share stops at its ends.
        """
        total: Matrix = self.beyond * ca.fmax(0, depth - float(self.depth[-1]))
        h = np.diff(self.depth)
        for a, width, (_, c_1, c_2, c_3) in zip(
            self.depth[:-1].tolist(), h.tolist(), self._cubics.tolist(), strict=True
        ):
            t = ca.fmin(ca.fmax(0, (depth - a) / width), 1)
            total += t * (c_1 + t * (c_2 + t * c_3))
        return total

    @cached_property
    def _plain(self) -> tuple[list[float], list[float], list[list[float]]]:
        return self.depth.tolist(), np.diff(self.depth).tolist(), self._cubics.tolist()

    def at(self, depth: float) -> tuple[float, float]:
        """Return force [N] and slope [N/m] at one depth ≥ 0 [m], fastest for a single one."""
        places, widths, cubics = self._plain
        if depth >= places[-1]:
            over = depth - places[-1]
            return float(self.forces[-1]) + self.beyond * over, self.beyond
        i = bisect_right(places, depth) - 1
        t = (depth - places[i]) / widths[i]
        c_0, c_1, c_2, c_3 = cubics[i]
        force = c_0 + t * (c_1 + t * (c_2 + t * c_3))
        return force, (c_1 + t * (2 * c_2 + t * 3 * c_3)) / widths[i]

    def evaluated(self, depth: Array) -> tuple[Array, Array]:
        """Return force [N] and slope [N/m] for depths ≥ 0 [m] as arrays, much faster."""
        last = len(self.depth) - 2
        i = np.minimum(np.searchsorted(self.depth, depth, side="right") - 1, last)
        h = np.diff(self.depth)[i]
        t = np.minimum((depth - self.depth[i]) / h, 1.0)
        over = np.maximum(depth - self.depth[-1], 0.0)
        c_0, c_1, c_2, c_3 = self._cubics[i].T
        force = c_0 + t * (c_1 + t * (c_2 + t * c_3)) + self.beyond * over
        slope = np.where(over > 0, self.beyond, (c_1 + t * (2 * c_2 + t * 3 * c_3)) / h)
        return force, slope
