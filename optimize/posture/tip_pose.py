# SPDX-License-Identifier: BSD-3-Clause
"""Where the tip is, and how far it is from where a task holds it."""

from __future__ import annotations

from functools import lru_cache

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, Matrix, frame_pose
from softimpact.symbolic.robot.rigid import Array

from ..machine.postures import closure, equations

HALF_TURN = 1e-12
"""Keeps the pose error of a tip turned by exactly half a turn finite, and from vanishing there."""

POSE = 6
"""Equations that a pose of the tip stands for; an arm of fewer joints has no posture to choose."""


def posture_error(model: ImpactModel, q: Matrix, position: Matrix, rotation: Matrix) -> Matrix:
    """Return by how far a posture misses a pose of the tip, and closed loops: all to be zero."""
    return ca.vertcat(tip_pose_error(model, q, position, rotation), closure(model, q))


def posture_equations(model: ImpactModel) -> int:
    """Return how many numbers ``posture_error`` has."""
    return POSE + equations(model)


def tip_pose_error(model: ImpactModel, q: Matrix, position: Matrix, rotation: Matrix) -> Matrix:
    """Return the tip's pose error, length 6: position [m] and 2 sin(angle/2) about its axis [rad].

    The half angle matters: the sine of the whole angle also vanishes for a tip turned round.
    """
    pose = frame_pose(model.robot, model.tip, q)
    E = ca.mtimes(rotation.T, pose.rotation)
    sine = ca.vertcat(E[2, 1] - E[1, 2], E[0, 2] - E[2, 0], E[1, 0] - E[0, 1])
    square = ca.fmax(1 + ca.trace(E), 0) + HALF_TURN  # 4 cos²(angle/2)
    return ca.vertcat(pose.position - position, sine / ca.sqrt(square) + HALF_TURN / square)


def tip_pose(model: ImpactModel, q: Array) -> tuple[Array, Array]:
    """Return the tip's position, length 3 [m], and rotation, 3×3."""
    position, rotation = _tip_function(model)(q)
    return np.array(position).ravel(), np.array(rotation)


def tip_poses(model: ImpactModel, postures: Array) -> tuple[Array, Array]:
    """Return the tip's positions, m×3 [m], and rotations, m×3×3, of postures, m×n."""
    position, rotation = _tip_function(model)(postures.T)
    return np.array(position).T, np.array(rotation).T.reshape(-1, 3, 3).transpose(0, 2, 1)


@lru_cache(maxsize=8)
def _tip_function(model: ImpactModel) -> ca.Function:
    q = ca.SX.sym("q", model.robot.n)
    pose = frame_pose(model.robot, model.tip, q)
    return ca.Function("tip", [q], [pose.position, pose.rotation])
