# SPDX-License-Identifier: BSD-3-Clause
"""The speed at which an impact reaches a force limit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import exp, inf, log

import numpy as np

from softimpact.symbolic import Contact, ImpactModel, InvalidValue
from softimpact.symbolic.impact.chain import ChainEnd

from .approach import Approach, arrival_of
from .controller import Controller
from .history import Fidelity, PeakDefinition
from .impact import simulate_impact
from .simulator import SimulationFailed

ACCURACY = 1e-8
"""Relative error of the force at the speed found."""

STEPS = 100
"""Most simulations for one speed; five or so suffice where the force is smooth."""


def largest_safe_speed(
    model: ImpactModel,
    approach: Approach,
    contact: Contact,
    limit: float,
    fidelity: Fidelity = "linearised",
    definition: PeakDefinition = "first_contact",
    *,
    order: int = 3,
    end: ChainEnd | None = None,
    controller: Controller | None = None,
    tolerance: float = 1e-10,
) -> float:
    """Return the speed [m/s] at which the peak force is the limit.

    The largest force grows with speed. ``first_peak`` need not: where growing speed parts two
    merged peaks, it drops. Its speed is sought above that of ``first_contact``, up to which it
    keeps the limit too. Where it jumps past the limit, the speed just below the jump is returned.

    Args:
        model: the robot and its contact point.
        approach: how it arrives; its speed is the first guess.
        contact: what it hits.
        limit: of the peak force [N].
        fidelity: as in ``simulate_impact``.
        definition: of the peak.
        order: as in ``simulate_impact``.
        end: as in ``simulate_impact``.
        controller: as in ``simulate_impact``.
        tolerance: as in ``simulate_impact``.

    Raises:
        InvalidValue: a limit that is not positive, and as ``simulate_impact`` does.
    """
    if not 0 < limit < np.inf:
        raise InvalidValue("limit", f"must be finite and greater than 0 N, not {limit}")

    def excess(definition: PeakDefinition, log_speed: float) -> float:
        at_speed = replace(approach, speed=exp(log_speed))
        history = simulate_impact(
            model,
            at_speed,
            contact,
            fidelity,
            order=order,
            end=end,
            controller=controller,
            tolerance=tolerance,
        )
        return log(history.peak(definition) / limit)

    start = _root(partial(excess, "first_contact"), log(arrival_of(model, approach).speed))
    if definition == "first_contact":
        return exp(start)
    return exp(_root(partial(excess, definition), start))


def _root(excess: Callable[[float], float], guess: float) -> float:
    """Root of a growing function whose slope is near one: secants, bisection where they stray."""
    low, high = -inf, inf
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
