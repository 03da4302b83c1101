# SPDX-License-Identifier: BSD-3-Clause
"""Nothing was solved: why, and what comes nearest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..bounds import Bound
from ..evaluation import kept
from ..posture.tip_pose import tip_pose, tip_pose_error
from ..solver_options import FEASIBLE
from ..study.study import Study
from ..units import figure_in_words
from .solve import Outcome, preference
from .stiffest import Stiffest


class SolverFailure(Exception):
    """No start of a study was solved.

    Attributes:
        outcomes: of all starts.
        best: the feasible one of least force; if there is none, the one of least violation.
    """

    exit_code = 3

    def __init__(self, outcomes: Sequence[Outcome], study: Study | None = None) -> None:
        """Return the failure of some searches; of a study, what the best of them misses is told."""
        self.outcomes = tuple(outcomes)
        self.best = min(outcomes, key=preference)
        statuses = ", ".join(self.statuses)
        super().__init__(
            f"none of {len(outcomes)} starts was solved (Ipopt: {statuses}); "
            f"{_in_words(self.best, study)}"
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
    def of(
        least: Stiffest,
        ends: Sequence[tuple[Bound, float]],
        poses: Sequence[str],
        at: Sequence[str],
        *,
        margin: float = 0.0,
        free: bool,
    ) -> Infeasible:
        """Return the failure of bounds that cannot be kept.

        Args:
            least: the design that comes nearest to the first of them.
            ends: bounds, none of which could be left out, each with the best figure there is while
                the others are kept.
            poses: names of those in which they cannot be kept.
            at: limits of the hardware and the joints that hold the design back.
            margin: share by which springs may miss their stiffness.
            free: whether the posture was sought as well.
        """
        by = "hardware and posture" if free else "hardware"
        where = ("pose " if len(poses) == 1 else "poses ") + ", ".join(f"'{p}'" for p in poses)
        conflicts = (
            *(b.name for b, _ in ends),
            *at,
            *(f"the pose of the tip in '{p}'" for p in poses),
        )
        side = {"most": "below", "least": "above"}
        asked = " and ".join(
            f"{b.name} {side[b.sense]} {figure_in_words(b.limit, b.unit)}" for b, _ in ends
        )
        reached = "; ".join(
            f"the {'least' if b.sense == 'most' else 'largest'} that can be reached is "
            f"{figure_in_words(figure, b.unit)}" + (f" of {b.name}" if len(ends) > 1 else "")
            for b, figure in ends
        )
        kept = " while the other is kept" if len(ends) == 2 else " while the others are kept"
        reached += kept if len(ends) > 1 else ""
        if any(each.startswith("stiffness") for each in at):  # else any springs do
            springs = ", ".join(f"{k:.0f}" for k in least.springs)
            reached += f", with k_s = [{springs}] N·m/rad"
        if margin:
            reached += f", each spring off by up to {100 * margin:g} %"
        change = [*(b.name for b, _ in ends), *at, *(["accuracy.margin"] if margin else [])]
        if not at:
            change.append("the pose, or let more of the hardware change")
        return Infeasible(
            f"no {by} keeps {asked} in {where}: {reached}; change {' or '.join(change)}",
            least,
            conflicts,
        )


def _in_words(best: Outcome, study: Study | None) -> str:
    angles = ", ".join(f"{angle:.4f}" for angle in best.q)
    springs = ", ".join(f"{k:.0f}" for k in best.springs)
    found = f"{best.force:.1f} N at q = [{angles}] rad with k_s = [{springs}] N·m/rad"
    if best.violation <= FEASIBLE:
        return f"the best feasible point, from {best.name}, has a peak force of {found}"
    missed = f"misses by a share of {best.violation:.2g}" if study is None else _missed(best, study)
    return f"no point found is feasible: the nearest, from {best.name}, {missed} and has {found}"


def _missed(best: Outcome, study: Study) -> str:
    """Return what an outcome misses: each bound in its own unit, and the tip's pose."""
    others = best.others if best.others.size else None
    missed = [
        f"has {figure_in_words(each.figure, each.unit)} of {each.name}, at {each.sense} "
        f"{figure_in_words(each.limit, each.unit)},"
        for each in kept(study, best.q, best.springs, others)
        if each.share > 1 + FEASIBLE
    ]
    if best.mode == "free":
        task = tip_pose(study.model, study.task_pose.q)
        error = np.array(tip_pose_error(study.model, best.q, *task)).ravel()
        away, turned = np.linalg.norm(error[:3]), np.linalg.norm(error[3:])
        if max(away, turned) > FEASIBLE:
            missed.append(f"holds the tip {1e3 * away:.3g} mm and {turned:.2g} rad off the task,")
    return " ".join(missed) or f"misses by a share of {best.violation:.2g}"


class Unavailable(Exception):
    """No springs of a catalogue keep the bounds.

    Attributes:
        bound: that the best of them still breaks.
        share: of its limit that it uses.
    """

    exit_code = 3

    def __init__(self, bound: str, share: float) -> None:
        self.bound, self.share = bound, share
        super().__init__(
            "hardware.catalogue: no combination of its springs that was tried keeps all bounds; "
            f"the nearest uses {share:.3g} times {bound}; add springs, stiffer ones above all, or "
            "change that bound"
        )
