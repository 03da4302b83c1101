# SPDX-License-Identifier: BSD-3-Clause
"""One posture held, at one accuracy after another; runs in a worker process."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from softimpact.symbolic.robot.rigid import Array

from ..search.ipopt import Instance, Nlp, VariableBounds
from ..search.nlp import Program
from ..search.solve import Outcome, Start, better, preference, solve
from ..search.stiffest import Stiffest


@dataclass(frozen=True, eq=False)
class Level:
    """An accuracy: the largest deflection allowed [m], and the NLP with it."""

    bound: float
    numbers: Instance


def sweep(
    program: Program, name: str, end: Stiffest, bounds: VariableBounds, levels: Sequence[Level]
) -> list[Outcome]:
    """Search the springs of a held posture at each accuracy, from its neighbour's.

    There from the stiffest design to softer ones, and back from the softest springs, so that a
    branch of optima lost on the one way is found on the other.

    Args:
        program: the NLP.
        name: of the pose.
        end: the posture and its stiffest design.
        bounds: on the variables.
        levels: the stiffest first; all within reach of the posture.
    """

    def searched(level: Level, springs: Array) -> Outcome:
        nlp = Nlp(program, level.numbers, bounds)
        return solve(nlp, Start(name, "table", ((end.q, springs),)))

    springs, bound, there = end.springs, end.deflection, []
    for level in levels:
        outcome = searched(level, rescaled(springs, bound, level.bound, bounds))
        if outcome.solved:
            springs, bound = outcome.springs, level.bound
        there.append(outcome)
    springs, bound, best = bounds.springs_lower, levels[-1].bound, []
    for level, first in zip(reversed(levels), reversed(there), strict=True):
        outcome = searched(level, rescaled(springs, bound, level.bound, bounds))
        known = min(first, outcome, key=preference)
        if known.solved:
            springs, bound = known.springs, level.bound
        best.append(better(first, outcome))
    return best[::-1]


def rescaled(springs: Array, bound: float, wanted: float, bounds: VariableBounds) -> Array:
    """Return springs that give way by ``wanted`` where these give way by ``bound`` [m]."""
    return np.clip(springs * (bound / wanted), bounds.springs_lower, bounds.springs_upper)
