# SPDX-License-Identifier: BSD-3-Clause
"""How far a posture is from singular ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from softimpact.symbolic import Matrix, manipulability

from ..machine.coordinates import moved_by_motors
from ..machine.machine import Machine
from .bound import AtLeast


@dataclass(frozen=True)
class Manipulability(AtLeast):
    """ω_m = √det(J Jᵀ) of the tip's translation (GIAF Eq. 2).

    Attributes:
        least: ω_m [m³].
    """

    kind: ClassVar[str] = "manipulability"
    unit: ClassVar[str] = "m³"

    least: float

    def figures(self, machine: Machine, q: Matrix) -> Matrix:
        """Return ω_m [m³]."""
        return manipulability(moved_by_motors(machine.model, machine.jacobian(q)))
