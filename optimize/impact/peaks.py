# SPDX-License-Identifier: BSD-3-Clause
"""The peaks of a force over time: few numbers to differentiate, where the nodes are hundreds.

An impact that is to be made harmless often has two peaks of the same height. Each is the largest
force within a window of time, so that a search sees both; the windows meet in the valley between.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic import Matrix
from softimpact.symbolic.matrices import MatrixExpression
from softimpact.symbolic.robot.rigid import Array

WINDOWS = 2
"""Windows of time, each with its peak."""

NEARLY_AS_LARGE = 0.98
"""Share of the largest peak from which another within the same window deserves its own."""

LEAST_DIP = 0.01
"""Share of the largest peak by which the force falls between two that are not one."""

LEAST_CURVATURE = 1e-9
"""Curvature [N] below which three forces lie on a line."""


def peaks_in_windows(forces: Matrix, boundary: Matrix) -> MatrixExpression:
    """Return the largest force before and from a node on, length ``WINDOWS`` [N].

    Args:
        forces: at equidistant times, beginning one interval after first touch.
        boundary: number of the node with which the second window begins.
    """
    tops = _vertices(forces)
    late = ca.DM(range(forces.numel())) >= boundary
    return ca.vertcat(ca.mmax(tops * (1 - late)), ca.mmax(tops * late))


def _vertices(forces: Matrix) -> Matrix:
    """Return the forces; at local maxima those of the parabola through three of them."""
    before, after = ca.vertcat(0, forces[:-1]), ca.vertcat(forces[1:], forces[-1])
    is_top = (forces >= before) * (forces >= after)
    curvature = ca.fmax(2 * forces - before - after, LEAST_CURVATURE)
    return forces + is_top * (after - before) ** 2 / (8 * curvature)


def valley(forces: Array) -> int:
    """Return the node that best parts two peaks: most below the lower of them; 0 if there is one.

    Args:
        forces: at equidistant times [N].
    """
    depths = _lower_peak(forces) - forces
    return int(np.argmax(depths)) if forces.size and depths.max() > 0 else 0


def hides_a_peak(forces: Array, boundary: int) -> bool:
    """Return whether a window holds two peaks that are almost as large as the largest of all."""
    largest = float(forces.max())
    for part in (forces[:boundary], forces[boundary:]):
        split = valley(part)
        lower = _lower_peak(part)[split] if split else 0.0
        if lower > NEARLY_AS_LARGE * largest and lower - part[split] > LEAST_DIP * largest:
            return True
    return False


def _lower_peak(forces: Array) -> Array:
    """Return, for each node, the lower of the peaks before it and from it on."""
    ahead = np.maximum.accumulate(forces[::-1])[::-1]
    return np.minimum(np.maximum.accumulate(forces), ahead)


def tops(forces: Array) -> list[tuple[NDArray[np.int64], Array]]:
    """Return nodes and heights of all local maxima, as ``peaks_in_windows`` has them.

    Args:
        forces: at equidistant times, a row for each impact; of one that is zero throughout, the
            first node counts.
    """
    before, after = np.zeros_like(forces), forces.copy()
    before[:, 1:], after[:, :-1] = forces[:, :-1], forces[:, 1:]
    curvature = np.maximum(2 * forces - before - after, LEAST_CURVATURE)
    heights = forces + (after - before) ** 2 / (8 * curvature)
    at_top = (forces >= before) & (forces >= after) & (forces > 0)
    at_top[~at_top.any(axis=1), 0] = True
    rows, nodes = np.nonzero(at_top)
    ends = np.cumsum(np.bincount(rows, minlength=len(forces)))[:-1]
    pairs = zip(np.split(nodes, ends), np.split(heights[at_top], ends), strict=True)
    return list(pairs)


def top_weights(forces: Array, node: int) -> Array:
    """Return the derivative by the forces of the height of the local maximum at a node."""
    last = forces.size - 1
    before, own = forces[node - 1] if node else 0.0, forces[node]
    after = forces[min(node + 1, last)]
    rise, curvature = after - before, max(2 * own - before - after, LEAST_CURVATURE)
    by_rise = rise / (4 * curvature)
    by_curvature = -(rise**2) / (8 * curvature**2) if curvature > LEAST_CURVATURE else 0.0
    weights = np.zeros(forces.size)
    weights[node] += 1 + 2 * by_curvature
    weights[min(node + 1, last)] += by_rise - by_curvature
    if node:
        weights[node - 1] += -by_rise - by_curvature
    return weights
