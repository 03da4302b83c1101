# SPDX-License-Identifier: BSD-3-Clause
"""Pareto fronts, each point checked by simulation and given the speed that is safe."""

from __future__ import annotations

from dataclasses import dataclass

from softimpact.optimize import Front, Pareto, ParetoPoint, Study
from softimpact.optimize.front.front import knee
from softimpact.optimize.running.workers import Progress

from ..design.checks import Check, checked, safe_speed

FRONTS = ("free", "given", "task")
"""Fronts that are checked: posture free, best of the given ones, and the task's own."""


@dataclass(frozen=True, eq=False)
class CheckedFrontPoint:
    """A design on a front.

    Attributes:
        point: as the optimiser has it.
        check: its force by independent simulation.
        safe_speed: at which its force is the region's limit [m/s].
    """

    point: ParetoPoint
    check: Check
    safe_speed: float


@dataclass(frozen=True, eq=False)
class ParetoReport:
    """Fronts of a study.

    Attributes:
        pareto: what the optimiser found.
        fronts: points by front, one of ``FRONTS``, the most accurate first.
        reference_speed: at which the reference meets the limit [m/s].
    """

    pareto: Pareto
    fronts: dict[str, tuple[CheckedFrontPoint, ...]]
    reference_speed: float

    @property
    def study(self) -> Study:
        """The problem."""
        return self.pareto.study

    @property
    def limit(self) -> float:
        """Force limit of the body region [N]."""
        return self.study.limit

    def knee(self, front: str) -> int | None:
        """Return the number of a front's knee, None where it has none."""
        return knee([checked.point for checked in self.fronts[front]])

    def at(self, front: str, level: float) -> CheckedFrontPoint | None:
        """Return the point that was sought with a bound [m], None if another beats it."""
        return next((p for p in self.fronts[front] if p.point.bound == level), None)

    def within(self, front: str, deflection: float) -> CheckedFrontPoint | None:
        """Return the point of least force that gives way by no more than a deflection [m]."""
        kept = [p for p in self.fronts[front] if p.point.deflection <= deflection * (1 + 1e-5)]
        return kept[-1] if kept else None


def price_of_deflection(point: ParetoPoint) -> float:
    """Return what a tenth more of the bound on the deflection buys [N]; zero where none binds."""
    prices = () if point.meaning is None else point.meaning.prices
    return sum(p.gain for p in prices if p.bound == "accuracy.max_deflection")


def pareto_report(pareto: Pareto, on_progress: Progress) -> ParetoReport:
    """Simulate the fronts' points and find the speeds that meet the limit."""
    fronts: dict[str, Front] = {
        "free": pareto.free,
        "given": pareto.given,
        "task": pareto.task,
    }
    study, done = pareto.study, 0
    total = sum(len(front.points) for front in fronts.values())
    found: dict[str, tuple[CheckedFrontPoint, ...]] = {}
    for name, front in fronts.items():
        points = []
        for point in front.points:
            on_progress("simulation of each point", done, total)
            speed = safe_speed(study, point.outcome.q, point.outcome.springs)
            points.append(CheckedFrontPoint(point, checked(study, point.outcome), speed))
            done += 1
        found[name] = tuple(points)
    on_progress("simulation of each point", done, total)
    reference = pareto.reference
    return ParetoReport(pareto, found, safe_speed(study, reference.q, reference.springs))
