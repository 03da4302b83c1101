# SPDX-License-Identifier: BSD-3-Clause
"""The rotors."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from softimpact.symbolic import ImpactModel, Matrix

from ..machine.hardware import Hardware
from .variable import OneOrEach, Range, Variable, joint_range


@dataclass(frozen=True)
class RotorInertia(Variable):
    """Reflected rotor inertia B of each joint, with the present gears.

    Attributes:
        lower, upper: ends of the range, one or each [kg m²].
    """

    kind: ClassVar[str] = "rotor_inertia"
    unit: ClassVar[str] = "kg m²"
    moves: ClassVar[tuple[str, ...]] = ("rotors",)

    lower: OneOrEach
    upper: OneOrEach

    def range(self, model: ImpactModel) -> Range:
        """Return the range, which starts at the robot's own rotors."""
        return joint_range(model, self.lower, self.upper, np.array(model.drives.rotors).ravel())

    def apply(self, hardware: Hardware, values: Matrix) -> Hardware:
        """Return the hardware with these rotors."""
        return replace(hardware, rotors=values)
