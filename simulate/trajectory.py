# SPDX-License-Identifier: BSD-3-Clause
"""A robot's motion as samples: joint angles over time, and the speeds with which it passes them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softimpact.symbolic import InvalidValue
from softimpact.symbolic.robot.rigid import Array

CORNER = 0.5
"""A sample is a corner where the speeds before and after differ by more than this share of the
larger: there each side counts for itself, since their mean may be slow or point elsewhere."""


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Joint angles over time.

    Attributes:
        time: of the samples, rising, length S [s].
        q: joint angles, S×n [rad, m].
    """

    time: Array
    q: Array


def trajectory(time: ArrayLike, q: ArrayLike) -> Trajectory:
    """Return a checked motion.

    Raises:
        InvalidValue: fewer than two samples, times that do not rise, numbers that are not finite,
            or shapes that do not fit.
    """
    t, angles = np.asarray(time, dtype=float), np.asarray(q, dtype=float)
    if t.ndim != 1 or angles.ndim != 2 or len(t) != len(angles):
        raise InvalidValue("motion", "needs one row of joint angles for each time")
    if len(t) < 2:
        raise InvalidValue("motion", f"has {len(t)} samples, but speeds need two at least")
    bad = ~np.isfinite(t) | ~np.isfinite(angles).all(axis=1)
    if bad.any():
        raise InvalidValue("motion", f"sample {int(np.argmax(bad)) + 1} holds no finite number")
    back = np.flatnonzero(np.diff(t) <= 0)
    if back.size:
        k = int(back[0])
        raise InvalidValue(
            "t", f"must rise, but goes from {t[k]:g} to {t[k + 1]:g} s at sample {k + 2}"
        )
    return Trajectory(t, angles)


@dataclass(frozen=True, eq=False)
class Passes:
    """How a motion passes its samples: once, or at a corner once for each side.

    Attributes:
        sample: index of the sample, length P.
        velocity: of the joints there, P×n [rad/s, m/s].
    """

    sample: NDArray[np.intp]
    velocity: Array


def passes(of: Trajectory) -> Passes:
    """Return the velocities with which a motion passes its samples, by central differences."""
    each = np.diff(of.q, axis=0) / np.diff(of.time)[:, None]
    before, after = np.vstack([each[:1], each]), np.vstack([each, each[-1:]])
    smooth = np.gradient(of.q, of.time, axis=0)
    larger = np.maximum(np.linalg.norm(before, axis=1), np.linalg.norm(after, axis=1))
    turns = np.linalg.norm(after - before, axis=1) > CORNER * larger
    corner, straight = np.flatnonzero(turns), np.flatnonzero(~turns)
    sample = np.concatenate([straight, corner, corner])
    velocity = np.vstack([smooth[straight], before[corner], after[corner]])
    order = np.argsort(sample, kind="stable")
    return Passes(sample[order], velocity[order])


def time_at_speeds(time: Array, factor: Array) -> float:
    """Return how long a motion takes at factors of its speed, linear in 1/factor between samples.

    Args:
        time: of the samples [s].
        factor: there, in (0, 1].
    """
    slowness = 1 / factor
    return float((np.diff(time) * (slowness[1:] + slowness[:-1]) / 2).sum())
