# SPDX-License-Identifier: BSD-3-Clause
"""Whether joints can be as fast as the study's motions ask."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np

from softimpact.symbolic import Matrix

from ..machine.machine import Machine
from .bound import AtMost


@dataclass(frozen=True)
class JointSpeed(AtMost):
    """Speed of each joint over its limit, in each motion of the study.

    The joint velocities are those of least norm. A larger gear ratio lowers the limit.

    Attributes:
        most: share of the limits.
    """

    kind: ClassVar[str] = "joint_speed"
    unit: ClassVar[str] = "of the limit"
    needs_speed: ClassVar[bool] = True

    most: float = 1.0

    def figures(self, machine: Machine, q: Matrix) -> Matrix:
        """Return the share of the limit, a row a joint that has one, and motion."""
        limits = machine.robot.speed_limits
        known = [int(i) for i in np.flatnonzero(np.isfinite(limits))]
        shares = ca.fabs(machine.joint_velocities(q)) * machine.hardware.gears / ca.DM(limits)
        return ca.vec(shares[known, :])
