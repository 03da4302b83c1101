# SPDX-License-Identifier: BSD-3-Clause
"""The co-design problem as a nonlinear program: an objective over hardware and postures.

Variables are v, the log10 of the hardware's values, the link angles q of each posture, and the
objective's own, such as F, the largest force over what counts as one. Each peak of each impact is
at most what the objective allows. Each posture holds its tip's pose and keeps the bounds. Impacts
are simulated inside the constraints (``impact_forces``): there are no states.

Variables, bounds and objectives are stacked here and known nowhere else.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from softimpact.symbolic import Matrix
from softimpact.symbolic.matrices import MatrixExpression
from softimpact.symbolic.robot.rigid import Array, Indices

from ..bounds import row
from ..evaluation import equipped
from ..impact.impact_program import NUMBERS, SIZES, ImpactProgram, Parts
from ..impact.peaks import WINDOWS
from ..machine.hardware import Hardware
from ..machine.machine import Machine
from ..objectives import Objective, WorstForce
from ..posture.tip_pose import posture_error
from ..study.study import Study


@dataclass(frozen=True)
class Program:
    """The functions of a study's NLPs, which a process can load.

    Attributes:
        impacts: one for each contact point.
        task: serialised (x, b) -> the tip's pose error and the bounds' rows (at most zero), and
            its derivative by x = [q, v].
        hardware: serialised v -> log10 of the parts that impacts feel, and its derivative.
        n: number of joints.
        variables: number of entries of v.
        bound_rows: number of rows of each bound.
        squares: of each row of a bound, whether it is a square less one, of a share of a limit.
        rows: of the task.
        held: of these that are zero where a posture is sought: the tip's pose, and loops.
        side: serialised q -> a number whose sign changes where loops pass a dead point; empty
            without loops.
        size: of its numbers b.
    """

    impacts: tuple[ImpactProgram, ...]
    task: str
    hardware: str
    n: int
    variables: int
    bound_rows: tuple[int, ...]
    squares: tuple[bool, ...]
    rows: int
    size: int
    held: int
    side: str = ""

    @property
    def library(self) -> bool:
        """Whether the impacts run as machine code."""
        return all(impact.library is not None for impact in self.impacts)


@dataclass(frozen=True)
class NlpShape:
    """Which postures and impacts an NLP has, and what it makes small.

    Attributes:
        postures: number of them.
        impacts: posture and contact point of each, by place.
        scenarios: number of each impact's, counted from zero on without gaps; of the impacts that
            differ in what the motors do alone it is the same.
        objective: of the search.
    """

    postures: int
    impacts: tuple[tuple[int, int], ...]
    scenarios: tuple[int, ...]
    objective: Objective = field(default_factory=WorstForce)

    @staticmethod
    def of(
        postures: int,
        impacts: Sequence[tuple[int, int]],
        scenarios: Sequence[int],
        objective: Objective,
    ) -> NlpShape:
        """Return the shape with scenarios of any numbers, counted anew."""
        numbered = {which: k for k, which in enumerate(dict.fromkeys(scenarios))}
        own = tuple(numbered[which] for which in scenarios)
        return NlpShape(postures, tuple(impacts), own, objective)


def hardware_function(study: Study, parts: Parts) -> ca.Function:
    """Return v -> log10 of the parts that impacts feel, and its derivative."""
    v = ca.SX.sym("v", study.range.lower.size)
    hardware = _hardware(study, v)
    values: dict[str, Any] = {  # parts that are not sought may be None
        "springs": hardware.springs,
        "rotors": hardware.reflected_rotors,
        "masses": hardware.masses,
        "cover": hardware.cover,
        "beside": hardware.beside,
    }
    y = ca.vertcat(*[ca.log10(values[part]) for part in parts if part != "speed"])
    return ca.Function("hardware", [v], [y, ca.densify(ca.jacobian(y, v))])


def _hardware(study: Study, v: Matrix) -> Hardware:
    """Return the hardware of v; the springs come first in it."""
    springs = max(study.groups) + 1
    own, values = study.variables[0], 10**v
    return equipped(
        study, own.apply(Hardware.of(study.model), values[:springs]).springs, values[springs:]
    )


@lru_cache(maxsize=8)
def task_function(study: Study) -> tuple[ca.Function, tuple[int, ...]]:
    """Return (x, b) -> (rows, their derivative by x), and how many rows each bound has.

    The first rows are ``posture_error``.

    x is [q, v], and b as ``task_numbers`` has it.
    """
    n, bounds = study.robot.n, study.bounds
    x = ca.SX.sym("x", n + study.range.lower.size)
    b = ca.SX.sym("b", 12 + len(bounds))
    position, rotation, limits = ca.vertsplit(b, [0, 3, 12, b.numel()])
    q, v = ca.vertsplit(x, [0, n, x.numel()])
    machine = Machine.of(study.model, _hardware(study, v), study.motions, study.margin)
    error = posture_error(study.model, q, position, ca.reshape(rotation, 3, 3))
    kept = [row(b.sense, b.figures(machine, q), limits[i]) for i, b in enumerate(bounds)]
    rows = ca.vertcat(error, *kept)
    task = ca.Function("task", [x, b], ca.cse([rows, ca.densify(ca.jacobian(rows, x))]))
    return task, tuple(each.numel() for each in kept)


def task_numbers(study: Study, position: Array, rotation: Array) -> Array:
    """Return what a posture must do, as numbers.

    Args:
        study: whose bounds count.
        position: where the tip is held, length 3 [m].
        rotation: how the tip is held, 3×3.
    """
    limits = [bound.limit for bound in study.bounds]
    return np.concatenate([position, rotation.ravel(order="F"), limits])


def problem_functions(program: Program, shape: NlpShape) -> dict[str, ca.Function]:
    """Return the NLP's functions by the names of CasADi's ``nlpsol``, with their derivatives.

    Parameters are each posture's numbers b, then each impact's: its own, the force that counts as
    one [N], and the boundary of its windows.
    """
    n, V, K, C = program.n, program.variables, shape.postures, len(shape.impacts)
    of, scenarios = shape.objective, np.array(shape.scenarios)
    O = of.own(scenarios, np.ones(C), np.ones(C)).lower.size  # noqa: E741 - as K and C
    x = ca.MX.sym("x", V + K * n + O)
    p = ca.MX.sym("p", K * program.size + C * (NUMBERS + 2))
    v, *postures, own = ca.vertsplit(x, [0, *(V + n * k for k in range(K + 1)), V + K * n + O])
    cuts = [program.size * k for k in range(K)]
    cuts += [program.size * K + (NUMBERS + 2) * c for c in range(C + 1)]
    given = ca.vertsplit(p, cuts)
    y, by_v = ca.Function.deserialize(program.hardware)(v)
    task = ca.Function.deserialize(program.task)
    levels, speeds, *by_own = _allowed(of, scenarios, O)(own)
    value, slope = [], []

    def placed(of_v: Matrix, of_q: Matrix, k: int, of_own: Matrix) -> MatrixExpression:
        """Put a derivative by v, q of one posture and own into a row of all variables."""
        rows = of_v.shape[0]
        before, after = ca.DM(rows, n * k), ca.DM(rows, n * (K - 1 - k))
        return ca.horzcat(of_v, before, of_q, after, of_own)

    for k, q in enumerate(postures):
        rows, by_x = task(ca.vertcat(q, v), given[k])
        value.append(rows)
        slope.append(placed(by_x[:, n:], by_x[:, :n], k, ca.DM(program.rows, O)))
    for c, (k, point) in enumerate(shape.impacts):
        numbers, unit, boundary = ca.vertsplit(given[K + c], [0, NUMBERS, NUMBERS + 1, NUMBERS + 2])
        speed = [speeds[c]] if of.scales_speed else []
        at = ca.vertcat(postures[k], y, *speed), numbers, boundary
        value.append(program.impacts[point]["peaks"](*at) / unit - levels[c])
        by_x = program.impacts[point]["slopes"](*at)[1] / unit
        of_own = -ca.repmat(by_own[0][c, :], WINDOWS, 1)
        if of.scales_speed:
            of_own = of_own + ca.mtimes(by_x[:, -1], by_own[1][c, :])
        springs = by_x[:, n : n + y.numel()]
        slope.append(placed(ca.mtimes(springs, by_v), by_x[:, :n], k, of_own))
    g, J = ca.vertcat(*value), ca.vertcat(*slope)
    at_speed = ca.vertcat(*[given[K + c][SPEED] for c in range(C)])
    cost: MatrixExpression = of.cost(own, scenarios, at_speed)
    slope_of_cost = ca.densify(ca.jacobian(cost, x)).T
    return {
        "f": ca.Function("nlp_f", [x, p], [cost], ["x", "p"], ["f"]),
        "g": ca.Function("nlp_g", [x, p], [g], ["x", "p"], ["g"]),
        "grad_f": ca.Function("nlp_grad_f", [x, p], [cost, slope_of_cost]),
        "jac_g": ca.Function("nlp_jac_g", [x, p], [g, J], ["x", "p"], ["g", "jac_g_x"]),
    }


def _allowed(of: Objective, scenarios: Indices, size: int) -> ca.Function:
    """Return own -> levels, log10 of the factors on speeds, and the derivatives of both."""
    own = ca.SX.sym("own", size)
    both = ca.SX(of.levels(own, scenarios)), ca.SX(of.speeds(own, scenarios))
    slopes = (ca.densify(ca.jacobian(each, own)) for each in both)
    return ca.Function("allowed", [own], [*map(ca.densify, both), *slopes])


SPEED = list(SIZES).index("speed") + SIZES["direction"] - 1
"""Place of the speed among an impact's numbers."""


def nlp_solver(program: Program, shape: NlpShape, options: dict[str, Any]) -> ca.Function:
    """Return Ipopt on the problem."""
    functions = problem_functions(program, shape)
    x, p = (ca.MX.sym(name, functions["g"].numel_in(name)) for name in ("x", "p"))
    problem: dict[str, Any] = {
        "x": x,
        "p": p,
        "f": functions["f"](x, p),
        "g": functions["g"](x, p),
    }
    given = {name: functions[name] for name in ("grad_f", "jac_g")}
    unasked = {"no_nlp_grad": True, "calc_lam_p": False}
    return ca.nlpsol("design", "ipopt", problem, {**options, **given, **unasked})


def peak_rows(program: Program, shape: NlpShape) -> slice:
    """Entries of g that are peaks less F: ``WINDOWS`` for each impact."""
    begin = shape.postures * program.rows
    return slice(begin, begin + WINDOWS * len(shape.impacts))
