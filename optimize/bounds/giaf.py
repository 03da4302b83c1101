# SPDX-License-Identifier: BSD-3-Clause
"""How much of an impact the rotors leave to the links alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from softimpact.symbolic import (
    Matrix,
    contact_mobility,
    directional_giaf,
    giaf,
    unit_direction,
)

from ..machine.machine import Machine
from .bound import AtLeast


@dataclass(frozen=True)
class Giaf(AtLeast):
    """Generalised impact absorption factor ζ of the rigid robot with its rotors (GIAF Eq. 28, 29).

    Attributes:
        least: factor, from 0 to 1.
        direction: along which it counts, base axes; None: over all three.
    """

    kind: ClassVar[str] = "giaf"
    unit: ClassVar[str] = "1"

    least: float
    direction: tuple[float, float, float] | None = None

    def figures(self, machine: Machine, q: Matrix) -> Matrix:
        """Return ζ."""
        J, M = machine.jacobian(q), machine.mass_matrix(q)
        free = contact_mobility(M, J)
        real = contact_mobility(M + machine.rotor_matrix(q), J)
        if self.direction is None:
            return giaf(free, real)
        return directional_giaf(free, real, ca.DM(unit_direction(self.direction)))
