# SPDX-License-Identifier: BSD-3-Clause
"""Nothing was solved: why, and what comes nearest."""

from __future__ import annotations

from collections.abc import Sequence

from .solve import FEASIBLE, Outcome, preference
from .stiffest import Stiffest
from .study import Study


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


class Infeasible(Exception):
    """No design can keep the bounds, whatever the force.

    Attributes:
        least: the most accurate design there is.
        conflicts: bounds that cannot be kept together, of which each is needed for that.
    """

    exit_code = 3

    def __init__(self, message: str, least: Stiffest, conflicts: Sequence[str]) -> None:
        self.least = least
        self.conflicts = tuple(conflicts)
        super().__init__(message)

    @staticmethod
    def of(study: Study, least: Stiffest, pose: str, *, free: bool) -> Infeasible:
        """Return the failure of springs that are too soft for the accuracy wanted.

        Args:
            study: what was asked.
            least: the design of least deflection.
            pose: where that is.
            free: whether the posture was sought as well.
        """
        by = "springs and posture" if free else "springs"
        stiff = least.springs >= study.upper * (1 - 1e-3)
        names = [n for n, s in zip(study.robot.joint_names, stiff, strict=True) if s]
        at = f"stiffness.upper of {', '.join(names)}" if names else "stiffness"
        conflicts = ("accuracy.max_deflection", at, f"the pose of the tip in '{pose}'")
        return Infeasible(
            f"no {by} keep the deflection below {1e3 * study.max_deflection:.4g} mm in pose "
            f"'{pose}': the least that can be reached is {1e3 * least.deflection:.4g} mm, with "
            f"k_s = [{', '.join(f'{k:.0f}' for k in least.springs)}] N·m/rad; raise "
            f"accuracy.max_deflection or {at}",
            least,
            conflicts,
        )


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
