# SPDX-License-Identifier: BSD-3-Clause
"""In which direction the rotors matter most and least."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from ..eigen import Eigen, symmetric_eigen
from ..matrices import Factorisation, Matrix
from .contact_mobility import ContactMobility


@dataclass(frozen=True, eq=False)
class Extremes:
    """Extremes of a ratio over all directions, and where they are.

    Attributes:
        least: smallest ratio.
        greatest: largest ratio.
        least_direction: unit vector, length 3.
        greatest_direction: unit vector, length 3.
    """

    least: Matrix
    greatest: Matrix
    least_direction: Matrix
    greatest_direction: Matrix


def extreme_directional_giaf(free: ContactMobility, real: ContactMobility) -> Extremes:
    """Return the extremes of ζ_x = xᵀΛ_F x / xᵀΛ x (GIAF Eq. 29).

    They solve Λ_F x = μ Λ x. The eigenvalues lie in [0, 1], and their product is ζ.

    Args:
        free: mobility without rotors, positive definite.
        real: mobility with them.
    """
    C, eigen = _pencil(free, real)
    vectors = ca.mtimes(C, eigen.vectors)  # Λ_F x = μ Λ x with x = C y
    return _extremes(eigen, vectors)


def extreme_mass_ratio(free: ContactMobility, real: ContactMobility) -> Extremes:
    """Return the extremes of nᵀΛ⁻¹n / nᵀΛ_F⁻¹n, mass felt without rotors over mass felt with.

    The values are those of ``extreme_directional_giaf``, the directions are not: x there is a
    velocity given to the contact point, n here a force that it meets.

    Args:
        free: mobility without rotors, positive definite.
        real: mobility with them.
    """
    C, eigen = _pencil(free, real)
    vectors = ca.solve(C.T, eigen.vectors)  # G n = μ G_F n with Cᵀ n = y
    return _extremes(eigen, vectors)


def _pencil(free: ContactMobility, real: ContactMobility) -> tuple[Matrix, Eigen]:
    """Return C with G_F = C Cᵀ, and the eigenpairs (μ, y) of C⁻¹ G C⁻ᵀ."""
    factors = Factorisation(free.matrix)
    half: Matrix = ca.horzcat(*[ca.vertcat(*factors.halfway(real.matrix[:, k])) for k in range(3)])
    full = ca.horzcat(*[ca.vertcat(*factors.halfway(half[k, :].T)) for k in range(3)])
    root = ca.sqrt(ca.vertcat(*factors.d))
    L = ca.blockcat([[_unit_lower(factors, i, k) for k in range(3)] for i in range(3)])
    scale = ca.mtimes(root, root.T)
    return ca.mtimes(L, ca.diag(root)), symmetric_eigen(full / scale)


def _unit_lower(factors: Factorisation, i: int, k: int) -> Matrix:
    if i <= k:
        return float(i == k)
    return factors.l[i][k]


def _extremes(eigen: Eigen, vectors: Matrix) -> Extremes:
    least, greatest = vectors[:, 0], vectors[:, 2]
    return Extremes(
        least=eigen.values[0],
        greatest=eigen.values[2],
        least_direction=least / ca.norm_2(least),
        greatest_direction=greatest / ca.norm_2(greatest),
    )
