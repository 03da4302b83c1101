# SPDX-License-Identifier: BSD-3-Clause
"""Linear algebra over any kind of matrix."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from oracles import assert_near
from symbol_kinds import KINDS

from softimpact.symbolic import Matrix, count_flops, load_robot
from softimpact.symbolic.dynamics.equations_of_motion import _mass_matrix
from softimpact.symbolic.matrices import (
    Factorisation,
    OrthogonalRows,
    _as_function,
    on_scalars,
    symmetric,
)


def positive_definite(n: int, seed: int = 0) -> np.ndarray:
    """Return a random symmetric positive definite matrix."""
    half = np.random.default_rng(seed).normal(size=(n, n))
    return half @ half.T + 0.1 * np.eye(n)


@pytest.mark.parametrize("n", [1, 2, 7])
def test_factorisation_solves_and_measures(n: int) -> None:
    M, b = positive_definite(n), np.random.default_rng(1).normal(size=(n, 3))
    factors = Factorisation(ca.DM(M))
    assert_near(factors.solve(ca.DM(b)), np.linalg.solve(M, b))
    y = [factors.halfway(ca.DM(b[:, k])) for k in range(3)]
    gram = [[float(factors.inner(first, second)) for second in y] for first in y]
    assert_near(gram, b.T @ np.linalg.solve(M, b))


@pytest.mark.parametrize("kind", KINDS)
def test_factorisation_of_symbols_gives_the_same_numbers(kind: Matrix) -> None:
    M, b = positive_definite(4), np.random.default_rng(1).normal(size=(4, 2))
    symbol, right = kind.sym("M", 4, 4), kind.sym("b", 4, 2)
    solve = ca.Function("solve", [symbol, right], [Factorisation(symbol).solve(right)])
    assert_near(solve(M, b), np.linalg.solve(M, b))


@pytest.mark.parametrize("n", [3, 7])
def test_orthogonal_rows_span_a_volume_and_invert(n: int) -> None:
    J = np.random.default_rng(n).normal(size=(3, n))
    rows = OrthogonalRows(ca.DM(J))
    assert float(rows.volume) == pytest.approx(np.sqrt(np.linalg.det(J @ J.T)), rel=1e-12)
    assert_near(rows.pseudo_inverse, np.linalg.pinv(J))


def test_volume_of_nearly_dependent_rows_keeps_its_digits() -> None:
    """√det(J Jᵀ) is rounding here: JJᵀ holds the gap squared."""
    gap = 1e-9
    J = ca.DM([[1.0, 1.0, 0.0], [1.0, 1.0, gap]])
    assert float(OrthogonalRows(J).volume) == pytest.approx(np.sqrt(2) * gap, rel=1e-12)
    assert float(OrthogonalRows(ca.DM([[0, 0], [2, 1], [4, 2]])).volume) == 0


def test_structural_zeros_cost_nothing() -> None:
    diagonal = Factorisation(ca.diag(ca.SX.sym("d", 5))).solve(ca.SX.sym("b", 5))
    assert count_flops(diagonal) == 5


def test_symmetric_mirrors_the_lower_half() -> None:
    assert_near(
        symmetric(lambda i, j: ca.DM(10 * i + j), 3), [[0, 10, 20], [10, 11, 21], [20, 21, 22]]
    )


def test_count_flops_counts_shared_work_once_and_no_sines() -> None:
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    assert count_flops(x) == 0
    assert count_flops(x + y) == 1
    assert count_flops(ca.vertcat((x + y) * x, (x + y) * y)) == 3
    assert count_flops(ca.sin(x) * ca.cos(y)) == 1
    assert count_flops(ca.sqrt(x) / y) == 2


def test_functions_are_built_once_for_a_robot() -> None:
    robot = replace(load_robot("rr"), name="seen nowhere else")
    before = _as_function.cache_info().misses
    for _ in range(3):
        on_scalars(_mass_matrix, (robot,), np.zeros(4))
    assert _as_function.cache_info().misses == before + 1


def test_a_row_serves_as_a_configuration() -> None:
    robot = load_robot("rr")
    q = np.array([0.1, 0.2, 0.3, 0.4])
    column = on_scalars(_mass_matrix, (robot,), q)
    assert_near(on_scalars(_mass_matrix, (robot,), q[None]), column, 0)
