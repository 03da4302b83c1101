# SPDX-License-Identifier: BSD-3-Clause
"""How far the linear robot, on which all answers about impacts rest, may be off."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca

from softimpact.symbolic import least_velocity, linearisation_error

from .description import CFunction, Guard, Output
from .guards import fastest_arrival, movable
from .symbols import Symbols, function_over

FARTHEST_TURN = 1.0
"""Root of the sum of squares of the joints' turns [rad] up to which the error is estimated: the
mass at the contact point changes by a share that its ends tell."""


def linear_error(s: Symbols) -> CFunction:
    """Return the share of the force by which the linear robot may be off."""
    J = s.jacobian
    along = least_velocity(J, s.n)
    velocity, duration = along * s.values["speed"], s.values["duration"]
    error = linearisation_error(s.model, s.q, s.n, velocity, duration)
    output = Output("error", error, "dimensionless", "share of the force", scale=1 + error)
    turn = velocity * duration
    guards = (
        movable(s.robot, s.model.reflected_mass(s.q, s.n)),
        Guard(ca.dot(along, along), 0.0, fastest_arrival(s.model)),
        Guard(ca.dot(turn, turn), -1.0, FARTHEST_TURN**2),
    )
    summary = "Share of the force by which the linear robot may be off at an impact."
    built = function_over(s, "linear_error", summary, (output,), guards)
    return replace(built, elsewhere=(s.q + turn,))
