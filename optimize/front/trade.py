# SPDX-License-Identifier: BSD-3-Clause
"""The designs of a front: one objective is made best while the others are held at some values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from softimpact.symbolic.robot.rigid import Array

from ..robust.certificate import Hardening, Setting, Worst
from ..robust.exchange import ExchangeState, exchange, worst_few
from ..search.failure import SolverFailure
from ..search.reach import Reach, reach
from ..solver_options import FEASIBLE
from .axes import Axes

TradeStart = tuple[Array, Array | None]
"""Springs and other values that a search begins with."""


@dataclass(frozen=True, eq=False)
class Trade:
    """What all searches of a front share.

    Attributes:
        setting: the study with the objective that is sought, and its scenarios.
        axes: the objectives.
        loosest: value of each one that is held at which it leaves all designs free, or the middle
            of its span.
        free: whether postures are sought as well.
        postures: to begin with, each P×n [rad].
        before: the machine as it is.
        unit: share of a limit that counts as one.
    """

    setting: Setting
    axes: Axes
    loosest: tuple[float, ...]
    free: bool
    postures: tuple[Array, ...]
    before: Worst
    unit: float

    def at(self, values: Sequence[float]) -> Setting:
        """Return the problem with the objectives held at some values."""
        asked = self.setting.study, self.setting.scenarios
        for axis, value in zip(self.axes.held, values, strict=True):
            asked = axis.held(*asked, value)
        return replace(self.setting, study=asked[0], scenarios=asked[1])

    def first(self, values: Sequence[float]) -> ExchangeState:
        """Search without a neighbour to begin with; raises SolverFailure."""
        setting = self.at(values)
        study, limits = setting.study, setting.limits
        starts: list[TradeStart] = [
            (each, None) for each in (study.nominal, study.upper, study.lower)
        ]
        found: list[ExchangeState] = []
        failed: SolverFailure | None = None
        for postures in self.postures:
            _, screened = setting.worst(Hardening(limits.vector(study.nominal), postures))
            active = worst_few(setting, screened, set())
            try:
                state = exchange(
                    setting, active, starts, postures, self.unit, free=self.free, thorough=True
                )
            except SolverFailure as failure:
                failed = failure
                continue
            found.append(state)
        if not found:
            assert failed is not None
            raise failed
        return min(found, key=self.cost)

    def near(self, values: Sequence[float], neighbours: Sequence[ExchangeState]) -> ExchangeState:
        """Search from what neighbours found; raises SolverFailure."""
        setting = self.at(values)
        parted = [setting.limits.parted(state.at.v) for state in neighbours]
        active = sorted({i for state in neighbours for i in state.active})
        postures = min(neighbours, key=self.cost).at.postures
        return exchange(setting, active, parted, postures, self.unit, free=self.free)

    def cost(self, state: ExchangeState) -> float:
        """Return what the objective that is sought makes small."""
        value = state.worst.value
        return -value if self.axes.sought.more_is_better else value

    def values(self, state: ExchangeState, held: Sequence[float]) -> tuple[float, ...]:
        """Return the objectives of a design that was found with the others held; sought first."""
        others = zip(self.axes.held, held, strict=True)
        return (state.worst.value, *(axis.value(state.worst, value) for axis, value in others))

    def reached(self, values: Sequence[float]) -> Reach:
        """Return how near hardware comes to keeping all bounds at some values."""
        study, given = self.at(values).study, self.postures[0]
        return reach(study, list(given), study.bounds, free=self.free)

    def within_reach(self, values: Sequence[float]) -> bool:
        """Return whether some hardware keeps all bounds at some values."""
        return self.reached(values).excess <= FEASIBLE
