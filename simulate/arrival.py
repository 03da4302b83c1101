# SPDX-License-Identifier: BSD-3-Clause
"""How a robot arrives at an impact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from softimpact.symbolic import (
    ImpactModel,
    InvalidValue,
    approach_velocity,
    require_closed_at,
    unit_direction,
)
from softimpact.symbolic.impact.approach import REACHED
from softimpact.symbolic.robot.rigid import Array

from .history import require_speed


@dataclass(frozen=True, eq=False)
class Approach:
    """A configuration and a velocity at first touch.

    Attributes:
        q: link angles, one a joint [rad, m]; they close the robot's loops.
        direction: n, along which the contact point moves into the body, length 3.
        speed: of the contact point along n [m/s].
        link_velocity: joint velocities per 1 m/s of speed, length n (in a closed chain, of its
            independent joints); None takes those of least norm that move the contact point along n
            alone.
    """

    q: Array
    direction: Array
    speed: float
    link_velocity: Array | None = None

    def __init__(
        self,
        q: ArrayLike,
        direction: ArrayLike,
        speed: float,
        link_velocity: ArrayLike | None = None,
    ) -> None:
        known = None if link_velocity is None else np.asarray(link_velocity, dtype=float)
        fields = {"q": np.asarray(q, dtype=float), "direction": np.asarray(direction, dtype=float)}
        vars(self).update(fields, speed=speed, link_velocity=known)


@dataclass(frozen=True, eq=False)
class Arrival:
    """An approach that fits a robot: ``direction`` has length 1 and the link velocity is known."""

    q: Array
    direction: Array
    speed: float
    link_velocity: Array


def arrival_of(model: ImpactModel, approach: Approach) -> Arrival:
    """Return a checked approach.

    Raises:
        InvalidValue: a number that is not finite, a speed ≤ 0, a direction of length 0, or a link
            velocity that does not move the contact point by 1 m/s along n.
        WrongLength: q or link_velocity does not fit the robot.
        SingularDirection: the contact point cannot move along n.
        LoopCannotClose: a loop is open at q.
    """
    q = _finite("q", model.robot.vector("q", approach.q))
    require_closed_at(model.robot, q)
    n = unit_direction(approach.direction)
    require_speed(approach.speed)
    if approach.link_velocity is None:
        velocity = approach_velocity(model, q, n)
    else:
        velocity = _finite("link_velocity", model.vector("link_velocity", approach.link_velocity))
    reached = float(n @ np.array(model.jacobian(q)) @ velocity)
    if abs(reached - 1) > REACHED:
        raise InvalidValue(
            "link_velocity", f"must move the contact point by 1 m/s along n, not by {reached:.6g}"
        )
    return Arrival(q, n, float(approach.speed), velocity)


def _finite(field: str, vector: Array) -> Array:
    if not np.isfinite(vector).all():
        raise InvalidValue(field, "must hold finite numbers")
    return vector
