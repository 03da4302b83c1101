# SPDX-License-Identifier: BSD-3-Clause
"""Laws of contact as packages take them: points with knees, never below the law and hardly above.

Between two points the C follows the parabola that has the law's tangents at both. It is taken as
far as it keeps ``ABOVE``; the forces of all points are then raised by what was missing most.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from softimpact.symbolic import InvalidValue
from softimpact.symbolic.body.laws import Law
from softimpact.symbolic.body.laws.points import CubicPoints
from softimpact.symbolic.body.laws.series import points_of
from softimpact.symbolic.robot.rigid import Array

MOST_POINTS = 128
"""Points that a law may have in C: a bound on a call's time; a measured curve needs some 30."""

ABOVE = 2e-4
"""Largest share by which the C's force is above the law's."""

FAINT = 1e-2
"""Force [N] below which a law's shape does not matter to anyone."""

SPLIT, WIDER = 24, 1.05
"""Places at least in an interval of a law's own points at which a parabola may end, and the largest
factor from one's depth to the next."""

SEEN = np.linspace(0.0, 1.0, 34)[1:]
"""Where along a parabola it is looked at."""

APART = 1e-5
"""Least share between the depths of two points: they must stay two in float."""


def law_points(law: Law) -> Array:
    """Return the points of a law, a row each: depth [m], force [N] and the same of its knee.

    Raises:
        InvalidValue: more than ``MOST_POINTS`` would be needed.
    """
    points = points_of(law)
    grid = _grid(points)
    rows, at, missing = [], 0, 0.0
    while at < len(grid) - 1:
        piece = _longest(points, grid, at)
        rows.append([*piece.start, *piece.knee])
        missing, at = max(missing, piece.missing), piece.end
    last, force = grid[-1], points.evaluated(grid[-1:])[0][0]
    rows.append([last, force, 2 * last, force + last * points.beyond])
    if len(rows) > MOST_POINTS:
        reason = f"needs {len(rows)} points in C, which takes {MOST_POINTS}; smooth it"
        raise InvalidValue("law", reason)
    found = np.array(rows)
    found[:, [1, 3]] *= 1 + missing
    return found


def _grid(points: CubicPoints) -> Array:
    """Return depths at which parabolas may begin and end: the law's points, and some between."""
    low, high = 0.0, float(points.depth[-1])
    for _ in range(100):
        first = (low + high) / 2
        above = points.evaluated(np.array([first]))[0][0] > FAINT
        low, high = (low, first) if above else (first, high)
    own = np.unique([first, *points.depth[points.depth > first]])
    between = []
    for a, b in pairwise(own):
        count = max(SPLIT, math.ceil(math.log(b / a) / math.log(WIDER)))
        between.append(np.geomspace(a, b, count + 1)[:-1])
    return np.concatenate([[0.0], *between, own[-1:]])


@dataclass(frozen=True)
class _Piece:
    start: tuple[float, float]
    knee: tuple[float, float]
    end: int
    missing: float
    fits: bool


def _longest(points: CubicPoints, grid: Array, first: int) -> _Piece:
    """Return the longest parabola from a place of the grid on; the next place always does."""
    best, step = _piece(points, grid, first, first + 1), 1
    while step:
        end = best.end + step
        trial = _piece(points, grid, first, end) if end < len(grid) else None
        if trial is not None and trial.fits:
            best, step = trial, 2 * step
        else:
            step //= 2
    return best


def _piece(points: CubicPoints, grid: Array, first: int, end: int) -> _Piece:
    """Return the parabola between two places, or a straight line where tangents do not meet."""
    a, b = float(grid[first]), float(grid[end])
    (f_a, f_b), _ = points.evaluated(np.array([a, b]))
    after, before = _slope_after(points, a), _slope_before(points, b)
    chord = (f_b - f_a) / (b - a)
    knee, smooth = (a + b) / 2, (after - chord) * (chord - before) > 0
    if smooth:
        knee = a + (f_b - f_a - before * (b - a)) / (after - before)
    share = (knee - a) / (b - a)
    smooth = smooth and APART < share < 1 - APART
    knee = knee if smooth else (a + b) / 2
    over = f_a + after * (knee - a) if smooth else (f_a + f_b) / 2
    over = float(np.clip(over, f_a, f_b))
    t = SEEN
    depth = a * (1 - t) ** 2 + 2 * knee * t * (1 - t) + b * t**2
    force = f_a * (1 - t) ** 2 + 2 * over * t * (1 - t) + f_b * t**2
    right = points.evaluated(depth)[0]
    off = (force - right)[right >= FAINT] / right[right >= FAINT]
    most = float(abs(off).max(initial=0.0))
    fits = most < (ABOVE / 2 if smooth else 1e-9)
    return _Piece((a, f_a), (knee, over), end, max(0.0, float(-off.min(initial=0.0))), fits)


def _slope_after(points: CubicPoints, depth: float) -> float:
    """Return the law's slope from a depth on [N/m]."""
    i = int(np.searchsorted(points.depth, depth, side="right")) - 1
    if i < len(points.depth) and points.depth[i] == depth:
        return float(points.slope_after[i])
    return float(points.evaluated(np.array([depth]))[1][0])


def _slope_before(points: CubicPoints, depth: float) -> float:
    """Return the law's slope up to a depth [N/m]."""
    i = int(np.searchsorted(points.depth, depth, side="left"))
    if i < len(points.depth) and points.depth[i] == depth:
        return float(points.slope_before[i])
    return float(points.evaluated(np.array([depth]))[1][0])
