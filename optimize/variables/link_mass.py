# SPDX-License-Identifier: BSD-3-Clause
"""The links."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from softimpact.symbolic import ImpactModel, InvalidValue, Matrix

from ..machine.hardware import Hardware
from .variable import OneOrEach, Range, Variable, joint_range


@dataclass(frozen=True)
class LinkMass(Variable):
    """Mass and inertia of each joint's body over the present one, its shape kept.

    Attributes:
        lower, upper: ends of the range, one or each, 1 being the link as it is.
    """

    kind: ClassVar[str] = "link_mass"
    unit: ClassVar[str] = "of the present mass"
    moves: ClassVar[tuple[str, ...]] = ("masses",)

    lower: OneOrEach
    upper: OneOrEach

    def range(self, model: ImpactModel) -> Range:
        """Return the range, which starts at the links as they are."""
        if model.drives.computed_torque_gain is not None:
            raise InvalidValue("lower", "a computed torque gain is made for the links as they are")
        return joint_range(model, self.lower, self.upper, np.ones(model.robot.n))

    def apply(self, hardware: Hardware, values: Matrix) -> Hardware:
        """Return the hardware with these links."""
        return replace(hardware, masses=values)
