# SPDX-License-Identifier: BSD-3-Clause
"""Whether motors can hold the arm and its loads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np

from softimpact.symbolic import STANDARD_GRAVITY, Matrix

from ..machine.coordinates import at_coordinates
from ..machine.machine import Machine
from .bound import AtMost


@dataclass(frozen=True)
class Torque(AtMost):
    """Static torque of each joint over its motor's limit, under the weight of links and loads.

    Springs beside motors count.

    A larger gear ratio raises the limit.

    Attributes:
        most: share of the limits.
        payload: point mass at the tip [kg].
        forces: that the tip presses with besides, one after another, base axes [N].
    """

    kind: ClassVar[str] = "torque"
    unit: ClassVar[str] = "of the limit"

    most: float = 1.0
    payload: float = 0.0
    forces: tuple[tuple[float, float, float], ...] = ((0.0, 0.0, 0.0),)

    def figures(self, machine: Machine, q: Matrix) -> Matrix:
        """Return the share of the limit, a row a joint that has one, and force."""
        limits = machine.model.drives.torque_limits
        limits = np.array(machine.robot.torque_limits if limits is None else limits)
        limits = limits[list(machine.model.independent)]
        known = [int(i) for i in np.flatnonzero(np.isfinite(limits))]
        at_tip = ca.DM(self.forces).T - self.payload * ca.DM(STANDARD_GRAVITY)
        own = ca.repmat(machine.holding_torques(q), 1, len(self.forces))
        torques = own + ca.mtimes(machine.jacobian(q).T, at_tip)
        strength = at_coordinates(machine.model, machine.hardware.gears) * ca.DM(limits)
        return ca.vec((ca.fabs(torques) / ca.repmat(strength, 1, len(self.forces)))[known, :])
