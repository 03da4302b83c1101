# SPDX-License-Identifier: BSD-3-Clause
"""The posture that serves a task best by any measure, found by Ipopt."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, Matrix
from softimpact.symbolic.robot.rigid import Array

from ..impact.impact_program import impact_program
from ..impact.timing import impact_timing, study_impacts
from ..machine.postures import posture_limits
from ..posture.tip_pose import posture_error, tip_pose
from ..solver_options import quiet
from ..study.study import Study
from .ipopt import Instance, Nlp, VariableBounds, one_posture
from .nlp import task_numbers
from .problem import study_program
from .solve import Start, solve


@dataclass(frozen=True, eq=False)
class BestPosture:
    """A local optimum over postures.

    Attributes:
        q: the posture, length n [rad].
        value: of the measure there.
        status: Ipopt's.
        solved: whether a local optimum was found; if not, q is the last iterate.
    """

    q: Array
    value: float
    status: str
    solved: bool


def best_posture(
    model: ImpactModel, start: Array, measure: Callable[[Matrix], Matrix]
) -> BestPosture:
    """Minimise a measure of the posture, the tip held where the start has it.

    Args:
        model: robot and tip.
        start: posture that holds the task, length n [rad].
        measure: of the link angles (SX), to be made small; any expression of
            ``softimpact.symbolic``.
    """
    position, rotation = tip_pose(model, start)
    q = ca.SX.sym("q", model.robot.n)
    problem: dict[str, Any] = {
        "x": q,
        "f": measure(q),
        "g": posture_error(model, q, ca.DM(position), ca.DM(rotation)),
    }
    solver = ca.nlpsol("posture", "ipopt", problem, quiet({"tol": 1e-9}))
    lower, upper = posture_limits(model)
    found = solver(x0=start, lbx=lower, ubx=upper, lbg=0, ubg=0)
    stats = solver.stats()
    value, best = float(found["f"]), np.array(found["x"]).ravel()
    return BestPosture(best, value, stats["return_status"], bool(stats["success"]))


def posture_of_least_force(study: Study, start: Array) -> BestPosture:
    """Minimise the peak force over postures, with the study's nominal joint stiffness.

    Args:
        study: robot, impact and stiffness; its bound on the deflection does not count.
        start: posture that holds the task, length n [rad].
    """
    springs = study.nominal
    free = replace(study, max_deflection=1e3, lower=springs, upper=springs)
    timing = impact_timing(free, [start])
    impact = impact_program(free.model, timing.nodes, timing.substeps, compiled=False)
    impacts = study_impacts(free, timing.step)
    task = task_numbers(free, *tip_pose(free.model, start))
    shape = one_posture(len(impacts))
    instance = Instance(shape, task[None, :], impacts, np.full(len(impacts), 100.0))
    program = study_program(free, (impact,))
    nlp = Nlp(program, instance, VariableBounds.of(free))
    found = solve(nlp, Start("start", "free", ((start, springs),)))
    return BestPosture(found.q, found.force, found.status, found.solved)
