# SPDX-License-Identifier: BSD-3-Clause
"""The gears."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from softimpact.symbolic import ImpactModel, InvalidValue, Matrix

from ..machine.hardware import Hardware
from .variable import OneOrEach, Range, Variable, joint_range


@dataclass(frozen=True)
class GearRatio(Variable):
    """Ratio of each joint's gear over the present one.

    A rotor counts with its square. Motors get stronger and slower by it, which bounds on torque and
    joint speed see. Springs stay on the joint's side.

    Attributes:
        lower, upper: ends of the range, one or each, 1 being the present gear.
    """

    kind: ClassVar[str] = "gear_ratio"
    unit: ClassVar[str] = "of the present ratio"
    moves: ClassVar[tuple[str, ...]] = ("rotors",)

    lower: OneOrEach
    upper: OneOrEach

    def range(self, model: ImpactModel) -> Range:
        """Return the range, which starts at the present gears."""
        if not np.all(np.array(model.drives.rotors) > 0):
            raise InvalidValue("lower", "gears change rotors: give robot.rotor_inertia")
        return joint_range(model, self.lower, self.upper, np.ones(model.robot.n))

    def apply(self, hardware: Hardware, values: Matrix) -> Hardware:
        """Return the hardware with these gears."""
        return replace(hardware, gears=values)
