# SPDX-License-Identifier: BSD-3-Clause
"""Bounds evaluated in numbers, apart from any search."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, reduce

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, Matrix
from softimpact.symbolic.robot.rigid import Array

from .bounds import Bound
from .machine.hardware import Hardware
from .machine.machine import Machine, TaskMotion
from .machine.springs import sprung
from .solver_options import FEASIBLE
from .study.study import Study
from .variables import Variable


@dataclass(frozen=True, eq=False)
class Kept:
    """How well a bound is kept.

    Attributes:
        name: of the bound.
        unit: of figure and limit.
        sense: which side of the limit is allowed: "most" or "least".
        figure: nearest to the limit, or furthest beyond it.
        limit: of it.
        share: of the limit that is used; above 1 it is broken.
    """

    name: str
    unit: str
    sense: str
    figure: float
    limit: float
    share: float

    @property
    def broken(self) -> bool:
        """Whether it is missed by more than Ipopt's tolerance."""
        return self.share > 1 + FEASIBLE


def equipped(study: Study, springs: Matrix, others: Matrix | None = None) -> Hardware:
    """Return a study's hardware with these springs and values of other variables."""
    return _equipped(study.model, study.other_variables, springs, others)


def _equipped(
    model: ImpactModel, variables: Sequence[Variable], springs: Matrix, others: Matrix | None
) -> Hardware:
    hardware = replace(Hardware.of(model), springs=springs)
    if not variables:
        return hardware
    ranges = [variable.range(model) for variable in variables]
    values = np.concatenate([r.start for r in ranges]) if others is None else others
    pieces = ca.vertsplit(
        ca.vertcat(values), np.cumsum([0, *(r.lower.size for r in ranges)]).tolist()
    )
    pairs = zip(variables, pieces, strict=True)
    return reduce(lambda h, pair: pair[0].apply(h, pair[1]), pairs, hardware)


def figures(
    bound: Bound, study: Study, q: Array, springs: Array, others: Array | None = None
) -> Array:
    """Return a bound's figures in a posture, in its unit; a row for each of several.

    Args:
        bound: of the study or another.
        study: robot, motions and margin.
        q: link angles, length n, or m×n [rad].
        springs: stiffness of each spring [N·m/rad].
        others: values of the study's other variables; default the machine as it is.
    """
    bound = bound.at(1.0)  # figures do not depend on limits
    motions = study.motions if bound.needs_speed else ()
    key = bound, study.model, study.other_variables, motions, study.margin
    function: ca.Function = _figures(*key)  # type: ignore[arg-type]
    size = function.numel_in(2)
    if others is None or not size:
        parts = [variable.range(study.model).start for variable in study.other_variables]
        others = np.concatenate(parts) if parts else np.empty(0)
    found = np.array(function(np.transpose(q), springs, others))
    return found.T if np.ndim(q) > 1 else found.ravel()


@lru_cache(maxsize=64)
def _figures(
    bound: Bound,
    model: ImpactModel,
    variables: tuple[Variable, ...],
    motions: tuple[TaskMotion, ...],
    margin: float,
) -> ca.Function:
    size = sum(variable.range(model).lower.size for variable in variables)
    q, springs = ca.SX.sym("q", model.robot.n), ca.SX.sym("k_s", len(sprung(model)))
    others = ca.SX.sym("others", size)
    hardware = _equipped(model, variables, springs, others)
    machine = Machine.of(model, hardware, motions, margin)
    return ca.Function("figures", [q, springs, others], [bound.figures(machine, q)])


def kept(study: Study, q: Array, springs: Array, others: Array | None = None) -> list[Kept]:
    """Return how well each bound of a study is kept in a posture, or where worst of m×n.

    Arguments as ``figures``.
    """
    return [_kept(bound, figures(bound, study, q, springs, others)) for bound in study.bounds]


def kept_in_all(
    study: Study, postures: Array, springs: Array, others: Array | None = None
) -> list[list[Kept]]:
    """Return ``kept`` of each of some postures, m×n."""
    columns = [
        [_kept(bound, row) for row in figures(bound, study, postures, springs, others)]
        for bound in study.bounds
    ]
    return [list(row) for row in zip(*columns, strict=True)]


def _kept(bound: Bound, found: Array) -> Kept:
    pick: Callable[[Array], float] = np.max if bound.sense == "most" else np.min
    figure = float(pick(found)) if found.size else (0.0 if bound.sense == "most" else np.inf)
    if bound.sense == "most":
        share = figure / bound.limit
    else:
        share = bound.limit / figure if figure > 0 else np.inf
    return Kept(bound.name, bound.unit, bound.sense, figure, bound.limit, share)


def largest_share(study: Study, q: Array, springs: Array, others: Array | None = None) -> float:
    """Return the largest share of a limit that any bound uses in a posture, or in any of m×n."""
    return max(each.share for each in kept(study, q, springs, others))


def keeps_bounds(study: Study, q: Array, springs: Array, others: Array | None = None) -> bool:
    """Return whether all bounds are kept, as nearly as searches keep them; in all postures of m×n.

    Arguments as ``figures``.
    """
    each = kept_in_all(study, np.atleast_2d(q), springs, others)
    return not any(one.broken for row in each for one in row)


def largest_deflection(
    study: Study, q: Array, springs: Array, others: Array | None = None
) -> float:
    """Return the tip's largest displacement under the study's loads, also of m×n postures [m]."""
    return float(figures(study.deflection, study, q, springs, others).max())
