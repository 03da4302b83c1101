# SPDX-License-Identifier: BSD-3-Clause
"""The speed up to which every impact keeps its force limits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import exp, inf, log

import numpy as np

from softimpact.symbolic import Contact, ImpactModel, InvalidValue, Motors
from softimpact.symbolic.impact.chain import ChainEnd
from softimpact.symbolic.impact.motors import refuse_held

from .arrival import Approach, arrival_of
from .controller import Controller
from .history import HORIZON, Fidelity, ImpactHistory, PeakDefinition
from .impact import simulate_impact
from .many import many_peaks
from .simulator import SimulationFailed

ACCURACY = 1e-8
"""Relative error of the force at the speed found."""

STEPS = 100
"""Most simulations for one speed; five or so suffice where the force is smooth."""

SLOWEST, SPEEDS = 0.02, 48
"""Share of a speed found down to which slower ones are tried, and how many of them."""

OFF = 2e-3
"""Relative error that forces of many impacts at once may have, of which a few are then simulated
by SUNDIALS."""


@dataclass(frozen=True)
class ForceLimits:
    """Forces that an impact must keep [N]; infinite where there is none.

    Attributes:
        transient: of the peak.
        quasi_static: of what still presses on a clamped body after ``HORIZON``.
    """

    transient: float
    quasi_static: float = inf


def largest_safe_speed(
    model: ImpactModel,
    approach: Approach,
    contact: Contact,
    limit: float | ForceLimits,
    fidelity: Fidelity = "linearised",
    definition: PeakDefinition = "peak",
    *,
    motors: Motors | Controller | None = None,
    horizon: float = HORIZON,
    order: int = 3,
    end: ChainEnd | None = None,
    tolerance: float = 1e-10,
) -> float:
    """Return the largest speed [m/s] such that at all speeds up to it the force keeps its limit.

    The largest force over all contacts grows with speed but for rare impacts, the others need not:
    slower impacts are looked at too. Where a force jumps past the limit, the speed just below the
    jump is returned.

    Args:
        model: the robot and its contact point.
        approach: how it arrives; its speed is the first guess.
        contact: what it hits.
        limit: of the peak force [N], or of the pressing force too.
        fidelity: as in ``simulate_impact``.
        definition: of the peak.
        motors: as in ``simulate_impact``.
        horizon: as in ``simulate_impact``.
        order: as in ``simulate_impact``.
        end: as in ``simulate_impact``.
        tolerance: as in ``simulate_impact``.

    Raises:
        InvalidValue: a limit that is not positive, motors that are held, and as
            ``simulate_impact`` does.
    """
    limits = limit if isinstance(limit, ForceLimits) else ForceLimits(limit)
    for value in (limits.transient, limits.quasi_static):
        if not value > 0 or (value == inf and limits.transient == inf):
            raise InvalidValue("limit", f"must be finite and greater than 0 N, not {value}")
    if isinstance(motors, Motors):
        refuse_held(motors, "a safe speed")
    pressed = contact.clamped and limits.quasi_static < inf

    def excess(log_speed: float) -> float:
        at_speed = replace(approach, speed=exp(log_speed))
        history = simulate_impact(
            model,
            at_speed,
            contact,
            fidelity,
            motors=motors,
            horizon=horizon if definition == "peak" or pressed else None,
            order=order,
            end=end,
            tolerance=tolerance,
        )
        return log(share_of_limit(history, limits, definition))

    found = _root(excess, log(arrival_of(model, approach).speed))
    lumped = fidelity in ("one_mass", "two_mass")
    if isinstance(motors, Controller) or lumped:
        return exp(found)
    for _ in range(STEPS):
        slower = _slower_violation(
            model, replace(approach, speed=exp(found)), contact, limits, definition, motors, horizon
        )
        if slower is None or not excess(log(slower)) > 0:
            return exp(found)
        found = _root(excess, log(slower), highest=log(slower))
    raise SimulationFailed("the peak force does not settle with speed")


def share_of_limit(
    history: ImpactHistory, limits: ForceLimits, definition: PeakDefinition
) -> float:
    """Return the larger of peak and pressing force, each over its limit."""
    pressing = history.pressing or 0.0
    return max(history.force_of(definition) / limits.transient, pressing / limits.quasi_static)


def _slower_violation(
    model: ImpactModel,
    approach: Approach,
    contact: Contact,
    limits: ForceLimits,
    definition: PeakDefinition,
    motors: Motors | None,
    horizon: float,
) -> float | None:
    """Return the slowest of some speeds below the approach's at which the force is too large."""
    speeds = approach.speed * np.geomspace(SLOWEST, 1, SPEEDS, endpoint=False)
    found = many_peaks(model, approach, contact, speeds, motors=motors, horizon=horizon)
    force = getattr(found, definition)
    share = np.maximum(force / limits.transient, found.pressing / limits.quasi_static)
    above = np.flatnonzero(share > 1 + OFF)
    return float(speeds[above[0]]) if above.size else None


def _root(excess: Callable[[float], float], guess: float, highest: float = inf) -> float:
    """Root of a growing function whose slope is near one: secants, bisection where they stray."""
    low, high = -inf, highest
    at, slope, before = guess, 1.0, None
    for _ in range(STEPS):
        value = excess(at)
        if abs(value) < ACCURACY:
            return at
        low, high = (at, high) if value < 0 else (low, at)
        if high - low < ACCURACY:
            return low
        if before is not None:
            slope = min(max((value - before[1]) / (at - before[0]), 0.5), 2.0)
        before = (at, value)
        at -= value / slope
        if not low < at < high:
            at = (low + high) / 2
    raise SimulationFailed("the peak force does not settle with speed")
