# SPDX-License-Identifier: BSD-3-Clause
"""Measures of a contact point and the ellipsoids they are the volume of (GIAF §II.A)."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from .eigen import symmetric_eigen
from .factors import ContactMobility
from .matrices import Matrix


@dataclass(frozen=True, eq=False)
class Ellipsoid:
    """An ellipsoid around the contact point.

    Attributes:
        semi_axes: lengths, rising, length 3.
        axes: their directions as unit columns, 3×3, in the axes of the matrix it came from.
    """

    semi_axes: Matrix
    axes: Matrix


def ellipsoid(matrix: Matrix) -> Ellipsoid:
    """Return {A^½ u: |u| ≤ 1} of a symmetric A ⪰ 0, 3×3.

    Semi-axes shorter than 1e-8 of the longest are rounding.
    """
    eigen = symmetric_eigen(matrix)
    return Ellipsoid(ca.sqrt(ca.fmax(eigen.values, 0)), eigen.vectors)


def manipulability(jacobian: Matrix) -> Matrix:
    """Return ω_m = √det(J Jᵀ) = σ1 σ2 σ3 (GIAF Eq. 2); zero where the point cannot move.

    Args:
        jacobian: translational J, 3×n.
    """
    JJ = ContactMobility(ca.mtimes(jacobian, jacobian.T))
    return ca.sqrt(ca.fmax(JJ.determinant, 0))


def force_measure(jacobian: Matrix) -> Matrix:
    """Return ω_f = 1/ω_m (GIAF Eq. 3); infinite where the point cannot move in all directions."""
    return 1 / manipulability(jacobian)


def manipulability_ellipsoid(jacobian: Matrix) -> Ellipsoid:
    """Return the velocities J q̇ with |q̇| ≤ 1; semi-axes σ_i.

    The forces that Jᵀf, |Jᵀf| ≤ 1, can hold form an ellipsoid with the same axes and 1/σ_i.
    """
    return ellipsoid(ca.mtimes(jacobian, jacobian.T))


def impact_matrix(mass_matrix: Matrix, jacobian: Matrix) -> Matrix:
    """Return E = J⁺ᵀ H² J⁺, 3×3 [kg² m²], of the pseudo-inverse J⁺ = Jᵀ(J Jᵀ)⁻¹.

    A velocity change Δẋ that the joints take up with least |Δq̇| costs them the impulse
    |H J⁺ Δẋ|, whose square is ΔẋᵀE Δẋ. The print of GIAF Eq. 15 leaves the transpose out.

    Args:
        mass_matrix: H with rotors, n×n.
        jacobian: translational J of rank 3, 3×n.
    """
    JJ = ContactMobility(ca.mtimes(jacobian, jacobian.T))
    HJ = ca.mtimes(mass_matrix, ca.mtimes(jacobian.T, JJ.inertia))
    return ca.mtimes(HJ.T, HJ)


def dynamic_impact_measure(mass_matrix: Matrix, jacobian: Matrix) -> Matrix:
    """Return ω_di = √det(J⁺ᵀ H² J⁺) (GIAF Eq. 15) [kg³ m³]."""
    return ca.sqrt(ContactMobility(impact_matrix(mass_matrix, jacobian)).determinant)


def dynamic_impact_ellipsoid(mass_matrix: Matrix, jacobian: Matrix) -> Ellipsoid:
    """Return the ellipsoid of Eq. 15: a long axis is a direction that loads the joints much."""
    return ellipsoid(impact_matrix(mass_matrix, jacobian))


def generalised_inertia_ellipsoid(mobility: ContactMobility) -> Ellipsoid:
    """Return the impulse responses of equal energy, {v: vᵀΛ v ≤ 1} (Asada); G = Λ⁻¹.

    Its semi-axes are 1/√λ_i(Λ) [kg^-½]: long where the point gives way easily.
    """
    return ellipsoid(mobility.matrix)
