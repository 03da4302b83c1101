# SPDX-License-Identifier: BSD-3-Clause
"""Whether bounds can be kept at all, which of them conflict, and how near one can come.

All of that needs no impact, so that it is told before any search.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeVar

import casadi as ca
import numpy as np
from numpy.typing import NDArray

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
    solver = _solver(study, len(postures))
    limits, n, V, K = VariableBounds.of(study), study.robot.n, study.range.lower.size, len(postures)
    rows = task_function(study)[1]
    poses = posture_equations(study.model) * K

    def of_rows(chosen: Sequence[bool]) -> NDArray[np.bool_]:
        return np.tile(np.repeat(chosen, rows), K)

    soft = of_rows([sought is None or bound in sought for bound in study.bounds])
    ignored = ~of_rows([bound in bounds for bound in study.bounds])
    loose = 0.0 if free else np.inf
    flat = np.concatenate(list(postures))
    tasks = [task_numbers(study, *tip_pose(study.model, given)) for given in postures]
    lower, upper = limits.q_lower, limits.q_upper
    least = np.concatenate([limits.lower, np.tile(lower, K) if free else flat, [-np.inf]])
    most = np.concatenate([limits.upper, np.tile(upper, K) if free else flat, [np.inf]])
    best: Reach | None = None
    for start in (limits.upper, limits.start):
        solution = solver(
            x0=np.concatenate([start, flat, [1.0]]),
            p=np.concatenate([*tasks, soft]),
            lbx=least,
            ubx=most,
            lbg=np.concatenate([np.full(poses, -loose), np.full(soft.size, -np.inf)]),
            ubg=np.concatenate([np.full(poses, loose), np.where(ignored, np.inf, 0.0)]),
        )
        end = np.clip(solution["x"].full().ravel(), least, most)
        missed = solution["g"].full().ravel()
        off = abs(missed[:poses]).max() if free else 0.0
        excess = float(end[-1] + max(missed[poses:][~ignored].max(), 0.0))
        if off < 1e-6 and (best is None or excess < best.excess):
            holding = solution["lam_x"].full().ravel()[:-1]
            best = Reach(excess, end[:V], end[V:-1].reshape(K, n), holding)
        if best is not None and best.excess <= FEASIBLE:
            break
    return best or Reach(np.inf, limits.upper, np.array(postures), np.zeros(V + K * n))


@lru_cache(maxsize=4)
def _solver(study: Study, postures: int) -> ca.Function:
    """Return Ipopt on x = [v, postures, t], with p = [what each must do, which rows are less t].

    The constraints are the postures' equations, then the rows of all bounds in each of them.
    """
    task = task_function(study)[0]
    n, V, K, size = study.robot.n, study.range.lower.size, postures, task.numel_in(1)
    equations, count = posture_equations(study.model), task.numel_out(0)
    x = ca.MX.sym("x", V + K * n + 1)
    p = ca.MX.sym("p", K * size + K * (count - equations))
    v, *qs, t = ca.vertsplit(x, [0, *(V + n * k for k in range(K + 1)), V + K * n + 1])
    *given, soft = ca.vertsplit(p, [*(size * k for k in range(K + 1)), p.numel()])
    values, slopes = [], []
    for k, (q, b) in enumerate(zip(qs, given, strict=True)):
        value, by_x = task(ca.vertcat(q, v), b)
        values.append(value)
        before, after = ca.DM(count, n * k), ca.DM(count, n * (K - 1 - k))
        slopes.append(ca.horzcat(by_x[:, n:], before, by_x[:, :n], after))
    both = [ca.vertcat(*values), ca.vertcat(*slopes)]
    held = [k * count + i for k in range(K) for i in range(equations)]
    kept = [k * count + i for k in range(K) for i in range(equations, count)]
    g = ca.vertcat(both[0][held], both[0][kept] - soft * t)
    J = ca.vertcat(
        ca.horzcat(both[1][held, :], ca.DM(len(held), 1)), ca.horzcat(both[1][kept, :], -soft)
    )
    own: dict[str, Any] = {
        "grad_f": ca.Function("grad_f", [x, p], [t, ca.densify(ca.jacobian(t, x)).T]),
        "jac_g": ca.Function("jac_g", [x, p], [g, J], ["x", "p"], ["g", "jac_g_x"]),
        "no_nlp_grad": True,
        "calc_lam_p": False,
    }
    problem: dict[str, Any] = {"x": x, "p": p, "f": t, "g": g}
    return ca.nlpsol("reach", "ipopt", problem, {**quiet(IPOPT), **own})


def reachable(study: Study, q: Array, *, free: bool) -> bool:
    """Return whether some hardware keeps all bounds in one posture."""
    if largest_share(study, q, study.upper) <= 1:
        return True
    return reach(study, [q], study.bounds, free=free).excess <= FEASIBLE


def require_reachable(study: Study, poses: Sequence[Candidate], *, free: bool) -> None:
    """Raise Infeasible if no hardware keeps all bounds in all poses at once."""
    postures = [pose.q for pose in poses]
    if largest_share(study, np.array(postures), study.upper) <= 1:
        return
    if reach(study, postures, study.bounds, free=free).excess <= FEASIBLE:
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
