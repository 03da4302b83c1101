# SPDX-License-Identifier: BSD-3-Clause
"""Impact factors: how much the rotors add to what an impact feels (GIAF §II)."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from ..matrices import Factorisation, Matrix, symmetric


@dataclass(frozen=True, eq=False)
class ContactMobility:
    """Mobility G = J M⁻¹ Jᵀ of a contact point and what follows from it.

    Attributes:
        matrix: G = Λ⁻¹, 3×3 [1/kg]; singular where the point cannot move in every direction.
    """

    matrix: Matrix

    @property
    def determinant(self) -> Matrix:
        """Return det G."""
        G, C = self.matrix, self.adjugate
        return G[0, 0] * C[0, 0] + G[0, 1] * C[0, 1] + G[0, 2] * C[0, 2]

    @property
    def adjugate(self) -> Matrix:
        """Return adj G, so that Λ = adj G / det G."""
        G = self.matrix

        def cofactor(i: int, j: int) -> Matrix:
            a, b = (i + 1) % 3, (i + 2) % 3
            c, d = (j + 1) % 3, (j + 2) % 3
            return G[a, c] * G[b, d] - G[a, d] * G[b, c]

        return symmetric(cofactor, 3)

    @property
    def inertia(self) -> Matrix:
        """Return the operational space inertia Λ = G⁻¹, 3×3 [kg] (GIAF Eq. 13)."""
        return self.adjugate / self.determinant


def contact_mobility(mass_matrix: Matrix, jacobian: Matrix) -> ContactMobility:
    """Return the mobility G = J M⁻¹ Jᵀ of the contact point.

    Args:
        mass_matrix: M or M + B, n×n.
        jacobian: translational J, 3×n.
    """
    factors = Factorisation(mass_matrix)
    y = [factors.halfway(jacobian[k, :].T) for k in range(3)]
    return ContactMobility(symmetric(lambda i, j: factors.inner(y[i], y[j]), 3))


def giaf(free: ContactMobility, real: ContactMobility) -> Matrix:
    """Return the generalised impact absorption factor ζ = det(Λ_F Λ⁻¹) (GIAF Eq. 28).

    Args:
        free: mobility without rotors.
        real: mobility with them.
    """
    return real.determinant / free.determinant


def giif(free: ContactMobility, real: ContactMobility) -> Matrix:
    """Return the generalised impact increment factor det(I − Λ_F Λ⁻¹) (GIAF Eq. 27)."""
    return ContactMobility(free.matrix - real.matrix).determinant / free.determinant


def directional_giaf(free: ContactMobility, real: ContactMobility, direction: Matrix) -> Matrix:
    """Return ζ_x = xᵀΛ_F x / xᵀΛ x (GIAF Eq. 29) for a direction x, length 3."""

    def along(mobility: ContactMobility) -> Matrix:
        return ca.dot(direction, ca.mtimes(mobility.adjugate, direction))

    return (along(free) * real.determinant) / (along(real) * free.determinant)
