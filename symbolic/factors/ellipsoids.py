# SPDX-License-Identifier: BSD-3-Clause
"""Measures of a contact point and the ellipsoids they are the volume of (GIAF §II.A)."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from ..eigen import symmetric_eigen
from ..matrices import Matrix, OrthogonalRows, symmetric
from .contact_mobility import ContactMobility


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

    It is the volume that the rows of J span, taken from their lengths when made orthogonal: det
    loses twice as many digits near singular poses.

    Args:
        jacobian: translational J, 3×n.
    """
    return OrthogonalRows(jacobian).volume


def longest_manipulability(jacobian: Matrix) -> Matrix:
    """Return the product of the lengths of J's rows, which ω_m never exceeds (Hadamard).

    The share ω_m has of it is 0 at singular poses and 1 where all rows are orthogonal.
    """
    x, y, z = (ca.sumsqr(jacobian[k, :]) for k in range(3))
    return ca.sqrt(x * y * z)


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
    cost = _impulses(mass_matrix, jacobian)
    return symmetric(lambda i, j: ca.dot(cost[i, :], cost[j, :]), 3)


def _impulses(mass_matrix: Matrix, jacobian: Matrix) -> Matrix:
    """Return (H J⁺)ᵀ, the joints' impulses for each component of Δẋ, 3×n."""
    return ca.mtimes(OrthogonalRows(jacobian).pseudo_inverse.T, mass_matrix)


def dynamic_impact_measure(mass_matrix: Matrix, jacobian: Matrix) -> Matrix:
    """Return ω_di = √det(J⁺ᵀ H² J⁺) (GIAF Eq. 15) [kg³ m³]."""
    return OrthogonalRows(_impulses(mass_matrix, jacobian)).volume


def dynamic_impact_ellipsoid(mass_matrix: Matrix, jacobian: Matrix) -> Ellipsoid:
    """Return the ellipsoid of Eq. 15: a long axis is a direction that loads the joints much."""
    return ellipsoid(impact_matrix(mass_matrix, jacobian))


def generalised_inertia_ellipsoid(mobility: ContactMobility) -> Ellipsoid:
    """Return the impulse responses of equal energy, {v: vᵀΛ v ≤ 1} (Asada); G = Λ⁻¹.

    Its semi-axes are 1/√λ_i(Λ) [kg^-½]: long where the point gives way easily.
    """
    return ellipsoid(mobility.matrix)
