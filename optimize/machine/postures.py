# SPDX-License-Identifier: BSD-3-Clause
"""Which postures a robot can take: what no motor moves stays, and loops stay closed."""

from __future__ import annotations

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, Loop, Matrix, loop_gaps, loop_jacobian
from softimpact.symbolic.robot.rigid import Array


def held(model: ImpactModel) -> tuple[int, ...]:
    """Return the joints that no posture moves: free ones without a motor."""
    return tuple(i for i in model.independent if not model.robot.actuated[i])


def freedom(model: ImpactModel) -> int:
    """Return how many joints a posture can choose for itself: those with motors."""
    return len(model.independent) - len(held(model))


def posture_limits(model: ImpactModel) -> tuple[Array, Array]:
    """Return lower and upper limits of a posture; passive joints stay where springs are unbent."""
    lower, upper = (np.array(end) for end in model.robot.limits)
    for i in held(model):
        lower[i] = upper[i] = model.robot.joints[i].spring_reference
    return lower, upper


def closure(model: ImpactModel, q: Matrix) -> Matrix:
    """Return how far loops and couplings are from being kept; nothing of an open arm."""
    return loop_gaps(model.robot, q) if model.robot.loops else ca.DM(0, 1)


def equations(model: ImpactModel) -> int:
    """Return how many numbers ``closure`` has."""
    return model.robot.n - len(model.independent)


def side_function(model: ImpactModel) -> ca.Function | None:
    """Return q -> a number that is zero at dead points of loops, None without any.

    Two ways to assemble a chain differ in its sign: a robot cannot get from the one to the other.
    """
    if not any(isinstance(loop, Loop) for loop in model.robot.loops):
        return None
    q = ca.SX.sym("q", model.robot.n)
    follow = [i for i in range(model.robot.n) if i not in model.independent]
    return ca.Function("side", [q], [ca.det(loop_jacobian(model.robot, q)[:, follow])])


def turns_with_first(model: ImpactModel) -> bool:
    """Return whether all of a robot turns with its first joint, which no loop ties."""
    robot = model.robot
    tied = set().union(*(robot.moved_by(loop) for loop in robot.loops))
    whole = all(0 in robot.ancestors(i) for i in range(robot.n))
    return whole and 0 not in tied and robot.actuated[0]
