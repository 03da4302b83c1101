# SPDX-License-Identifier: BSD-3-Clause
"""What each joint's rotor does to the impact absorption factor ζ (GIAF §III)."""

from __future__ import annotations

import casadi as ca

from ..matrices import Factorisation, Matrix
from .contact_mobility import contact_mobility, giaf


def rotor_mass(rotors: Matrix, tangent: Matrix | None = None) -> Matrix:
    """Return B = diag(b), in a closed chain GᵀBG.

    Args:
        rotors: reflected inertias b, length n.
        tangent: G = ∂q/∂q_ind, n×m; None is G = I.
    """
    B = ca.diag(rotors)
    return B if tangent is None else ca.mtimes([tangent.T, B, tangent])


def single_joint_giaf(
    mass_matrix: Matrix, rotors: Matrix, jacobian: Matrix, tangent: Matrix | None = None
) -> Matrix:
    """Return ζ_i, ζ with the rotor of joint i alone, for every joint, length n (GIAF §III.B).

    With w_i = J M⁻¹ e_i, one rotor takes b_i w_i w_iᵀ / (1 + b_i (M⁻¹)_ii) off the mobility, so
    ζ_i = 1 − b_i w_iᵀΛ_F w_i / (1 + b_i (M⁻¹)_ii). In a closed chain Gᵀe_i takes the place of e_i.

    Args:
        mass_matrix: M without rotors, n×n; of a closed chain over its m independent joints, m×m.
        rotors: reflected inertias b, length n.
        jacobian: translational J over the same joints as M.
        tangent: G = ∂q/∂q_ind of a closed chain, n×m; None is G = I.
    """
    factors = Factorisation(mass_matrix)
    turned = ca.DM.eye(mass_matrix.shape[0]) if tangent is None else tangent.T
    columns = [factors.halfway(turned[:, i]) for i in range(turned.shape[1])]
    own = ca.vertcat(*[factors.inner(y, y) for y in columns])
    W = ca.mtimes(factors.solve(jacobian.T).T, turned)
    felt = _along_columns(W, contact_mobility(mass_matrix, jacobian).inertia)
    return 1 - rotors * felt / (1 + rotors * own)


def giaf_by_rotor(
    mass_matrix: Matrix, rotors: Matrix, jacobian: Matrix, tangent: Matrix | None = None
) -> Matrix:
    """Return the derivatives ∂ζ/∂b_i ≤ 0, length n [1/(kg m²)].

    With w_i = J H⁻¹ e_i and H = M + B: ∂Λ⁻¹/∂b_i = −w_i w_iᵀ, hence ∂ζ/∂b_i = −ζ w_iᵀΛ w_i.

    Takes what ``single_joint_giaf`` does.
    """
    H = mass_matrix + rotor_mass(rotors, tangent)
    free, real = contact_mobility(mass_matrix, jacobian), contact_mobility(H, jacobian)
    W = Factorisation(H).solve(jacobian.T).T
    W = W if tangent is None else ca.mtimes(W, tangent.T)
    return -giaf(free, real) * _along_columns(W, real.inertia)


def giaf_by_gear(
    mass_matrix: Matrix, rotors: Matrix, jacobian: Matrix, tangent: Matrix | None = None
) -> Matrix:
    """Return ∂ζ/∂(ln N_i) = 2 b_i ∂ζ/∂b_i for gear ratios N_i, length n; b_i grows with N_i².

    The derivative for N_i itself is this divided by N_i. Takes what ``single_joint_giaf`` does.
    """
    return 2 * rotors * giaf_by_rotor(mass_matrix, rotors, jacobian, tangent)


def _along_columns(W: Matrix, matrix: Matrix) -> Matrix:
    """Return w_iᵀ A w_i for the columns w_i of W."""
    return ca.sum1(W * ca.mtimes(matrix, W)).T
