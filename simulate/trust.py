# SPDX-License-Identifier: BSD-3-Clause
"""When a linear model is not to be trusted alone, and what the nonlinear robot says then."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import inf
from typing import Any, TypeGuard

import numpy as np

from softimpact.symbolic import Contact, ImpactModel, Motors

from .arrival import Approach
from .controller import Controller
from .full import holding_torques
from .history import ImpactHistory
from .impact import simulate_impact
from .linear_error import linear_error
from .safe_speed import ACCURACY, ForceLimits, largest_safe_speed, share_of_limit

TRUSTED = 0.1
"""Error that a linear force may have before the nonlinear robot is asked, too: what is not known of
robots and people makes for more (see ``Tolerances``)."""

NOTED = 1e-3
"""Share of a safe speed that the nonlinear robot may take away without a line about it."""

CHECKED = "the nonlinear robot was simulated, too, and the worse of both counts"


def not_trusted(error: float | None, share: float = 0.0) -> TypeGuard[float]:
    """Whether a linear model may be off by so much that the nonlinear robot is asked, too.

    Args:
        error: of the force, as a share; None where it is not known.
        share: of the limits that is used: energy, at most, goes with the force's square.
    """
    if error is None:
        return False
    return error > TRUSTED or share <= 1 < share * (1 + error) ** 2


def largest_linear_error(
    model: ImpactModel, approach: Approach, found: Mapping[str, ImpactHistory]
) -> float | None:
    """Return the share by which a linear model may be off; None where that is not known.

    It is not of closed chains, nor of joints without a motor that are not at rest, which the
    nonlinear robot would leave.
    """
    if model.robot.loops or holding_torques(model, np.asarray(approach.q, dtype=float))[1]:
        return None
    errors = []
    for history in found.values():
        if history.fidelity not in ("chain", "linearised"):
            return None
        reaction = 0.0 if history.motors is None else history.motors.reaction_time
        late = max(history.time_of_peak, reaction if reaction < inf else 0.0)
        errors.append(linear_error(model, approach, late))
    return max(errors)


def by_full_order(
    model: ImpactModel,
    approach: Approach,
    contact: Contact,
    ends: Mapping[str, Motors | Controller | None],
    horizon: float,
    tolerance: float,
) -> dict[str, ImpactHistory]:
    """Simulate the nonlinear robot at each end of what the motors may do."""
    return {
        name: simulate_impact(
            model, approach, contact, "full", motors=end, horizon=horizon, tolerance=tolerance
        )
        for name, end in ends.items()
    }


def safe_speeds(
    model: ImpactModel,
    approach: Approach,
    contact: Contact,
    allowed: ForceLimits,
    ends: Mapping[str, Motors | Controller | None],
    run: Mapping[str, Any],
) -> tuple[dict[str, float], list[str]]:
    """Return the safe speed at each end, and a line if the linear model is not to be trusted there.

    The nonlinear robot is asked at the safe speed, which may be higher than the impact's.
    """
    speeds: dict[str, float] = {}
    lines: list[str] = []
    for name, end in ends.items():
        speed = largest_safe_speed(model, approach, contact, allowed, motors=end, **run)
        at = replace(approach, speed=speed)
        speeds[name], error = nonlinear_safe_speed(model, at, contact, allowed, end, run)
        if (
            error is not None
            and not lines
            and (error > TRUSTED or speeds[name] < (1 - NOTED) * speed)
        ):
            off = f"at the safe speed the linear model may be off by {100 * error:.1f} %"
            lines.append(f"{off}: {CHECKED}")
    return speeds, lines


def nonlinear_safe_speed(
    model: ImpactModel,
    approach: Approach,
    contact: Contact,
    allowed: ForceLimits,
    end: Motors | Controller | None,
    run: Mapping[str, Any],
) -> tuple[float, float | None]:
    """Return the approach's speed if the nonlinear robot keeps its limits, else the largest it may.

    It is not asked where the linear model's error, which is returned, too, is not known.
    """
    linear = simulate_impact(model, approach, contact, motors=end, **run)
    error = largest_linear_error(model, approach, {"": linear})
    if error is None:
        return approach.speed, error
    full = {**run, "fidelity": "full"}
    history = simulate_impact(model, approach, contact, motors=end, **full)
    if share_of_limit(history, allowed, "peak") <= 1 + ACCURACY:
        return approach.speed, error
    return largest_safe_speed(model, approach, contact, allowed, motors=end, **full), error
