# SPDX-License-Identifier: BSD-3-Clause
"""Least mean of the forces over their limits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np

from softimpact.symbolic import Matrix
from softimpact.symbolic.robot.rigid import Array, Indices

from .objective import Objective, Own


@dataclass(frozen=True)
class MeanForce(Objective):
    """The mean over all scenarios of the force over its limit is made small.

    Of what motors may do in a scenario the worse counts.
    """

    kind: ClassVar[str] = "mean_force"
    unit: ClassVar[str] = "of the limit"
    all_scenarios: ClassVar[bool] = True

    def own(self, scenarios: Indices, shares: Array, speeds: Array) -> Own:
        """Return a level for each scenario."""
        start = np.array([shares[scenarios == k].max() for k in range(int(scenarios.max()) + 1)])
        return Own(np.zeros(start.size), np.full(start.size, np.inf), start)

    def levels(self, own: Matrix, scenarios: Indices) -> Matrix:
        """Return the level of each impact's scenario."""
        return own[[int(k) for k in scenarios], 0]

    def speeds(self, own: Matrix, scenarios: Indices) -> Matrix:
        """Return zeros: speeds stay."""
        return ca.DM(len(scenarios), 1)

    def value(self, own: Array, scenarios: Indices, speeds: Array) -> float:
        """Return the mean level."""
        return float(own.mean())

    def cost(self, own: Matrix, scenarios: Indices, speeds: Matrix) -> Matrix:
        """Return the mean level."""
        return ca.sum1(own) / own.numel()
