# SPDX-License-Identifier: BSD-3-Clause
"""Random linear models M0, K0, J_c, and the papers' formulas on them written out densely."""

from __future__ import annotations

import casadi as ca
import numpy as np
import scipy.linalg
from hypothesis import strategies as st

from softimpact.symbolic import LinearModel
from softimpact.symbolic.impact.elastic import DenseMass
from softimpact.symbolic.robot.rigid import Array


def random_linear_model(seed: int, size: int) -> LinearModel:
    """Return a well-conditioned model with a positive definite K0."""
    random = np.random.default_rng(seed)
    half = random.normal(size=(size, size))
    M = half @ half.T + size * np.eye(size)
    half = random.normal(size=(size, size))
    K = 1e3 * (half @ half.T + size * np.eye(size))
    return LinearModel(DenseMass(ca.DM(M)), ca.DM(K), ca.DM(random.normal(size=(1, size))))


@st.composite
def linear_models(draw: st.DrawFn, max_size: int = 8) -> LinearModel:
    """Models of any size."""
    return random_linear_model(draw(st.integers(0, 2**32 - 1)), draw(st.integers(2, max_size)))


def dense(model: LinearModel) -> tuple[Array, Array, Array]:
    """Return M0, K0 and the column J_cᵀ."""
    M, K = np.array(model.mass.matrix), np.array(model.stiffness)
    return M, K, np.array(model.jacobian).ravel()


def transformed(model: LinearModel, T: Array) -> LinearModel:
    """Return the same model in coordinates x with q = T x."""
    M, K, j = dense(model)
    return LinearModel(DenseMass(ca.DM(T.T @ M @ T)), ca.DM(T.T @ K @ T), ca.DM(j @ T).T)


def nullspace(model: LinearModel, seed: int) -> Array:
    """Return J_a, orthonormal rows that span ker(J_c M0⁻¹) (MSM Eq. 14), turned at random."""
    M, _, j = dense(model)
    rows = scipy.linalg.null_space(np.linalg.solve(M, j)[None]).T
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(len(j) - 1, len(j) - 1)))
    return np.asarray(turn @ rows)


def with_nullspace(model: LinearModel, J_a: Array) -> tuple[float, float, float]:
    """Return m_c, k_r and m_a as MSM prints them (Eq. 9, 15, 16, 36-38)."""
    M, K, j = dense(model)
    M_inverse = np.linalg.inv(M)
    m_c = 1 / (j @ M_inverse @ j)  # Eq. 36
    J_c_sharp = M_inverse @ j * m_c  # Eq. 9
    M_a = np.linalg.inv(J_a @ M_inverse @ J_a.T)  # Eq. 16
    J_a_sharp = M_inverse @ J_a.T @ M_a  # Eq. 15
    k_r = J_c_sharp @ K @ J_c_sharp  # Eq. 37
    K_a = J_a_sharp.T @ K @ J_a_sharp
    m_a = k_r * np.sum(M_a * K_a) / np.sum(K_a * K_a)  # Eq. 38, its minimum in m_a
    return float(m_c), float(k_r), float(m_a)


def second_mass(model: LinearModel, J_a: Array) -> float:
    """Return (J_x M_a⁻¹ J_xᵀ)⁻¹, the inertia that x_a = J_x x_a of MSM Eq. 27 really has."""
    M, K, j = dense(model)
    M_inverse = np.linalg.inv(M)
    J_c_sharp = M_inverse @ j / (j @ M_inverse @ j)
    mobility = J_a @ M_inverse @ J_a.T
    J_a_sharp = M_inverse @ J_a.T @ np.linalg.inv(mobility)
    J_x = -(J_c_sharp @ K @ J_a_sharp) / (J_c_sharp @ K @ J_c_sharp)  # Eq. 27
    return float(1 / (J_x @ mobility @ J_x))


def lanczos(model: LinearModel, order: int) -> tuple[Array, Array, Array]:
    """Return T's diagonal and off-diagonal and V, by full reorthogonalisation in M0."""
    M, K, j = dense(model)
    v = np.linalg.solve(M, j)
    basis: list[Array] = [v / np.sqrt(v @ M @ v)]
    diagonal: list[float] = []
    beside: list[float] = []
    for _ in range(order):
        w = np.linalg.solve(M, K @ basis[-1])
        diagonal.append(float(basis[-1] @ M @ w))
        for _ in range(2):
            w = w - np.column_stack(basis) @ (np.column_stack(basis).T @ M @ w)
        beside.append(max(float(w @ M @ w), 0.0) ** 0.5)
        basis.append(np.asarray(w / (beside[-1] or 1.0), dtype=float))
    V = np.column_stack(basis[:order])
    return np.array(diagonal), np.array(beside[: order - 1]), V


def modes(model: LinearModel) -> tuple[Array, Array]:
    """Return squared frequencies and the contact point's share of each mode."""
    M, K, j = dense(model)
    squares, shapes = scipy.linalg.eigh(K, M)
    return squares, shapes.T @ j
