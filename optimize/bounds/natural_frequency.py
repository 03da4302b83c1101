# SPDX-License-Identifier: BSD-3-Clause
"""How fast the arm swings on its springs."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import ClassVar

import casadi as ca

from softimpact.symbolic import Matrix

from ..hardware import Machine
from .bound import AtLeast
from .eigenvalue import largest_eigenvalue


@dataclass(frozen=True)
class NaturalFrequency(AtLeast):
    """First natural frequency of the links on their springs, the motors held: ω² M x = k_s x.

    Attributes:
        least: frequency [Hz].
        payload: point mass at the tip [kg].
    """

    kind: ClassVar[str] = "natural_frequency"
    unit: ClassVar[str] = "Hz"

    least: float
    payload: float = 0.0

    def figures(self, machine: Machine, q: Matrix) -> Matrix:
        """Return the frequency [Hz], 0.4 % too low at worst."""
        J = machine.jacobian(q)
        mass = machine.mass_matrix(q) + self.payload * ca.mtimes(J.T, J)
        root: Matrix = 1 / ca.sqrt(machine.softest_springs)
        return 1 / (2 * pi * ca.sqrt(largest_eigenvalue(mass * ca.mtimes(root, root.T))))
