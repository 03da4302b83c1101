# SPDX-License-Identifier: BSD-3-Clause
"""How fast the arm swings on its springs."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import ClassVar

import casadi as ca

from softimpact.symbolic import ImpactModel, Matrix
from softimpact.symbolic.matrices import Factorisation

from ..machine.coordinates import loose
from ..machine.machine import Machine
from ..machine.springs import sprung
from .bound import AtLeast
from .eigenvalue import largest_eigenvalue


@dataclass(frozen=True)
class NaturalFrequency(AtLeast):
    """First natural frequency of the links on their springs, the motors held: ω² M x = k_s x.

    The base of a floating robot swings against them: M is what is left of its inertia where it
    gives way, M_ss − M_sb M_bb⁻¹ M_bs.

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
        mass = _on_springs(machine.model, mass)
        root: Matrix = 1 / ca.sqrt(machine.stiffness(-machine.margin))
        return 1 / (2 * pi * ca.sqrt(largest_eigenvalue(mass * ca.mtimes(root, root.T))))


def _on_springs(model: ImpactModel, mass: Matrix) -> Matrix:
    """Return the mass that the springs feel where rigid motors are held and a base gives way."""
    places = model.independent
    springs, base = [places.index(i) for i in sprung(model)], list(loose(model))
    felt = mass[springs, springs]
    if base:
        gives = Factorisation(mass[base, base]).solve(mass[base, springs])
        felt = felt - ca.mtimes(mass[springs, base], gives)
    return felt
