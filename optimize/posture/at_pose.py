# SPDX-License-Identifier: BSD-3-Clause
"""The posture nearest to a given one that holds the tip at a pose."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic import ImpactModel
from softimpact.symbolic.robot.rigid import Array

from ..machine.postures import freedom, posture_limits
from ..solver_options import quiet
from .tip_pose import POSE, posture_error

HELD = 1e-9
"""Pose error [m, rad] up to which a posture holds the tip as it is."""

FIRST_ORDER_STEPS = 12
"""Most steps to a posture nearby; poses of two digits take five."""

LEAST_SQUARE = 1e-13
"""Added to J Jᵀ, so that equations that repeat each other, of a loop in a plane, can be solved: it
moves the tip by a thousandth of ``HELD``."""

STILL = 1e-8
"""Length of a step [rad] at which a posture is where it will be."""


def posture_at_pose(model: ImpactModel, q: Array, position: Array, rotation: Array) -> Array | None:
    """Return the posture nearest to q that holds the tip at a pose; None if none was found.

    Args:
        model: robot and tip.
        q: posture to start from, length n [rad].
        position: of the tip, length 3 [m].
        rotation: of the tip, 3×3.
    """
    pose = np.concatenate([position, rotation.ravel(order="F")])
    if abs(np.array(_pose_error(model)(q, pose))).max() < HELD:
        return q
    if freedom(model) < POSE:  # Ipopt refuses what has more equations than unknowns
        return None
    solver = _posture_solver(model)
    lower, upper = posture_limits(model)
    p = np.concatenate([q, pose])
    found = solver(x0=q, p=p, lbx=lower, ubx=upper, lbg=0, ubg=0)
    return np.array(found["x"]).ravel() if solver.stats()["success"] else None


def nearest_at_pose(
    model: ImpactModel, postures: Array, position: Array, rotation: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Return what ``posture_at_pose`` does for many postures, m×n, and for which it is right.

    Each step takes the posture nearest to the given one that holds the tip to first order. Where
    that does not end soon or leaves the joints' limits, Ipopt must say.
    """
    wanted, lower, upper = postures, *posture_limits(model)
    if freedom(model) < POSE:
        return wanted, np.zeros(len(wanted), dtype=bool)
    pose = np.concatenate([position, rotation.ravel(order="F")])
    slope, q = _pose_slope(model), wanted.copy()
    held, moving = np.zeros(len(q), dtype=bool), np.arange(len(q))
    for _ in range(FIRST_ORDER_STEPS):
        if not moving.size:
            break
        poses = np.tile(pose[:, None], len(moving))
        error, jacobian = (np.array(each) for each in slope(q[moving].T, poses))
        J = jacobian.reshape(len(error), len(moving), -1).transpose(1, 0, 2)
        missed = error.T + np.einsum("mij,mj->mi", J, wanted[moving] - q[moving])
        back = J.transpose(0, 2, 1)
        shares = np.linalg.solve(J @ back + LEAST_SQUARE * np.eye(len(error)), missed[:, :, None])
        nearer = wanted[moving] - (back @ shares)[:, :, 0]
        still = abs(nearer - q[moving]).max(axis=1) < STILL
        held[moving] = still & (abs(error).max(axis=0) < HELD)
        q[moving] = np.where(held[moving, None], q[moving], nearer)
        moving = moving[~held[moving]]
    return q, held & ((q >= lower) & (q <= upper)).all(axis=1)


def held_elsewhere(
    model: ImpactModel, postures: Array, position: Array, rotation: Array
) -> NDArray[np.int64]:
    """Return the numbers of postures, m×n, that do not hold the tip at a pose."""
    pose = np.concatenate([position, rotation.ravel(order="F")])
    errors = np.array(_pose_error(model)(postures.T, np.tile(pose[:, None], len(postures))))
    return np.flatnonzero(abs(errors).max(axis=0) >= HELD)


@lru_cache(maxsize=8)
def _pose_error(model: ImpactModel) -> ca.Function:
    q = ca.SX.sym("q", model.robot.n)
    position, rotation = ca.SX.sym("position", 3), ca.SX.sym("rotation", 3, 3)
    error = posture_error(model, q, position, rotation)
    return ca.Function("error", [q, ca.vertcat(position, ca.vec(rotation))], [error])


@lru_cache(maxsize=8)
def _pose_slope(model: ImpactModel) -> ca.Function:
    q, pose = ca.SX.sym("q", model.robot.n), ca.SX.sym("pose", 12)
    error = posture_error(model, q, pose[:3], ca.reshape(pose[3:], 3, 3))
    return ca.Function("slope", [q, pose], ca.cse([error, ca.densify(ca.jacobian(error, q))]))


@lru_cache(maxsize=8)
def _posture_solver(model: ImpactModel) -> ca.Function:
    n = model.robot.n
    q, wanted = ca.SX.sym("q", n), ca.SX.sym("wanted", n)
    position, rotation = ca.SX.sym("position", 3), ca.SX.sym("rotation", 3, 3)
    problem: dict[str, Any] = {
        "x": q,
        "p": ca.vertcat(wanted, position, ca.vec(rotation)),
        "f": ca.sumsqr(q - wanted),
        "g": posture_error(model, q, position, rotation),
    }
    return ca.nlpsol("posture", "ipopt", problem, quiet({"tol": 1e-9}))
