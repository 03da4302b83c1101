# SPDX-License-Identifier: BSD-3-Clause
"""What an optimum of one posture means: prices of its bounds, and which numbers matter."""

from __future__ import annotations

from dataclasses import dataclass, replace

from softimpact.symbolic.robot.rigid import Array

from .answers import Price, indifferent_ranges, prices_of, worth_of
from .evaluation import keeps_bounds
from .search.ipopt import Found, Instance
from .search.problem import Problem, peak_force
from .search.solve import Outcome


@dataclass(frozen=True, eq=False)
class Meaning:
    """What an optimum means.

    Attributes:
        prices: what each binding bound costs.
        indifferent: range of each value of the hardware that costs less than 0.5 %, the others
            held, as many rows as ``study.range`` has names.
    """

    prices: tuple[Price, ...]
    indifferent: Array


def meaning(
    problem: Problem,
    outcome: Outcome,
    instance: Instance,
    again: Found,
    max_deflection: float | None = None,
) -> Meaning:
    """Return what an optimum means.

    Args:
        problem: of the study.
        outcome: the optimum.
        instance: the NLP that it solves.
        again: Ipopt, begun at the optimum, for its multipliers.
        max_deflection: bound on the deflection instead of the study's [m].
    """
    study, program, limits = problem.study, problem.program, problem.bounds
    if max_deflection is not None:
        study = replace(study, max_deflection=max_deflection)

    def force(v: Array) -> float:
        parted = limits.parted(v)
        return peak_force(study, program.impacts[0], problem.timing, outcome.q, *parted)

    def keeps(v: Array) -> bool:
        return keeps_bounds(study, outcome.q, *limits.parted(v))

    v = limits.vector(outcome.springs, outcome.others)
    worth = worth_of(study, float(instance.units[0]))
    return Meaning(
        prices_of(study, instance, again, worth, program),
        indifferent_ranges(limits, v, force, keeps),
    )
