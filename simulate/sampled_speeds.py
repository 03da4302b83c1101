# SPDX-License-Identifier: BSD-3-Clause
"""Largest safe speeds of many impacts at once, each at a speed that it has."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic import Contact, ImpactModel, Motors, limits_of
from softimpact.symbolic.body.verdict import Limits
from softimpact.symbolic.robot.rigid import Array

from .history import HORIZON
from .sampled import AT_ONCE, SampledImpacts, Samples

MARGIN = 3e-3
"""Share of a limit that is kept free, as forces of many impacts are right to 2e-3."""

CLOSE = 1e-3
"""Share of a limit within which a speed is found."""

ROUNDS = 12
"""Most evaluations for one speed; three or four suffice where the force is smooth."""

SLOWER = (1.0, 0.75, 0.5, 0.25)
"""Shares of the first guess of a safe speed at which it is checked that none slower is worse."""

SLOPES = (0.3, 3.0)
"""Least and most powers of the speed with which a force may grow for a secant to be trusted."""

NOTHING = 1e-12
"""Share of a limit that counts as none."""


@dataclass(frozen=True, eq=False)
class SafeSpeeds:
    """What many impacts do at their speeds, and how fast they may be; one entry each.

    Attributes:
        safe: largest speeds up to which all limits are kept [m/s]; infinite where the impact's own
            speed is safe.
        limit: that is reached first; ``transient force``, for example.
        peak: force at the impact's own speed [N].
        share: how much of the limits that uses; above 1 they are exceeded.
    """

    safe: Array
    limit: NDArray[np.str_]
    peak: Array
    share: Array


class _Shares:
    """How much of the limits impacts use."""

    def __init__(
        self,
        model: ImpactModel,
        at: Samples,
        body: Contact,
        limits: Limits,
        motors: Motors,
        horizon: float,
    ) -> None:
        self.impacts, self.limits = SampledImpacts(model, at, body, motors, horizon), limits

    def __call__(self, speeds: Array) -> tuple[Array, NDArray[np.intp], Array]:
        """Return the larger share, whether it is the transient or the other one, and the peak."""
        found = self.impacts.peaks(speeds)
        shares = [found.peak / self.limits.transient.force]
        if self.limits.quasi_static is not None:
            shares.append(found.pressing / self.limits.quasi_static.force)
        both = np.array(shares)
        return both.max(axis=0), both.argmax(axis=0), found.peak


def safe_speeds(
    model: ImpactModel,
    at: Samples,
    speeds: Array,
    body: Contact,
    motors: Motors,
    horizon: float = HORIZON,
    limits: Limits | None = None,
    seen: Callable[[int], None] = lambda count: None,
) -> SafeSpeeds:
    """Return how fast many impacts may be.

    The first guess is that forces grow with the speed; it is tried together with slower ones.

    Args:
        model: the robot.
        at: postures and directions.
        speeds: of the impacts [m/s].
        body: that they hit.
        motors: what they do.
        horizon: up to which the largest force counts [s].
        limits: of the body; default what it may bear where nothing is known of the robot's shape.
        seen: called with the number of impacts that were looked at, every few thousand.
    """
    parts = []
    limits = limits or limits_of(body.region, body.clamped)
    for first in range(0, max(len(at), 1), AT_ONCE):
        rows = np.arange(first, min(first + AT_ONCE, len(at)))
        parts.append(
            _safe_speeds(model, at.taken(rows), speeds[rows], body, limits, motors, horizon)
        )
        seen(len(rows))
    return SafeSpeeds(
        *(
            np.concatenate([vars(part)[field.name] for part in parts])
            for field in fields(SafeSpeeds)
        )
    )


def _safe_speeds(
    model: ImpactModel,
    at: Samples,
    speeds: Array,
    body: Contact,
    limits: Limits,
    motors: Motors,
    horizon: float,
) -> SafeSpeeds:
    pressing = "force" if limits.quasi_static is None else limits.quasi_static.quantity
    names = np.array([f"transient {limits.transient.quantity}", f"quasi-static {pressing}"])
    share, which, peak = _Shares(model, at, body, limits, motors, horizon)(speeds)
    safe = np.full(len(share), np.inf)
    rows = np.flatnonzero(share > 1 - MARGIN)
    if rows.size:
        tried = (speeds[rows] * (1 - MARGIN) / share[rows]) * np.array(SLOWER)[:, None]
        many = at.taken(np.tile(rows, len(SLOWER)))
        shares, _, _ = _Shares(model, many, body, limits, motors, horizon)(tried.ravel())
        known = np.vstack([share[rows], shares.reshape(tried.shape)])
        one = _Shares(model, at.taken(rows), body, limits, motors, horizon)
        safe[rows], which[rows] = _root(one, np.vstack([speeds[rows], tried]), known)
    return SafeSpeeds(safe, names[which], peak, share)


def _root(shares: _Shares, speeds: Array, known: Array) -> tuple[Array, NDArray[np.intp]]:
    """Return the largest speeds up to which the share of the limits stays below one.

    Args:
        shares: at any speeds.
        speeds: at which it is known, fastest first, K×S.
        known: what it is there.
    """
    x, y = np.log(speeds), np.log(np.maximum(known, NOTHING)) - np.log(1 - MARGIN)
    columns = np.arange(x.shape[1])
    slowest_bad = len(x) - 1 - (y > 0)[::-1].argmax(axis=0)  # the fastest always is
    a, b = x[slowest_bad, columns], y[slowest_bad, columns]
    below = np.minimum(slowest_bad + 1, len(x) - 1)
    has_low = slowest_bad + 1 < len(x)
    high, low = a, np.where(has_low, x[below, columns], -np.inf)
    near = np.where(has_low, (b - y[below, columns]) / np.where(has_low, a - low, 1.0), 1.0)
    slope, which = np.clip(near, *SLOPES), np.zeros(len(columns), dtype=np.intp)
    for _ in range(ROUNDS):
        new = a - b / slope
        new = np.where(
            (new > low) & (new < high), new, np.where(low > -np.inf, (low + high) / 2, new)
        )
        share, which, _ = shares(np.exp(new))
        value = np.log(np.maximum(share, NOTHING)) - np.log(1 - MARGIN)
        step = np.where(new == a, 1.0, new - a)
        slope = np.where(new == a, slope, np.clip((value - b) / step, *SLOPES))
        a, b = new, value
        low, high = np.where(b <= 0, a, low), np.where(b > 0, a, high)
        if ((b <= 0) & (b > -CLOSE)).all():
            break
    least = np.where(low > -np.inf, low, high - np.maximum(b, 0) / SLOPES[0])
    return np.exp(least), np.asarray(which)
