# SPDX-License-Identifier: BSD-3-Clause
"""How heavy the arm is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from softimpact.symbolic import Matrix

from ..machine.hardware import link_masses
from ..machine.machine import Machine
from .bound import AtMost


@dataclass(frozen=True)
class Mass(AtMost):
    """Mass of all that moves, without what rotors add by their gears.

    Attributes:
        most: mass [kg].
    """

    kind: ClassVar[str] = "mass"
    unit: ClassVar[str] = "kg"

    most: float

    def figures(self, machine: Machine, q: Matrix) -> Matrix:
        """Return the sum of the bodies' masses [kg]."""
        masses, factors = ca.DM(link_masses(machine.robot)), machine.hardware.masses
        return ca.sum1(masses if factors is None else masses * factors)
