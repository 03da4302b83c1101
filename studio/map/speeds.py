# SPDX-License-Identifier: BSD-3-Clause
"""The safe speeds of a map: by linear models, the slowest by the nonlinear robot too."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from softimpact.simulate import Approach
from softimpact.simulate.assessment import force_limits
from softimpact.simulate.sampled import SampledImpacts, Samples
from softimpact.simulate.sampled_speeds import safe_speeds
from softimpact.simulate.trust import nonlinear_safe_speed
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    Motors,
    SingularDirection,
    approach_velocity,
    limits_of,
)
from softimpact.symbolic.robot.rigid import Array

FASTER = 1.4
"""Factor on the C package's safe speed from which on the right one is sought."""

DOUBLINGS = 6
"""Times that a speed which is still safe is doubled; faster ones count as this fast."""

SLOWEST_ASKED = 10
"""Postures, the slowest ones, at which the nonlinear robot is asked where the linear may be off."""


def map_samples(
    model: ImpactModel, postures: Array, directions: Array, guess: Array | None
) -> tuple[Samples, NDArray[np.intp]]:
    """Return the impacts that can be, and their rows."""
    rows, rates = [], []
    for k, (q, n) in enumerate(zip(postures, directions, strict=True)):
        if guess is not None and not np.isfinite(guess[k]):
            continue
        try:
            rates.append(approach_velocity(model, q, n))
        except SingularDirection:
            continue
        rows.append(k)
    at = np.array(rows, dtype=np.intp)
    return Samples(postures[at], directions[at], np.array(rates)), at


def map_speeds(
    model: ImpactModel,
    at: Samples,
    guess: Array,
    body: Contact,
    ends: Mapping[str, Motors],
    speed: float,
    horizon: float,
) -> tuple[Array, NDArray[np.str_], NDArray[np.str_], Array]:
    """Return safe speeds, at which motors and by which limit, and the peaks at a speed."""
    count = len(at)
    best, peak = np.full(count, np.inf), np.zeros(count)
    which, limit = np.full(count, "", "U8"), np.full(count, "", "U32")
    for kind, motors in ends.items():
        forces = SampledImpacts(model, at, body, motors, horizon).peaks(np.full(count, speed))
        peak = np.maximum(peak, forces.peak)
        tried = FASTER * guess
        open_, own = np.arange(count), np.full(count, np.inf)
        for _ in range(DOUBLINGS):  # until none of them is safe any more
            found = safe_speeds(model, at.taken(open_), tried[open_], body, motors, horizon)
            own[open_] = np.minimum(found.safe, tried[open_])
            better = own[open_] < best[open_]
            limit[open_[better]] = found.limit[better]
            open_ = open_[np.isinf(found.safe)]
            if not open_.size:
                break
            tried[open_] *= 2
        which[own < best] = kind
        best = np.minimum(best, own)
    return best, which, limit, peak


def lowered_slowest(
    model: ImpactModel,
    at: Samples,
    safe: Array,
    body: Contact,
    ends: Mapping[str, Motors],
    horizon: float,
) -> tuple[Array, list[str]]:
    """Return safe speeds, the slowest no faster than the nonlinear robot allows, and what to say.

    Args:
        model: the robot.
        at: the impacts, length N.
        safe: their speeds by the linear model, length N [m/s].
        body: that is hit.
        ends: what the motors may do.
        horizon: up to which forces count [s].
    """
    allowed = force_limits(limits_of(body.region, body.clamped))
    slowest = np.argsort(safe)[:SLOWEST_ASKED]
    lowered = safe.copy()
    for k in slowest:
        q, n, rate = at.q[k], at.direction[k], at.link_velocity[k]
        for motors in ends.values():
            approach = Approach(q, n, lowered[k], rate)
            run = {"horizon": horizon}
            lowered[k], _ = nonlinear_safe_speed(model, approach, body, allowed, motors, run)
    less = 1 - lowered / safe
    if not less.any():
        return lowered, []
    line = (
        f"at {np.count_nonzero(less)} of the {len(slowest)} slowest postures the nonlinear robot "
        f"allows less, by up to {100 * less.max():.2g} %, and counts; others rest on the linear one"
    )
    return lowered, [line]
