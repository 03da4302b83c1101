# SPDX-License-Identifier: BSD-3-Clause
"""Least worst force over its limit."""

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


@dataclass(frozen=True)
class WorstForce(Objective):
    """The largest of all forces, each over its limit, is made small."""

    kind: ClassVar[str] = "worst_force"
    unit: ClassVar[str] = "of the limit"
    span: ClassVar[tuple[float, float] | None] = (0.5, 1.0)

    def own(self, scenarios: Indices, shares: Array, speeds: Array) -> Own:
        """Return F, which no share exceeds."""
        return Own(np.zeros(1), np.full(1, np.inf), np.array([shares.max()]))

    def levels(self, own: Matrix, scenarios: Indices) -> Matrix:
        """Return F for each impact."""
        return ca.repmat(own, len(scenarios), 1)

    def speeds(self, own: Matrix, scenarios: Indices) -> Matrix:
        """Return zeros: speeds stay."""
        return ca.DM(len(scenarios), 1)

    def value(self, own: Array, scenarios: Indices, speeds: Array) -> float:
        """Return F."""
        return float(own[0])

    def cost(self, own: Matrix, scenarios: Indices, speeds: Matrix) -> Matrix:
        """Return F."""
        return own

    def held(self, scenarios: Scenarios, value: float) -> Scenarios:
        """Return the scenarios with this share of the limits allowed."""
        return scenarios.within(value)
