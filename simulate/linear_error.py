# SPDX-License-Identifier: BSD-3-Clause
"""How far the linearised robot's forces may be off, from how much the robot changes meanwhile."""

from __future__ import annotations

from functools import lru_cache

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, InvalidValue, Robot, bias_torques, frame_pose
from softimpact.symbolic.impact.impact_model import WEIGHTLESS
from softimpact.symbolic.matrices import Matrix

from .arrival import Approach, arrival_of

UNSEEN = 0.005
"""Share of the force by which ``full`` may differ beyond the estimate: of 265 random impacts of
the Panda (free, servo, driven; joints up to 1.5 times their speed limits, the estimate at the
time of the peak) two differed more, and of 60 fresh ones two, on the safe side. Not by springs or
gravity that bend the robot much."""


def linear_error(model: ImpactModel, approach: Approach, duration: float) -> float:
    """Return the share of the force by which ``linearised`` may be off, but for ``UNSEEN``.

    It is (|a| + |b|) T / 2v + |√(m_c(q0 + q̇0 T) / m_c(q0)) − 1| for a robot that moves at q̇0,
    v at its contact point, over the duration T. a = q̇0ᵀ ∂²(n·p)/∂q² q̇0 bends the path of a contact
    point whose joints keep their speed, b = a − nᵀJ M⁻¹ h(q̇0) that of links that nothing drives:
    each moves the point by a share of v T. The force goes with the root of the mass, about.

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
    n, speed = arrival.direction, arrival.speed
    rates = speed * arrival.link_velocity
    bend, coriolis = _second_order(model.robot, model.tip)(arrival.q, n, rates)
    answer = np.linalg.solve(
        np.array(model.mass_matrix(ca.DM(arrival.q))), np.array(coriolis).ravel()
    )
    kept = float(bend)
    unheld = kept - float(n @ np.array(model.jacobian(ca.DM(arrival.q))) @ answer)
    before, after = (
        float(model.reflected_mass(ca.DM(q), ca.DM(n)))
        for q in (arrival.q, arrival.q + rates * duration)
    )
    path = (abs(kept) + abs(unheld)) * duration / (2 * speed)
    return path + abs(float(np.sqrt(after / before)) - 1)


@lru_cache(maxsize=16)
def _second_order(robot: Robot, tip: str) -> Matrix:
    """Return the function (q, n, q̇) → q̇ᵀ ∂²(n·p)/∂q² q̇ and Coriolis torques h."""
    q, rate, n = ca.SX.sym("q", robot.n), ca.SX.sym("dq", robot.n), ca.SX.sym("n", 3)
    speed = ca.jtimes(ca.dot(n, frame_pose(robot, tip, q).position), q, rate)
    bend = ca.jtimes(speed, q, rate)
    return ca.Function(
        "second_order", [q, n, rate], [bend, bias_torques(robot, q, rate, WEIGHTLESS)]
    )
