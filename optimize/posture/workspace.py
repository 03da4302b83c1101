# SPDX-License-Identifier: BSD-3-Clause
"""Postures all over a plane: from one posture on, each next to the one before."""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, InvalidValue
from softimpact.symbolic.robot.rigid import Array

from .tip_pose import tip_pose, tip_pose_error

CORRECTIONS = 25
"""Newton steps to a place at most."""

HELD = 1e-8
"""Error [m, rad] up to which a place is reached."""

NEWTON_DAMPING = 1e-4
"""Damping of Newton's steps [m, rad], so that they stay small where an arm is nearly stretched."""

MOST_PLACES = 40_000
"""Places of a plane at most."""

Hold = Literal["pose", "position"]
"""What of the tip is led along: its turn, too, or its place alone."""


@dataclass(frozen=True, eq=False)
class Plane:
    """Postures that put the tip on the points of a grid.

    Attributes:
        u, v: where rows and columns lie along two of the base's axes [m], lengths U and V.
        axes: indices of these two.
        place: the tip's, U×V×3 [m].
        q: posture, U×V×n; NaN where the tip does not get to.
    """

    u: Array
    v: Array
    axes: tuple[int, int]
    place: Array
    q: Array

    @property
    def reached(self) -> Array:
        """Where there is a posture, U×V."""
        return ~np.isnan(self.q[..., 0])


def postures_in_plane(
    model: ImpactModel,
    q: Array,
    axes: tuple[int, int],
    step: float,
    hold: Hold = "pose",
) -> Plane:
    """Return postures with the tip on a grid through its place at q, as far as the arm gets.

    Each posture is the nearest to that of a neighbour, within the joints' limits; which one it is
    of several that reach a place depends on the way there, and on q.

    Args:
        model: whose tip is led.
        q: posture to begin with, length n; within the limits.
        axes: of the plane, two different ones of 0 (x), 1 (y) and 2 (z), base axes.
        step: of the grid [m].
        hold: whether the tip keeps its turn.

    Raises:
        InvalidValue: a step that is not positive, or so fine that there are too many places.
    """
    if not 0 < step < np.inf:
        raise InvalidValue("step", f"must be finite and greater than 0 m, not {step:g}")
    start, rotation = tip_pose(model, q)
    solve = _solver(model, rotation, hold)
    found: dict[tuple[int, int], Array] = {(0, 0): np.asarray(q, dtype=float)}
    border = [(0.0, (0, 0))]  # nearest to the beginning first
    while border:
        way, (i, j) = heapq.heappop(border)
        for di, dj in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            at = (i + di, j + dj)
            if at in found:
                continue
            aim = start.copy()
            aim[list(axes)] += step * np.array(at)
            posture = solve(found[i, j], aim)
            if posture is None:
                continue
            found[at] = posture
            apart = float(np.linalg.norm(posture - found[i, j]))
            heapq.heappush(border, (way + apart, at))
            if len(found) > MOST_PLACES:
                raise InvalidValue(
                    "step", f"makes more than {MOST_PLACES} places; take a larger one"
                )
    return _plane(found, start, axes, step)


def _solver(
    model: ImpactModel, rotation: Array, hold: Hold
) -> Callable[[Array, Array], Array | None]:
    x, p = ca.SX.sym("x", model.robot.n), ca.SX.sym("p", 3)
    error = tip_pose_error(model, x, p, ca.DM(rotation))
    error = error if hold == "pose" else error[:3]
    function = ca.Function("lead", [x, p], [error, ca.jacobian(error, x)])
    lower, upper = model.robot.limits

    def solve(beginning: Array, aim: Array) -> Array | None:
        q = beginning
        for _ in range(CORRECTIONS):
            values, slope = function(q, aim)
            e, J = np.array(values).ravel(), np.array(slope)
            if abs(e).max() < HELD:
                return q
            inertia = J @ J.T + NEWTON_DAMPING**2 * np.eye(len(e))
            q = np.clip(q - J.T @ np.linalg.solve(inertia, e), lower, upper)
        return None

    return solve


def _plane(
    found: dict[tuple[int, int], Array], start: Array, axes: tuple[int, int], step: float
) -> Plane:
    index = np.array(list(found))
    low, size = index.min(axis=0), np.ptp(index, axis=0) + 1
    q = np.full((*size, len(found[0, 0])), np.nan)
    for (i, j), posture in found.items():
        q[i - low[0], j - low[1]] = posture
    u, v = (start[axes[k]] + step * (low[k] + np.arange(size[k])) for k in range(2))
    place = np.empty((*size, 3))
    place[:] = start
    place[..., axes[0]], place[..., axes[1]] = np.meshgrid(u, v, indexing="ij")
    return Plane(u, v, axes, place, q)
