# SPDX-License-Identifier: BSD-3-Clause
"""Configurations of robots in which some joints follow others by a coupling."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InvalidValue
from ..robot.constraints import Coupling
from ..robot.rigid import Array
from ..robot.robot import Robot, vector_of

APART = 1e-6
"""How far [rad, m] a given coordinate may be from the one that a coupling makes of the others."""


def own_joints(robot: Robot) -> tuple[str, ...]:
    """Return the names of the joints that follow from no coupling, in the order of q."""
    return tuple(name for name in robot.joint_names if name not in robot.followers)


def whole_configuration(robot: Robot, values: ArrayLike, field: str = "q") -> Array:
    """Return q with one entry a joint, from one with or without entries for joints that follow.

    Args:
        robot: any robot.
        values: coordinates of the joints that follow from no coupling, or of all joints.
        field: what the values are, for messages.

    Raises:
        WrongLength: there are neither as many as the one nor as the other.
        InvalidValue: a joint that follows is given where its coupling does not put it.
    """
    followers = robot.followers
    if not followers or np.size(values) == robot.n:
        q = robot.vector(field, values)
        _require_coupled(robot, q, field)
        return q
    known = dict(zip(own_joints(robot), vector_of(own_joints(robot), field, values), strict=True))
    couplings = [loop for loop in robot.loops if isinstance(loop, Coupling) and loop.follower]
    for _ in couplings:  # a follower may lead others
        for coupling in couplings:
            if all(name in known for name, _ in coupling.leading):
                known[str(coupling.follower)] = float(coupling.follow(known.__getitem__))
    return np.array([known[name] for name in robot.joint_names])


def _require_coupled(robot: Robot, q: Array, field: str) -> None:
    given = dict(zip(robot.joint_names, q.tolist(), strict=True))
    for loop in robot.loops:
        if isinstance(loop, Coupling) and loop.follower:
            wanted = float(loop.follow(given.__getitem__))
            if not abs(given[loop.follower] - wanted) <= APART * max(1.0, abs(wanted)):
                leaders = ", ".join(f"'{name}'" for name, _ in loop.leading)
                raise InvalidValue(
                    field,
                    f"joint '{loop.follower}' follows {leaders} and is then at {wanted:g}, not "
                    f"{given[loop.follower]:g}; leave it out",
                )
