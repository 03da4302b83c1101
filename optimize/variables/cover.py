# SPDX-License-Identifier: BSD-3-Clause
"""What the robot wears where it hits."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from softimpact.symbolic import ImpactModel, Matrix

from ..machine.hardware import Hardware
from .variable import Range, Variable, checked_range


@dataclass(frozen=True)
class Cover(Variable):
    """Stiffness of a cover that follows Hertz's law, f = k δ^1.5, at every contact point.

    Softer is better for the person, so that its thickness decides: the law holds until the cover
    is pressed through. A force that presses it deeper than ``thickness`` ends the study.

    Attributes:
        lower, upper: ends of the range [N/m^1.5].
        thickness: that can be pressed [m]; None: not looked at.
    """

    kind: ClassVar[str] = "cover"
    unit: ClassVar[str] = "N/m^1.5"
    moves: ClassVar[tuple[str, ...]] = ("cover",)

    lower: float
    upper: float
    thickness: float | None = None

    def range(self, model: ImpactModel) -> Range:
        """Return the range, which starts at the stiffest cover."""
        ends = np.array([self.lower]), np.array([self.upper])
        return checked_range(Range(("cover",), *ends, ends[1]))

    def apply(self, hardware: Hardware, values: Matrix) -> Hardware:
        """Return the hardware with this cover."""
        return replace(hardware, cover=values)
