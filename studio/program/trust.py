# SPDX-License-Identifier: BSD-3-Clause
"""Whether a program's moments keep their limits where a linear robot is not exact."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from softimpact.simulate.assessment import force_limits
from softimpact.simulate.trust import nonlinear_safe_speed

from .moments import Question, approach_at, at_point


def nonlinear_share(
    question: Question, moments: Sequence[dict[str, Any]]
) -> tuple[float, list[dict[str, Any]], list[str]]:
    """Ask the nonlinear robot about moments of a slowed program, where the linear one may be off.

    Returns:
        The least share of their speeds that it allows, at most 1; the moments with their
        ``linear_error``; and a line if that share is below 1.
    """
    least, seen, lines = 1.0, [], []
    run = {"horizon": question.horizon}
    for moment in moments:
        at, body = at_point(question.model, moment["point"]), question.bodies[moment["body"]]
        approach = approach_at(question, moment, moment["factor"] * moment["speed"])
        allowed = force_limits(body.limits)
        errors = []
        for motors in question.ends.values():
            safe, error = nonlinear_safe_speed(at, approach, body.contact, allowed, motors, run)
            errors += [error] if error is not None else []
            if safe < least * approach.speed:
                least = safe / approach.speed
                lines = [
                    f"all factors were lowered by {100 * (1 - least):.2g} %: so much less is safe "
                    f"for '{moment['point']}' at {moment['t']:.4g} s, says the nonlinear robot"
                ]
        seen.append({**moment, "linear_error": max(errors, default=None)})
    return least, seen, lines
