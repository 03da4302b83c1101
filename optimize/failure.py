# SPDX-License-Identifier: BSD-3-Clause
"""Nothing was solved: why, and what comes nearest."""

from __future__ import annotations

from collections.abc import Sequence

from .solve import FEASIBLE, Outcome, preference


class SolverFailure(Exception):
    """No start of a study was solved.

    Attributes:
        outcomes: of all starts.
        best: the feasible one of least force; if there is none, the one of least violation.
    """

    exit_code = 3

    def __init__(self, outcomes: Sequence[Outcome]) -> None:
        self.outcomes = tuple(outcomes)
        self.best = min(outcomes, key=preference)
        statuses = ", ".join(self.statuses)
        super().__init__(
            f"none of {len(outcomes)} starts was solved (Ipopt: {statuses}); {_in_words(self.best)}"
        )

    @property
    def statuses(self) -> list[str]:
        """Ipopt's statuses, each once."""
        return sorted({outcome.status for outcome in self.outcomes})

    @property
    def feasible(self) -> bool:
        """Whether the best point keeps all constraints."""
        return self.best.violation <= FEASIBLE


def _in_words(best: Outcome) -> str:
    angles = ", ".join(f"{angle:.4f}" for angle in best.q)
    springs = ", ".join(f"{k:.0f}" for k in best.springs)
    found = f"{best.force:.1f} N at q = [{angles}] rad with k_s = [{springs}] N·m/rad"
    if best.violation <= FEASIBLE:
        return f"the best feasible point, from {best.name}, has a peak force of {found}"
    return (
        f"no point found is feasible: the nearest, from {best.name}, violates a constraint by "
        f"{best.violation:.2g} (m or rad of the tip's pose, or the square of deflection over bound "
        f"less 1) and has {found}"
    )
