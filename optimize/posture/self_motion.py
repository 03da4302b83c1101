# SPDX-License-Identifier: BSD-3-Clause
"""The self-motion of a redundant arm: all postures that hold the tip where it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, InvalidValue, JointKind
from softimpact.symbolic.robot.rigid import Array

from .tip_pose import tip_pose, tip_pose_error

CORRECTIONS = 20
"""Newton steps back to the task at most."""

HELD = 1e-10
"""Pose error [m, rad] up to which the task counts as held."""

BACK_WITHIN = 0.6
"""Share of a step within which the curve counts as back where it began."""

SHORTEST_STRIDE = 1e-3
"""Share of a step below which a joint limit counts as reached."""

MOST_STRIDES = 2000
"""Steps to one side at most."""


@dataclass(frozen=True, eq=False)
class SelfMotion:
    """A curve of postures with the tip in one pose.

    Attributes:
        q: postures along the curve, K×n [rad].
        arc: length of the curve up to each, zero at the posture it was traced from, K [rad].
        closed: whether it comes back to where it began, up to full turns; else it ends at limits.
    """

    q: Array
    arc: Array
    closed: bool

    def nearest(self, q: Array) -> int:
        """Return the index of the posture nearest to q."""
        return int(np.argmin(np.linalg.norm(self.q - q, axis=1)))


def self_motion(model: ImpactModel, q: Array, step: float = 0.02) -> SelfMotion:
    """Trace the self-motion through a posture, to the joint limits on both sides.

    Args:
        model: robot with one joint more than the tip's pose needs.
        q: posture that holds the task, length n.
        step: between postures, in joint space [rad].

    Raises:
        InvalidValue: the robot has no self-motion with one parameter there.
    """
    hold = _holder(model, q)
    lower, upper = model.robot.limits
    hinges = np.array([joint.kind is JointKind.HINGE for joint in model.robot.joints])

    def allowed(x: Array) -> bool:
        return bool(((lower <= x) & (x <= upper)).all())

    def returned(x: Array) -> bool:  # full turns apart counts
        apart = np.where(hinges, np.remainder(x - q + np.pi, 2 * np.pi) - np.pi, x - q)
        return bool(np.linalg.norm(apart) < BACK_WITHIN * step)

    within = CurveEnds(allowed, returned)

    tangent = _tangent(hold(q)[1])
    forward, closed = _trace(hold, within, q, tangent, step)
    backward = [] if closed else _trace(hold, within, q, -tangent, step)[0]
    points = np.array([*reversed(backward), q, *forward])
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    arc = np.concatenate([[0.0], np.cumsum(lengths)])
    return SelfMotion(points, arc - arc[len(backward)], closed)


HeldPose = Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True)
class CurveEnds:
    """Where a curve ends.

    Attributes:
        allowed: whether a posture keeps the joint limits.
        returned: whether it is the one that the curve began with.
    """

    allowed: Callable[[Array], bool]
    returned: Callable[[Array], bool]


def _holder(model: ImpactModel, q: Array) -> HeldPose:
    """Return the pose error and its Jacobian, of the tip against where q has it."""
    position, rotation = tip_pose(model, q)
    x = ca.SX.sym("q", model.robot.n)
    error = tip_pose_error(model, x, ca.DM(position), ca.DM(rotation))
    function = ca.Function("hold", [x], [error, ca.jacobian(error, x)])

    def hold(x: Array) -> tuple[Array, Array]:
        error, jacobian = function(x)
        return np.array(error).ravel(), np.array(jacobian)

    return hold


def _tangent(jacobian: Array) -> Array:
    size, rows = jacobian.shape[1], jacobian.shape[0]
    if size != rows + 1 or np.linalg.matrix_rank(jacobian, tol=1e-6) < rows:
        raise InvalidValue(
            "q", "the robot has no self-motion with one parameter here; it needs seven joints"
        )
    return np.asarray(np.linalg.svd(jacobian)[2][-1])


def _trace(
    hold: HeldPose, bounds: CurveEnds, start: Array, tangent: Array, step: float
) -> tuple[list[Array], bool]:
    """Postures after ``start`` along a tangent, and whether they lead back to it."""
    points: list[Array] = []
    q, stride = start, step
    while len(points) < MOST_STRIDES and stride > SHORTEST_STRIDE * step:
        found = _corrected(hold, q + stride * tangent)
        if found is None or not bounds.allowed(found):
            stride /= 2
            continue
        points.append(found)
        if len(points) > 2 and bounds.returned(found):
            return points, True
        following = _tangent(hold(found)[1])
        tangent = following if following @ tangent > 0 else -following
        q = found
    return points, False


def _corrected(hold: HeldPose, q: Array) -> Array | None:
    """Return the posture beside q that holds the task."""
    for _ in range(CORRECTIONS):
        error, jacobian = hold(q)
        if abs(error).max() < HELD:
            return q
        q = q - np.linalg.pinv(jacobian) @ error
    return None
