# SPDX-License-Identifier: BSD-3-Clause
"""Make a poor start feasible: first the posture, then the stiffness."""

from __future__ import annotations

from functools import lru_cache

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel
from softimpact.symbolic.rigid import Array

from .nlp import deflections, tip_pose_error
from .study import Study


def posture_at_pose(study: Study, q: Array, position: Array, rotation: Array) -> Array | None:
    """Return the posture nearest to q that holds the tip at a pose; None if none was found.

    Args:
        study: whose robot, tip and joint limits count.
        q: posture to start from, length n [rad].
        position: of the tip, length 3 [m].
        rotation: of the tip, 3×3.
    """
    solver = _posture_solver(study.model)
    lower, upper = study.robot.limits
    pose = np.concatenate([position, rotation.ravel(order="F")])
    p = np.concatenate([q, pose])
    found = solver(x0=q, p=p, lbx=lower, ubx=upper, lbg=0, ubg=0)
    return np.array(found["x"]).ravel() if solver.stats()["success"] else None


@lru_cache(maxsize=8)
def _posture_solver(model: ImpactModel) -> ca.Function:
    n = model.robot.n
    q, wanted = ca.SX.sym("q", n), ca.SX.sym("wanted", n)
    position, rotation = ca.SX.sym("position", 3), ca.SX.sym("rotation", 3, 3)
    problem = {
        "x": q,
        "p": ca.vertcat(wanted, position, ca.vec(rotation)),
        "f": ca.sumsqr(q - wanted),
        "g": tip_pose_error(model, q, position, rotation),
    }
    ipopt = {"print_level": 0, "sb": "yes", "tol": 1e-9}
    options = {"ipopt": ipopt, "print_time": False, "error_on_fail": False}
    return ca.nlpsol("posture", "ipopt", problem, options)


def accurate_springs(study: Study, q: Array, springs: Array) -> Array:
    """Return springs stiff enough for the study's deflection bound, as far as its bounds allow.

    All joints are stiffened by the same factor; those that reach their upper bound stay there.

    Args:
        study: whose forces and bounds count.
        q: posture, length n [rad].
        springs: to start from, length n [N·m/rad].
    """
    stiffened = np.clip(springs, study.lower, study.upper)
    for _ in range(2 * study.robot.n):
        share = largest_deflection(study, q, stiffened) / study.max_deflection
        if share <= 1.0 or np.all(stiffened >= study.upper):
            break
        stiffened = np.minimum(stiffened * share * 1.001, study.upper)
    return stiffened


def largest_deflection(study: Study, q: Array, springs: Array) -> float:
    """Return the tip's largest displacement under the study's forces [m]."""
    moved = np.array(
        _deflection_function(study.model, len(study.forces))(q, springs, study.forces.T)
    )
    return float(np.linalg.norm(moved, axis=0).max())


@lru_cache(maxsize=8)
def _deflection_function(model: ImpactModel, wrenches: int) -> ca.Function:
    q, springs = ca.SX.sym("q", model.robot.n), ca.SX.sym("k_s", model.robot.n)
    forces = ca.SX.sym("forces", 3, wrenches)
    moved = deflections(model, q, springs, forces)
    return ca.Function("deflections", [q, springs, forces], [moved])
