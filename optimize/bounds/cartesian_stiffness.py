# SPDX-License-Identifier: BSD-3-Clause
"""How stiff the tip is, by the springs alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np

from softimpact.symbolic import Matrix, unit_direction

from ..machine.machine import Machine
from .bound import AtLeast
from .eigenvalue import largest_eigenvalue


@dataclass(frozen=True)
class CartesianStiffness(AtLeast):
    """Force over displacement at the tip, the motors held: 1/(nᵀ J k_s⁻¹ Jᵀ n).

    Attributes:
        least: stiffness [N/m].
        direction: n, base axes, of any length; None: the direction in which it is least.
    """

    kind: ClassVar[str] = "cartesian_stiffness"
    unit: ClassVar[str] = "N/m"

    least: float
    direction: tuple[float, float, float] | None = None

    def figures(self, machine: Machine, q: Matrix) -> Matrix:
        """Return the stiffness [N/m]; the least one 0.5 % too small at worst."""
        J = machine.jacobian(q)
        soft = machine.compliance(-machine.margin)
        compliance = ca.mtimes(J, J.T * ca.repmat(soft, 1, 3))
        if self.direction is None:
            return 1 / largest_eigenvalue(compliance)
        n = ca.DM(np.asarray(unit_direction(self.direction)))
        return 1 / ca.mtimes([n.T, compliance, n])
