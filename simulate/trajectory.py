# SPDX-License-Identifier: BSD-3-Clause
"""A robot's motion as samples: joint angles over time, and the speeds with which it passes them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softimpact.symbolic import InvalidValue
from softimpact.symbolic.robot.rigid import Array

from .history import FASTEST

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


def trajectory(time: ArrayLike, q: ArrayLike, first: int = 0) -> Trajectory:
    """Return a checked motion.

    Args:
        time: of the samples [s].
        q: joint angles, S×n [rad, m].
        first: number of the first sample, for messages.

    Raises:
        InvalidValue: fewer than two samples, times that do not rise, numbers that are not finite,
            joints faster than any, or shapes that do not fit.
    """
    t, angles = np.asarray(time, dtype=float), np.asarray(q, dtype=float)
    if t.ndim != 1 or angles.ndim != 2 or len(t) != len(angles):
        raise InvalidValue("motion", "needs one row of joint angles for each time")
    if len(t) < 2:
        raise InvalidValue("motion", f"speeds need two samples at least, not {len(t)}")
    bad = ~np.isfinite(t) | ~np.isfinite(angles).all(axis=1)
    if bad.any():
        raise InvalidValue(
            "motion", f"sample {first + int(np.argmax(bad)) + 1} holds no finite number"
        )
    back = np.flatnonzero(np.diff(t) <= 0)
    if back.size:
        k = int(back[0])
        raise InvalidValue(
            "t", f"must rise, but goes from {t[k]:g} to {t[k + 1]:g} s at sample {first + k + 2}"
        )
    far = abs(np.diff(angles, axis=0)).max(axis=1, initial=0.0)
    fast = np.flatnonzero(far > FASTEST * np.diff(t))
    if fast.size:
        raise InvalidValue(
            "motion",
            f"a joint moves faster than {FASTEST:g} rad/s or m/s to sample {first + fast[0] + 2}: "
            "times are to be in seconds",
        )
    return Trajectory(t, angles)


@dataclass(frozen=True, eq=False)
class Passes:
    """How a motion passes its samples: once, or at a corner once for each side.

    Attributes:
        sample: index of the sample, length P.
        time: of it [s].
        q: joint angles there, P×n [rad, m].
        velocity: of the joints there, P×n [rad/s, m/s].
        step: time to the farther one of the samples beside it [s].
    """

    sample: NDArray[np.intp]
    time: Array
    q: Array
    velocity: Array
    step: Array

    def taken(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> Passes:
        """Return some of them."""
        return Passes(*(values[rows] for values in vars(self).values()))


def passes(of: Trajectory, first: int = 0) -> Passes:
    """Return the velocities with which a motion passes its samples, by central differences.

    Args:
        of: the motion.
        first: number of its first sample.
    """
    span = np.diff(of.time)
    each = np.diff(of.q, axis=0) / span[:, None]
    before, after = np.vstack([each[:1], each]), np.vstack([each, each[-1:]])
    smooth = np.gradient(of.q, of.time, axis=0)
    larger = np.maximum(np.linalg.norm(before, axis=1), np.linalg.norm(after, axis=1))
    turns = np.linalg.norm(after - before, axis=1) > CORNER * larger
    corner, straight = np.flatnonzero(turns), np.flatnonzero(~turns)
    sample = np.concatenate([straight, corner, corner])
    velocity = np.vstack([smooth[straight], before[corner], after[corner]])
    order = np.argsort(sample, kind="stable")
    at = sample[order]
    step = np.maximum(np.append(0.0, span), np.append(span, 0.0))
    return Passes(at + first, of.time[at], of.q[at], velocity[order], step[at])


def passes_of_parts(parts: Iterable[Trajectory]) -> Iterator[Passes]:
    """Yield the passes of a motion that comes in parts, as ``passes`` of the whole has them.

    Args:
        parts: consecutive, of any length, unchecked.

    Raises:
        InvalidValue: as ``trajectory``, over all parts.
    """
    held, first, begun = Trajectory(np.zeros(0), np.zeros((0, 0))), 0, False
    for part in parts:
        if len(held.time) > 2:
            found = passes(trajectory(held.time, held.q, first), first)
            last = first + len(held.time) - 1
            yield found.taken((found.sample < last) & ((found.sample > first) | ~np.bool_(begun)))
            first, begun = last - 1, True
            held = Trajectory(held.time[-2:], held.q[-2:])
        held = Trajectory(
            np.append(held.time, part.time),
            np.vstack([held.q.reshape(-1, part.q.shape[1]), part.q]),
        )
    found = passes(trajectory(held.time, held.q, first), first)
    yield found.taken((found.sample > first) | ~np.bool_(begun))


def time_at_speeds(time: Array, factor: Array) -> float:
    """Return how long a motion takes at factors of its speed, linear in 1/factor between samples.

    Args:
        time: of the samples [s].
        factor: there, in (0, 1].
    """
    slowness = 1 / factor
    return float((np.diff(time) * (slowness[1:] + slowness[:-1]) / 2).sum())
