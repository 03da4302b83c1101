# SPDX-License-Identifier: BSD-3-Clause
"""How much energy moves towards a person."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from softimpact.symbolic import Matrix

from ..machine.machine import Machine
from .bound import AtMost


@dataclass(frozen=True)
class Energy(AtMost):
    """Kinetic energy of links and rotors in each motion of the study: ½ q̇ᵀ(M + B)q̇.

    Free motors cannot put more than that into what is hit, whatever the number of contacts.

    Attributes:
        most: energy [J].
        payload: point mass at the tip [kg].
    """

    kind: ClassVar[str] = "energy"
    unit: ClassVar[str] = "J"
    needs_speed: ClassVar[bool] = True

    most: float
    payload: float = 0.0

    def figures(self, machine: Machine, q: Matrix) -> Matrix:
        """Return the energy of each motion [J]."""
        J = machine.jacobian(q)
        mass = machine.mass_matrix(q) + machine.rotor_matrix(q)
        mass = mass + self.payload * ca.mtimes(J.T, J)
        velocities = machine.velocities(q)
        return ca.sum1(velocities * ca.mtimes(mass, velocities)).T / 2
