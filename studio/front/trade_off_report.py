# SPDX-License-Identifier: BSD-3-Clause
"""Fronts over two or three objectives: each point simulated, each objective as people read it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from softimpact.optimize import Study
from softimpact.optimize.front.axes import Axis
from softimpact.optimize.front.trade_off import TradeOff, TradePoint
from softimpact.optimize.running.workers import Progress
from softimpact.optimize.units import SCALES, figure_in_words

from ..design.checks import Check
from ..design.scenario_checks import checked_worst


@dataclass(frozen=True)
class View:
    """An objective as people read it.

    Attributes:
        kind: its name in study files.
        label: its name in words.
        unit: of what is shown.
        scale: shown over what the record has.
        more_is_better: whether values are to be large.
    """

    kind: str
    label: str
    unit: str
    scale: float
    more_is_better: bool

    @property
    def title(self) -> str:
        """Name and unit, for axes and columns."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    def words(self, value: float) -> str:
        """Return a value with its unit."""
        return figure_in_words(self.scale * value, self.unit)


@dataclass(frozen=True, eq=False)
class TradeOffReport:
    """A front with its checks.

    Attributes:
        found: the front.
        checks: each point's worst scenario, simulated.
        views: the objectives as they are shown.
    """

    found: TradeOff
    checks: tuple[Check, ...]
    views: tuple[View, ...]

    @property
    def study(self) -> Study:
        """The problem."""
        return self.found.study

    @property
    def points(self) -> tuple[TradePoint, ...]:
        """The designs."""
        return self.found.points

    @property
    def shown(self) -> np.ndarray:
        """Values of the points as they are shown, a row a point."""
        scales = [view.scale for view in self.views]
        return np.array([point.values for point in self.points]) * scales

    def view_of(self, place: int) -> tuple[int, View]:
        """Return the column and view of an objective: 0 is the one that was sought."""
        column = self.found.axes.order.index(place)
        return column, self.views[column]


def trade_off_report(found: TradeOff, on_progress: Progress) -> TradeOffReport:
    """Simulate each point's worst scenario."""
    checks = []
    for i, point in enumerate(found.points):
        on_progress("simulation of each point", i, len(found.points))
        checks.append(checked_worst(point))
    on_progress("simulation of each point", len(checks), len(checks))
    views = tuple(_view(found, axis) for axis in found.axes.all)
    return TradeOffReport(found, tuple(checks), views)


def _view(found: TradeOff, axis: Axis) -> View:
    """Return how an objective is shown: as a force or speed where there is one alone."""
    label, more = axis.kind.replace("_", " "), axis.more_is_better
    limits, speeds = set(found.scenarios.limits.tolist()), set(found.scenarios.speeds)
    if axis.kind == "worst_force" and len(limits) == 1:
        return View(axis.kind, label, "N", limits.pop(), more)
    if axis.kind == "safe_speed":
        held = axis.kind in found.levels
        label = "speed" if held else "safe speed"
        if len(speeds) == 1:
            return View(axis.kind, label, "m/s", speeds.pop(), more)
    scale, unit = SCALES.get(axis.unit, (1.0, axis.unit))
    return View(axis.kind, label, unit, scale, more)


def broken_before(found: TradeOff) -> list[str]:
    """Return the bounds that the machine as it is breaks, of those that no objective moves."""
    moved = {axis.kind for axis in found.axes.held}
    names = {b.name for b in found.study.bounds if b.kind in moved}
    return [b.name for b in found.before.bounds if b.broken and b.name not in names]
