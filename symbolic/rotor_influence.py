# SPDX-License-Identifier: BSD-3-Clause
"""What each joint's rotor does to the impact absorption factor ζ (GIAF §III)."""

from __future__ import annotations

import casadi as ca

from .factors import contact_mobility, giaf
from .matrices import Factorisation, Matrix


def single_joint_giaf(mass_matrix: Matrix, rotors: Matrix, jacobian: Matrix) -> Matrix:
    """Return ζ_i, ζ with the rotor of joint i alone, for every joint, length n (GIAF §III.B).

    With w_i = J M⁻¹ e_i, one rotor takes b_i w_i w_iᵀ / (1 + b_i (M⁻¹)_ii) off the mobility, so
    ζ_i = 1 − b_i w_iᵀΛ_F w_i / (1 + b_i (M⁻¹)_ii).

    Args:
        mass_matrix: M without rotors, n×n.
        rotors: reflected inertias b, length n.
        jacobian: translational J, 3×n.
    """
    n = mass_matrix.shape[0]
    inverse = Factorisation(mass_matrix).solve(ca.DM.eye(n))
    W = ca.mtimes(jacobian, inverse)
    felt = _along_columns(W, contact_mobility(mass_matrix, jacobian).inertia)
    return 1 - rotors * felt / (1 + rotors * ca.diag(inverse))


def giaf_by_rotor(mass_matrix: Matrix, rotors: Matrix, jacobian: Matrix) -> Matrix:
    """Return the derivatives ∂ζ/∂b_i ≤ 0, length n [1/(kg m²)].

    With w_i = J H⁻¹ e_i and H = M + B: ∂G/∂b_i = −w_i w_iᵀ, hence ∂ζ/∂b_i = −ζ w_iᵀΛ w_i.

    Args:
        mass_matrix: M without rotors, n×n.
        rotors: reflected inertias b, length n.
        jacobian: translational J, 3×n.
    """
    H = mass_matrix + ca.diag(rotors)
    free, real = contact_mobility(mass_matrix, jacobian), contact_mobility(H, jacobian)
    W = Factorisation(H).solve(jacobian.T).T
    return -giaf(free, real) * _along_columns(W, real.inertia)


def giaf_by_gear(mass_matrix: Matrix, rotors: Matrix, jacobian: Matrix) -> Matrix:
    """Return ∂ζ/∂(ln N_i) = 2 b_i ∂ζ/∂b_i for gear ratios N_i, length n; b_i grows with N_i².

    The derivative for N_i itself is this divided by N_i.

    Args:
        mass_matrix: M without rotors, n×n.
        rotors: reflected inertias b, length n.
        jacobian: translational J, 3×n.
    """
    return 2 * rotors * giaf_by_rotor(mass_matrix, rotors, jacobian)


def _along_columns(W: Matrix, matrix: Matrix) -> Matrix:
    """Return w_iᵀ A w_i for the columns w_i of W."""
    return ca.sum1(W * ca.mtimes(matrix, W)).T
