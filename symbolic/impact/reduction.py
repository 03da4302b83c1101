# SPDX-License-Identifier: BSD-3-Clause
"""The reduced mass-spring-mass model of a robot at a contact point (MSM §2)."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from ..matrices import Factorisation, Matrix
from .elastic import LinearModel


@dataclass(frozen=True, eq=False)
class ReducedModel:
    """Two masses and a spring that stand for the robot during an impact (MSM Fig. 1a).

    Attributes:
        m_c: mass felt at the contact point [kg].
        k_r: reflected stiffness [N/m].
        m_a: mass on the actuators' side [kg]. It depends on the choice of coordinates, unlike the
            other two; ``chain`` has a second mass that does not.
    """

    m_c: Matrix
    k_r: Matrix
    m_a: Matrix


@dataclass(frozen=True, eq=False)
class ContactMode:
    """What a unit push at the contact point does: m_c and J_c# = M0⁻¹ J_cᵀ m_c (MSM Eq. 9, 10)."""

    m_c: Matrix
    direction: Matrix


def contact_mode(model: LinearModel) -> ContactMode:
    """Return m_c and the dynamically consistent inverse J_c# of J_c."""
    pushed = model.mass.solve(model.jacobian.T)
    m_c: Matrix = 1 / ca.dot(model.jacobian.T, pushed)
    return ContactMode(m_c, pushed * m_c)


def reflected_mass(mass_matrix: Matrix, jacobian: Matrix) -> Matrix:
    """Return m_c = (J_c M⁻¹ J_cᵀ)⁻¹ [kg] (MSM Eq. 36).

    For an elastic robot M may be the links' mass matrix alone: the rotors do not enter.

    Args:
        mass_matrix: M, n×n.
        jacobian: J_c, 1×n.
    """
    factors = Factorisation(mass_matrix)
    y = factors.halfway(jacobian.T)
    return 1 / factors.inner(y, y)


def reduce_to_two_masses(model: LinearModel) -> ReducedModel:
    """Return m_c, k_r and m_a (MSM Eq. 36-38) without a nullspace.

    With N = M0 − m_c J_cᵀJ_c and B = SᵀK0S, S = I − J_c#J_c, the minimiser of Eq. 38 in the
    Frobenius norm is m_a = k_r⟨N, B⟩/⟨B, B⟩ for every orthonormal J_a. With w = K0 J_c# both
    products expand into sums that never form N, B or S.
    """
    mode = contact_mode(model)
    m_c, K0 = mode.m_c, model.stiffness
    j = model.jacobian.T
    w = ca.mtimes(K0, mode.direction)
    k_r = ca.dot(mode.direction, w)  # Eq. 37
    jj, jw, ww = ca.dot(j, j), ca.dot(j, w), ca.dot(w, w)
    Kj = ca.mtimes(K0, j)
    jKj, wKj = ca.dot(j, Kj), ca.dot(w, Kj)
    Nj = model.mass.apply(j) - m_c * jj * j
    NK = ca.dot(model.mass.matrix, K0) - m_c * jKj
    NB = NK - 2 * ca.dot(w, Nj) + k_r * ca.dot(j, Nj)
    BB = ca.dot(K0, K0) - 4 * wKj + 2 * (jj * ww + jw * jw)
    BB = BB + k_r * (2 * jKj - 4 * jj * jw + k_r * jj * jj)
    return ReducedModel(m_c, k_r, k_r * NB / BB)  # Eq. 38


def static_stiffness(model: LinearModel) -> Matrix:
    """Return Kishi's k_c = (J_c K0⁻¹ J_cᵀ)⁻¹ [N/m], the stiffness a slow push meets."""
    return reflected_mass(model.stiffness, model.jacobian)
