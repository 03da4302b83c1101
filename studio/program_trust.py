# SPDX-License-Identifier: BSD-3-Clause
"""Whether a program's worst moments keep their limits where a linear robot is not trusted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from softimpact.simulate import assess_impact
from softimpact.simulate.trust import not_trusted

from .program_run import Question, approach_at, at_point

KEPT = 1 + 1e-3
"""Share of a limit up to which it is kept: C and Python find speeds to so much."""


def doubts(
    question: Question, moments: Sequence[dict[str, Any]]
) -> tuple[list[dict[str, Any]], list[str]]:
    """Simulate the worst moments slowed down, the nonlinear robot too where that is needed.

    Returns:
        The moments with their ``linear_error``, and a line for each that then exceeds a limit.
    """
    seen, lines = [], []
    for moment in moments:
        found = assess_impact(
            at_point(question.model, moment["point"]),
            approach_at(question, moment, moment["factor"] * moment["speed"]),
            question.bodies[moment["body"]].contact,
            motors=question.ends[moment["motors"]],
            horizon=question.horizon,
            shape=question.bodies[moment["body"]].shape,
        )
        seen.append({**moment, "linear_error": found.linear_error})
        if not_trusted(found.linear_error) and found.verdict.share > KEPT:
            off = f"{100 * (found.verdict.share - 1):.0f} % of {found.verdict.binding}"
            lines.append(
                f"at {moment['t']:.4g} s '{moment['point']}' is beyond its limit by {off}, says "
                "the nonlinear robot; factors near there are too high by as much"
            )
    return seen, lines
