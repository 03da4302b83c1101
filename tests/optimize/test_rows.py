# SPDX-License-Identifier: BSD-3-Clause
"""Functions evaluated row by row give what CasADi's own calls give."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from softimpact.optimize.search.rows import AT_ONCE, by_rows


@pytest.mark.parametrize("rows", [0, 1, AT_ONCE - 1, AT_ONCE, 2 * AT_ONCE + 3])
def test_rows_are_those_of_calls(rows: int) -> None:
    x, p = ca.SX.sym("x", 3), ca.SX.sym("p", 2)
    y = ca.vertcat(ca.dot(x, x) * p[0], x[0] * p[1])
    function = ca.Function("y", [x, p], [y, ca.densify(ca.jacobian(y, x))])
    random = np.random.default_rng(0)
    at, given = random.normal(size=(rows, 3)), random.normal(size=(rows, 2))
    values, slopes = by_rows(function, at, given)
    assert values.shape == (rows, 2)
    assert slopes.shape == (rows, 6)
    for k in range(rows):
        value, slope = function(at[k], given[k])
        assert values[k] == pytest.approx(value.full().ravel(), rel=1e-15)
        as_matrix = slopes[k].reshape(3, 2).T
        assert as_matrix == pytest.approx(slope.full(), rel=1e-15)


@pytest.mark.parametrize("rows", [1, AT_ONCE])
def test_arguments_that_are_not_given_are_zero(rows: int) -> None:
    x, p = ca.SX.sym("x"), ca.SX.sym("p")
    function = ca.Function("sum", [x, p], [x + p])
    assert (by_rows(function, np.full((rows, 1), 2.0))[0] == 2.0).all()
