# SPDX-License-Identifier: BSD-3-Clause
"""The co-design problem as a nonlinear program: least worst force over postures and stiffness.

Variables are h = log10 k_s of each group of joints, the link angles q of each posture, and F. F is
minimised over its epigraph: each peak of each impact, over the force that counts as one there, is
at most F. Each posture holds its tip's pose and keeps the bounds on hardware, such as the springs'
deflection. Impacts are simulated inside the constraints (``impact_forces``): there are no states.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, Matrix, contact_point_jacobian, frame_pose
from softimpact.symbolic.robot.rigid import Array

from .impact_program import NUMBERS, ImpactProgram
from .peaks import WINDOWS
from .study import Study

HALF_TURN = 1e-12
"""Keeps the pose error of a tip turned by exactly half a turn finite, and from vanishing there."""

POSE = 6
"""Equations that a pose of the tip stands for; an arm of fewer joints has no posture to choose."""


@dataclass(frozen=True)
class Program:
    """The functions of a study's NLPs, which a process can load.

    Attributes:
        impacts: one for each contact point.
        task: serialised (x, b) -> the tip's pose error and the bounds' rows (at most zero), and
            its derivative by x = [q, log10 k_s].
        n: number of joints.
        rows: of the task.
        size: of its numbers b.
    """

    impacts: tuple[ImpactProgram, ...]
    task: str
    n: int
    rows: int
    size: int

    @property
    def library(self) -> bool:
        """Whether the impacts run as machine code."""
        return all(impact.library is not None for impact in self.impacts)


@dataclass(frozen=True)
class Shape:
    """Which variables and impacts an NLP has.

    Attributes:
        groups: of each joint, length n: joints of the same group share their stiffness.
        postures: number of them.
        impacts: posture and contact point of each, by place.
    """

    groups: tuple[int, ...]
    postures: int
    impacts: tuple[tuple[int, int], ...]

    @property
    def springs(self) -> int:
        """Number of stiffness variables."""
        return max(self.groups) + 1

    @property
    def sharing(self) -> Array:
        """Matrix from the groups' log10 k_s to the joints', n×groups."""
        return np.eye(self.springs)[list(self.groups)]


def tip_pose_error(model: ImpactModel, q: Matrix, position: Matrix, rotation: Matrix) -> Matrix:
    """Return the tip's pose error, length 6: position [m] and 2 sin(angle/2) about its axis [rad].

    The half angle matters: the sine of the whole angle also vanishes for a tip turned round.
    """
    pose = frame_pose(model.robot, model.tip, q)
    E = ca.mtimes(rotation.T, pose.rotation)
    sine = ca.vertcat(E[2, 1] - E[1, 2], E[0, 2] - E[2, 0], E[1, 0] - E[0, 1])
    square = ca.fmax(1 + ca.trace(E), 0) + HALF_TURN  # 4 cos²(angle/2)
    return ca.vertcat(pose.position - position, sine / ca.sqrt(square) + HALF_TURN / square)


def deflections(model: ImpactModel, q: Matrix, springs: Matrix, forces: Matrix) -> Matrix:
    """Return the tip's displacements by the springs alone, 3×k [m], under forces 3×k [N].

    The motors hold their positions, so that K⁻¹ = J k_s⁻¹ Jᵀ.
    """
    J = contact_point_jacobian(model.robot, model.tip, q)
    return ca.mtimes(J, ca.mtimes(J.T, forces) / ca.repmat(springs, 1, forces.shape[1]))


def task_function(model: ImpactModel, wrenches: int) -> ca.Function:
    """Return (x, b) -> (rows, their derivative by x); b as ``task_numbers`` has it."""
    n = model.robot.n
    x, b = ca.SX.sym("x", 2 * n), ca.SX.sym("b", 13 + 3 * wrenches)
    q, s = ca.vertsplit(x, n)
    position, rotation, bound, forces = ca.vertsplit(b, [0, 3, 12, 13, b.numel()])
    moved = deflections(model, q, 10**s, ca.reshape(forces, 3, wrenches))
    error = tip_pose_error(model, q, position, ca.reshape(rotation, 3, 3))
    rows = ca.vertcat(error, ca.sum1(moved**2).T / bound**2 - 1)
    outputs = ca.cse([rows, ca.densify(ca.jacobian(rows, x))])
    return ca.Function("task", [x, b], outputs)


def task_numbers(study: Study, position: Array, rotation: Array) -> Array:
    """Return what a posture must do, as numbers.

    Args:
        study: whose forces and bound count.
        position: where the tip is held, length 3 [m].
        rotation: how the tip is held, 3×3.
    """
    pose = np.concatenate([position, rotation.ravel(order="F")])
    return np.concatenate([pose, [study.max_deflection], study.forces.ravel()])


def problem_functions(program: Program, shape: Shape) -> dict[str, ca.Function]:
    """Return the NLP's functions by the names of CasADi's ``nlpsol``, with their derivatives.

    Parameters are each posture's numbers b, then each impact's: its own, the force that counts as
    one [N], and the boundary of its windows.
    """
    n, G, K, C = program.n, shape.springs, shape.postures, len(shape.impacts)
    x = ca.MX.sym("x", G + K * n + 1)
    p = ca.MX.sym("p", K * program.size + C * (NUMBERS + 2))
    h, *postures, peak = ca.vertsplit(x, [0, *(G + n * k for k in range(K + 1)), G + K * n + 1])
    cuts = [program.size * k for k in range(K)]
    cuts += [program.size * K + (NUMBERS + 2) * c for c in range(C + 1)]
    given = ca.vertsplit(p, cuts)
    sharing = ca.DM(shape.sharing)
    s = ca.mtimes(sharing, h)
    task = ca.Function.deserialize(program.task)
    value, slope = [], []

    def placed(by_x: Matrix, k: int, by_peak: float) -> Matrix:
        """Put a derivative by q and s of one posture into a row of all variables."""
        rows = by_x.shape[0]
        return ca.horzcat(
            ca.mtimes(by_x[:, n:], sharing),
            ca.DM(rows, n * k),
            by_x[:, :n],
            ca.DM(rows, n * (K - 1 - k)),
            ca.DM.ones(rows, 1) * by_peak if by_peak else ca.DM(rows, 1),
        )

    for k, q in enumerate(postures):
        rows, by_x = task(ca.vertcat(q, s), given[k])
        value.append(rows)
        slope.append(placed(by_x, k, 0.0))
    for c, (k, point) in enumerate(shape.impacts):
        numbers, unit, boundary = ca.vertsplit(given[K + c], [0, NUMBERS, NUMBERS + 1, NUMBERS + 2])
        at = ca.vertcat(postures[k], s), numbers, boundary
        value.append(program.impacts[point]["peaks"](*at) / unit - peak)
        by_x = program.impacts[point]["slopes"](*at)[1]
        slope.append(placed(by_x / unit, k, -1.0))
    g, J = ca.vertcat(*value), ca.vertcat(*slope)
    slope_of_peak = ca.densify(ca.jacobian(peak, x)).T
    return {
        "grad_f": ca.Function("nlp_grad_f", [x, p], [peak, slope_of_peak]),
        "nlp": ca.Function("nlp", [x, p], [peak, g], ["x", "p"], ["f", "g"]),
        "jac_g": ca.Function("nlp_jac_g", [x, p], [g, J], ["x", "p"], ["g", "jac_g_x"]),
    }


def nlp_solver(program: Program, shape: Shape, options: dict[str, Any]) -> ca.Function:
    """Return Ipopt on the problem."""
    functions = problem_functions(program, shape)
    x, p = (ca.MX.sym(name, functions["nlp"].numel_in(name)) for name in ("x", "p"))
    f, g = functions["nlp"](x, p)
    problem: dict[str, Any] = {"x": x, "p": p, "f": f, "g": g}
    given = {name: functions[name] for name in ("grad_f", "jac_g")}
    unasked = {"no_nlp_grad": True, "calc_lam_p": False}
    return ca.nlpsol("design", "ipopt", problem, {**options, **given, **unasked})


def peak_rows(program: Program, shape: Shape) -> slice:
    """Entries of g that are peaks less F: ``WINDOWS`` for each impact."""
    begin = shape.postures * program.rows
    return slice(begin, begin + WINDOWS * len(shape.impacts))
