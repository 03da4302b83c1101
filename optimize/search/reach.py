# SPDX-License-Identifier: BSD-3-Clause
"""Whether bounds can be kept at all, which of them conflict, and how near one can come.

All of that needs no impact, so that it is told before any search.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import casadi as ca
import numpy as np

from softimpact.symbolic.robot.rigid import Array

from ..bounds import Bound
from ..evaluation import figures, largest_deflection, largest_share
from ..posture.tip_pose import posture_equations, tip_pose
from ..solver_options import FEASIBLE, quiet
from ..study.poses import Candidate
from ..study.study import Study, limit_name
from .failure import Infeasible
from .ipopt import VariableBounds
from .nlp import task_function, task_numbers
from .stiffest import Stiffest

Member = TypeVar("Member")

IPOPT = {"hessian_approximation": "limited-memory", "max_iter": 300, "tol": 1e-8}


@dataclass(frozen=True, eq=False)
class Reach:
    """How near hardware can come to keeping some bounds in some poses.

    Attributes:
        excess: largest of the bounds' rows that are made small; at most zero where all are kept.
        v: log10 of the hardware's values.
        postures: of the poses, K×n [rad].
        holding: multipliers of the limits of v and of the postures; positive at upper ones.
    """

    excess: float
    v: Array
    postures: Array
    holding: Array


def reach(
    study: Study,
    postures: Sequence[Array],
    bounds: Sequence[Bound],
    sought: Sequence[Bound] | None = None,
    *,
    free: bool,
) -> Reach:
    """Make the largest excess of bounds small.

    Args:
        study: the robot and its variables.
        postures: that one machine must keep the bounds in, K of length n [rad].
        bounds: to look at.
        sought: those of them whose excess is made small, the others are kept; default all.
        free: whether the postures may move along their self-motion.
    """
    # of the study's own bounds there are no others, so that none counts twice
    asked = replace(study, other_bounds=tuple(b for b in bounds if b != study.deflection))
    with_deflection = any(b == study.deflection for b in bounds)
    task, rows = task_function(asked)
    limits, rows_held = VariableBounds.of(study), posture_equations(study.model)
    n, V, K = study.robot.n, limits.lower.size, len(postures)
    chosen = [with_deflection, *(True for _ in asked.other_bounds)]
    soft = [sought is None or bound in sought for bound in asked.bounds]
    x, t = ca.MX.sym("x", V + K * n), ca.MX.sym("t")
    v, *qs = ca.vertsplit(x, [0, *(V + n * k for k in range(K + 1))])
    held, poses = [], []
    for q, given in zip(qs, postures, strict=True):
        found = task(ca.vertcat(q, v), task_numbers(asked, *tip_pose(study.model, given)))[0]
        poses.append(found[:rows_held])
        pieces = ca.vertsplit(found[rows_held:], np.cumsum([0, *rows]).tolist())
        for piece, is_chosen, is_soft in zip(pieces, chosen, soft, strict=True):
            if is_chosen:
                held.append(piece - t if is_soft else piece)
    g_poses, g_held = ca.vertcat(*poses), ca.vertcat(*held)
    problem: dict[str, Any] = {
        "x": ca.vertcat(x, t),
        "f": t,
        "g": ca.vertcat(g_poses, g_held),
    }
    solver = ca.nlpsol("reach", "ipopt", problem, quiet(IPOPT))
    loose = 0.0 if free else np.inf
    flat = np.concatenate(list(postures))
    lower, upper = limits.q_lower, limits.q_upper
    least = np.concatenate([limits.lower, np.tile(lower, K) if free else flat, [-np.inf]])
    most = np.concatenate([limits.upper, np.tile(upper, K) if free else flat, [np.inf]])
    best: Reach | None = None
    for start in (limits.upper, limits.start):
        solution = solver(
            x0=np.concatenate([start, flat, [1.0]]),
            lbx=least,
            ubx=most,
            lbg=np.concatenate(
                [np.full(g_poses.numel(), -loose), np.full(g_held.numel(), -np.inf)]
            ),
            ubg=np.concatenate([np.full(g_poses.numel(), loose), np.zeros(g_held.numel())]),
        )
        end = np.clip(np.array(solution["x"]).ravel(), least, most)
        missed = np.array(solution["g"]).ravel()
        off = abs(missed[: g_poses.numel()]).max() if free else 0.0
        excess = float(end[-1] + max(missed[g_poses.numel() :].max(), 0.0))
        if off < 1e-6 and (best is None or excess < best.excess):
            holding = np.array(solution["lam_x"]).ravel()[:-1]
            best = Reach(excess, end[:V], end[V:-1].reshape(K, n), holding)
        if best is not None and best.excess <= FEASIBLE:
            break
    return best or Reach(np.inf, limits.upper, np.array(postures), np.zeros(V + K * n))


def reachable(study: Study, q: Array, *, free: bool) -> bool:
    """Return whether some hardware keeps all bounds in one posture."""
    if largest_share(study, q, study.upper) <= 1:
        return True
    return reach(study, [q], study.bounds, free=free).excess <= FEASIBLE


def require_reachable(study: Study, poses: Sequence[Candidate], *, free: bool) -> None:
    """Raise Infeasible if no hardware keeps all bounds in all poses at once."""
    if all(largest_share(study, pose.q, study.upper) <= 1 for pose in poses):
        return
    if reach(study, [pose.q for pose in poses], study.bounds, free=free).excess <= FEASIBLE:
        return
    raise infeasible(study, poses, free=free)


def infeasible(study: Study, poses: Sequence[Candidate], *, free: bool) -> Infeasible:
    """Return why no hardware keeps all bounds: a set of them of which each is needed for that."""

    def broken(some: Sequence[Candidate], bounds: Sequence[Bound]) -> bool:
        return reach(study, [p.q for p in some], bounds, free=free).excess > FEASIBLE

    alone = [pose for pose in poses if broken([pose], study.bounds)]
    some = _needed([alone[0]] if alone else poses, lambda left: broken(left, study.bounds))
    bounds = _needed(study.bounds, lambda left: broken(some, left))
    postures = [pose.q for pose in some]
    ends = []
    for bound in bounds:
        found = reach(study, postures, bounds, [bound], free=free)
        springs, others = VariableBounds.of(study).parted(found.v)
        each = [figures(bound, study, q, springs, others) for q in found.postures]
        figure = max(e.max() for e in each) if bound.sense == "most" else min(e.min() for e in each)
        ends.append((bound, float(figure), found))
    at = _holding(study, [end[2] for end in ends], free=free)
    springs, _ = VariableBounds.of(study).parted(ends[0][2].v)
    q = ends[0][2].postures[0]
    least = Stiffest(q, springs, largest_deflection(study, q, springs))
    names = [pose.pose.name for pose in some]
    return Infeasible.of(
        least, [end[:2] for end in ends], names, at, margin=study.margin, free=free
    )


def _needed(members: Iterable[Member], broken: Callable[[list[Member]], bool]) -> list[Member]:
    """Return an irreducible set: members are left out as long as what is left is still broken."""
    left = list(members)
    for member in list(left):
        without = [each for each in left if each is not member]
        if without and broken(without):
            left = without
    return left


HOLDS = 1e-4
"""Multiplier of a limit, in shares of a bound by a decade or a radian, from which it matters."""


def _holding(study: Study, found: Sequence[Reach], *, free: bool) -> tuple[str, ...]:
    """Return which limits of the hardware, and of the joints, keep designs from coming nearer."""
    V = study.range.lower.size
    kinds = [
        limit_name(study, i, end)
        for i in range(V)
        for end, sign in (("lower", -1), ("upper", 1))
        if any(sign * each.holding[i] > HOLDS for each in found)
    ]
    held = {which: [w for k, w in kinds if k == which] for which, _ in kinds}
    at = [f"{which} of {', '.join(whose)}" for which, whose in held.items()]
    if free:
        shares = np.max([abs(each.holding[V:]).reshape(-1, study.robot.n) for each in found], 0)
        limited = np.flatnonzero(shares.max(axis=0) > HOLDS)
        if limited.size:
            joints = ", ".join(study.robot.joint_names[i] for i in limited)
            at.append(f"the range of joints {joints}")
    return tuple(at)
