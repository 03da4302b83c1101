# SPDX-License-Identifier: BSD-3-Clause
"""Shortest time of a task."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np

from softimpact.symbolic import InvalidValue, Matrix
from softimpact.symbolic.robot.rigid import Array, Indices

from .objective import Objective, Own
from .safe_speed import SLOWEST


@dataclass(frozen=True)
class TaskTime(Objective):
    """The time in which the tip goes a way, each piece of it as fast as its scenario allows.

    Attributes:
        lengths: of the piece that each scenario stands for [m]; one for all, or one for each.
        fastest: speed that is not exceeded [m/s].
    """

    kind: ClassVar[str] = "task_time"
    unit: ClassVar[str] = "s"
    scales_speed: ClassVar[bool] = True
    all_scenarios: ClassVar[bool] = True

    lengths: float | tuple[float, ...] = 1.0
    fastest: float = 2.0

    def own(self, scenarios: Indices, shares: Array, speeds: Array) -> Own:
        """Return log10 of the factor on each scenario's speed."""
        start, most = [], []
        for k in range(int(scenarios.max()) + 1):
            impacts = scenarios == k
            most.append(np.log10(self.fastest / speeds[impacts].max()))
            start.append(np.clip(-np.log10(shares[impacts].max()), np.log10(SLOWEST), most[-1]))
        return Own(np.full(len(most), np.log10(SLOWEST)), np.array(most), np.array(start))

    def levels(self, own: Matrix, scenarios: Indices) -> Matrix:
        """Return ones: the limits themselves."""
        return ca.DM.ones(len(scenarios))

    def speeds(self, own: Matrix, scenarios: Indices) -> Matrix:
        """Return log10 of the factor of each impact's scenario."""
        return own[[int(k) for k in scenarios], 0]

    def value(self, own: Array, scenarios: Indices, speeds: Array) -> float:
        """Return the time [s]."""
        first = [int(np.argmax(scenarios == k)) for k in range(own.size)]
        return float((self._lengths(own.size) / (speeds[first] * 10**own)).sum())

    def cost(self, own: Matrix, scenarios: Indices, speeds: Matrix) -> Matrix:
        """Return the time over that at the study's speeds."""
        first = [int(np.argmax(scenarios == k)) for k in range(own.numel())]
        times = ca.DM(self._lengths(own.numel())) / speeds[first, 0]
        return ca.dot(times, 10 ** (-own)) / ca.sum1(times)

    def _lengths(self, scenarios: int) -> Array:
        if isinstance(self.lengths, float | int):
            return np.full(scenarios, float(self.lengths))
        if len(self.lengths) != scenarios:
            raise InvalidValue(
                "objective.lengths", f"needs {scenarios} numbers, one for each scenario"
            )
        return np.array(self.lengths)
