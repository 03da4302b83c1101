# SPDX-License-Identifier: BSD-3-Clause
"""The branch-free eigenvalues of 3×3 matrices against LAPACK."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_robots import seeds
from symbol_kinds import KINDS

from softimpact.symbolic import Matrix, symmetric_eigen
from softimpact.symbolic.robot.rigid import Array

spreads = st.sampled_from([(1, 1, 1), (1, 1, 2), (2, 1, 1), (1e-9, 1, 1e6), (0, 0, 1), (-3, 0, 2)])


@given(seeds, spreads)
def test_agrees_with_lapack(seed: int, spread: float) -> None:
    """Also where eigenvalues meet or differ by many decades."""
    turn = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    A = turn @ np.diag(spread) @ turn.T
    found = symmetric_eigen(ca.DM(A))
    values, V = np.array(found.values).ravel(), np.array(found.vectors)
    scale = abs(np.array(spread)).max()
    np.testing.assert_allclose(values, np.sort(spread), atol=1e-14 * scale)
    np.testing.assert_allclose(V.T @ V, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(A @ V, V * values, atol=1e-14 * scale)


@pytest.mark.parametrize("A", [np.zeros((3, 3)), np.eye(3), np.diag([3.0, 1.0, 2.0])])
def test_nothing_to_rotate(A: Array) -> None:
    found = symmetric_eigen(ca.DM(A))
    np.testing.assert_array_equal(np.array(found.values).ravel(), np.sort(np.diag(A)))
    np.testing.assert_allclose(
        A @ np.array(found.vectors),
        np.array(found.vectors) @ np.diag(np.array(found.values).ravel()),
        atol=1e-15,
    )


def test_derivative_of_an_eigenvalue() -> None:
    """dλ = vᵀ dA v."""
    half = np.random.default_rng(4).normal(size=(3, 3))
    A, step = half @ half.T, np.outer([1.0, 2.0, 3.0], [1.0, 2.0, 3.0])
    x = ca.SX.sym("x", 3, 3)
    values = symmetric_eigen(x).values
    slope = ca.Function("slope", [x], [ca.jtimes(values, ca.vec(x), ca.vec(ca.DM(step)))])
    expected = [v @ step @ v for v in np.linalg.eigh(A)[1].T]
    np.testing.assert_allclose(np.array(slope(A)).ravel(), expected, rtol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_symbols_give_the_same_numbers(kind: Matrix) -> None:
    half = np.random.default_rng(5).normal(size=(3, 3))
    x = kind.sym("x", 3, 3)
    found = symmetric_eigen(x)
    numbers = ca.Function("f", [x], [found.values, found.vectors])(half @ half.T)
    exact = symmetric_eigen(ca.DM(half @ half.T))
    np.testing.assert_allclose(np.array(numbers[0]), np.array(exact.values), rtol=1e-12)
    np.testing.assert_allclose(np.array(numbers[1]), np.array(exact.vectors), atol=1e-12)
