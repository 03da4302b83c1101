# SPDX-License-Identifier: BSD-3-Clause
"""How far the linearised robot's forces may be off in an impact, as a number."""

from __future__ import annotations

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, InvalidValue, linearisation_error

from .arrival import Approach, arrival_of

UNSEEN = 0.005
"""Share of the force by which ``full`` may differ beyond the estimate: of 265 random impacts of
the Panda (free, servo, driven; joints up to 1.5 times their speed limits, the estimate at the
time of the peak) two differed more, and of 60 fresh ones two, on the safe side. Not by springs or
gravity that bend the robot much."""


def linear_error(model: ImpactModel, approach: Approach, duration: float) -> float:
    """Return ``linearisation_error`` of an impact: a bound on it, but for ``UNSEEN``.

    Args:
        model: the robot, without closed chains.
        approach: how it arrives.
        duration: T, from first touch to the peak, and not less than the motors' reaction time, as a
            later hit may be the harder one in truth [s].

    Raises:
        InvalidValue: a duration that is negative or not finite, a robot with closed chains, and as
            ``simulate_impact`` does.
    """
    if not 0 <= duration < np.inf:
        raise InvalidValue("duration", f"must be finite and ≥ 0 s, not {duration:g}")
    if model.robot.loops:
        raise InvalidValue("model", "has closed chains, of which the linear error is not known")
    arrival = arrival_of(model, approach)
    velocity = arrival.speed * arrival.link_velocity
    numbers = (ca.DM(x) for x in (arrival.q, arrival.direction, velocity, duration))
    return float(linearisation_error(model, *numbers))
