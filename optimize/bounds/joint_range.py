# SPDX-License-Identifier: BSD-3-Clause
"""How far joints stay from their ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np

from softimpact.symbolic import Matrix

from ..machine.machine import Machine
from .bound import AtLeast


@dataclass(frozen=True)
class JointRange(AtLeast):
    """Distance of each joint from its limits, which postures keep in any case.

    Attributes:
        least: distance [rad; m of a sliding joint].
    """

    kind: ClassVar[str] = "joint_range"
    unit: ClassVar[str] = "rad"

    least: float

    def figures(self, machine: Machine, q: Matrix) -> Matrix:
        """Return the distance to each limit that there is [rad]."""
        lower, upper = machine.robot.limits
        low = [int(i) for i in np.flatnonzero(np.isfinite(lower))]
        high = [int(i) for i in np.flatnonzero(np.isfinite(upper))]
        return ca.vertcat((q - ca.DM(lower))[low], (ca.DM(upper) - q)[high])
