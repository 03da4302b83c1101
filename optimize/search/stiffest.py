# SPDX-License-Identifier: BSD-3-Clause
"""The most accurate design: springs, and posture, of least deflection."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel
from softimpact.symbolic.robot.rigid import Array

from ..bounds import Deflection
from ..evaluation import largest_deflection
from ..machine.hardware import Hardware
from ..machine.machine import Machine
from ..machine.postures import posture_limits
from ..machine.springs import sprung
from ..posture.tip_pose import posture_equations, posture_error, tip_pose
from ..solver_options import quiet
from ..study.study import Study
from .solve import Mode


@dataclass(frozen=True, eq=False)
class Stiffest:
    """How accurate springs within their bounds can be.

    Attributes:
        q: posture, length n [rad].
        springs: stiffness of each spring [N·m/rad].
        deflection: largest of the tip under the study's forces [m].
    """

    q: Array
    springs: Array
    deflection: float


def stiffest(study: Study, q: Array, mode: Mode) -> Stiffest:
    """Return the design of least deflection, the stiffest springs if Ipopt finds none better.

    The stiffest springs need not be it: deflections of several joints can cancel in part.

    Args:
        study: whose forces, stiffness bounds and task count.
        q: posture that is held (table), or that the search starts from (free), length n [rad].
        mode: table or free.
    """
    n, held = study.robot.n, mode == "table"
    lower, upper = posture_limits(study.model)
    unit = largest_deflection(study, q, study.upper)
    position, rotation = tip_pose(study.model, study.task_pose.q)
    free_pose = np.full(posture_equations(study.model), np.inf if held else 0.0)
    least = np.concatenate([q if held else lower, np.log10(study.lower), [0.0]])
    most = np.concatenate([q if held else upper, np.log10(study.upper), [np.inf]])
    deflection = replace(study.deflection, most=1.0)
    solver = _solver(study.model, deflection, study.margin)
    loads = len(study.forces)
    found = solver(
        x0=np.concatenate([q, np.log10(study.upper), [1.0]]),
        p=np.concatenate([position, rotation.ravel(order="F"), [unit]]),
        lbx=least,
        ubx=most,
        lbg=np.concatenate([-free_pose, np.full(loads, -np.inf)]),
        ubg=np.concatenate([free_pose, np.zeros(loads)]),
    )
    x = np.clip(np.array(found["x"]).ravel(), least, most)
    design = Stiffest(x[:n], 10 ** x[n:-1], largest_deflection(study, x[:n], 10 ** x[n:-1]))
    if solver.stats()["success"] and design.deflection < unit:
        return design
    return Stiffest(q, study.upper, unit)


@lru_cache(maxsize=8)
def _solver(model: ImpactModel, deflection: Deflection, margin: float) -> ca.Function:
    """Ipopt on min t with (deflection/unit)² ≤ t under each load."""
    n = model.robot.n
    q, s = ca.SX.sym("q", n), ca.SX.sym("s", len(sprung(model)))
    t, unit = ca.SX.sym("t"), ca.SX.sym("unit")
    position, rotation = ca.SX.sym("position", 3), ca.SX.sym("rotation", 3, 3)
    hardware = replace(Hardware.of(model), springs=10**s)
    machine = Machine.of(model, hardware, margin=margin)
    squares = (deflection.figures(machine, q) / unit) ** 2
    problem: dict[str, Any] = {
        "x": ca.vertcat(q, s, t),
        "p": ca.vertcat(position, ca.vec(rotation), unit),
        "f": t,
        "g": ca.vertcat(posture_error(model, q, position, rotation), squares - t),
    }
    return ca.nlpsol("stiffest", "ipopt", problem, quiet({"tol": 1e-8}))
