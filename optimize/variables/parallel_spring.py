# SPDX-License-Identifier: BSD-3-Clause
"""Springs beside the motors."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

from softimpact.symbolic import ImpactModel, Matrix

from ..machine.hardware import Hardware
from ..machine.springs import beside_motors
from .variable import OneOrEach, Range, Variable, joint_range


@dataclass(frozen=True)
class ParallelSpring(Variable):
    """Stiffness of each joint's spring from body to body, beside its motor and the spring behind.

    It is unbent where the robot's file says, else at zero. It carries part of what bends the link,
    its motor held; what bends it counts among the torques that motors hold.

    Attributes:
        lower, upper: ends of the range, one or each [N·m/rad].
    """

    kind: ClassVar[str] = "parallel_spring"
    unit: ClassVar[str] = "N·m/rad"
    moves: ClassVar[tuple[str, ...]] = ("beside",)
    hastens: ClassVar[bool] = True

    lower: OneOrEach
    upper: OneOrEach

    def range(self, model: ImpactModel) -> Range:
        """Return the range, which starts at the file's own springs, or as soft as it can be."""
        return joint_range(model, self.lower, self.upper, beside_motors(model))

    def apply(self, hardware: Hardware, values: Matrix) -> Hardware:
        """Return the hardware with these springs."""
        return replace(hardware, beside=values)
