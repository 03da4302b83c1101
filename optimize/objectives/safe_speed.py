# SPDX-License-Identifier: BSD-3-Clause
"""Greatest safe speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import casadi as ca
import numpy as np

from softimpact.symbolic import Matrix
from softimpact.symbolic.robot.rigid import Array, Indices

from .objective import Objective, Own

if TYPE_CHECKING:
    from ..study.scenarios import Scenarios

SLOWEST = 1e-3
"""Least factor on the speeds that is looked at."""


@dataclass(frozen=True)
class SafeSpeed(Objective):
    """A factor on all speeds, with which every force keeps its limit, is made large.

    Attributes:
        fastest: speed that is enough [m/s].
    """

    kind: ClassVar[str] = "safe_speed"
    unit: ClassVar[str] = "of the speeds"
    scales_speed: ClassVar[bool] = True
    more_is_better: ClassVar[bool] = True
    span: ClassVar[tuple[float, float] | None] = (0.5, 2.0)

    fastest: float = 2.0

    def own(self, scenarios: Indices, shares: Array, speeds: Array) -> Own:
        """Return log10 of the factor; it starts where forces in proportion to speed keep limits."""
        most = np.log10(self.fastest / speeds.max())
        start = np.clip(-np.log10(shares.max()), np.log10(SLOWEST), most)
        return Own(np.array([np.log10(SLOWEST)]), np.array([most]), np.array([start]))

    def levels(self, own: Matrix, scenarios: Indices) -> Matrix:
        """Return ones: the limits themselves."""
        return ca.DM.ones(len(scenarios))

    def speeds(self, own: Matrix, scenarios: Indices) -> Matrix:
        """Return log10 of the factor for each impact."""
        return ca.repmat(own, len(scenarios), 1)

    def value(self, own: Array, scenarios: Indices, speeds: Array) -> float:
        """Return the factor."""
        return float(10 ** own[0])

    def cost(self, own: Matrix, scenarios: Indices, speeds: Matrix) -> Matrix:
        """Return the logarithm of 1 over the factor."""
        return -own

    def held(self, scenarios: Scenarios, value: float) -> Scenarios:
        """Return the scenarios with speeds times this factor."""
        return scenarios.faster(value)
