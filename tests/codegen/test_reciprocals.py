# SPDX-License-Identifier: BSD-3-Clause
"""Divisions by one number become products with its reciprocal."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from compiled_packages import Generated

from softimpact.codegen.expressions.evaluate import evaluate_exactly
from softimpact.codegen.expressions.graph import graph_of
from softimpact.codegen.expressions.reciprocals import with_reciprocals

X = ca.SX.sym("x", 3)
A, B, C = X[0], X[1], X[2]


@pytest.mark.parametrize(
    ("expression", "divisions"),
    [
        (A / B + C, 1),
        (A / B + C / B, 1),
        (A / B + C / B + 1 / B, 1),
        (A / B + C / (B + C) + A * C / (B + C), 2),
        (1 / B + ca.sin(1 / B), 1),
    ],
)
def test_divisors_are_inverted_once(expression: ca.SX, divisions: int) -> None:
    plain = graph_of([X], [expression])
    graph = with_reciprocals(plain)
    assert graph.count(ca.OP_DIV, ca.OP_INV) == divisions
    for point in np.random.default_rng(1).uniform(0.3, 2, (5, 3)):
        found, right = (evaluate_exactly(g, [point])[0][0] for g in (graph, plain))
        assert found == pytest.approx(right, rel=1e-15)


def test_graphs_without_shared_divisors_stay_as_they_are() -> None:
    plain = graph_of([X], [ca.vertcat(A / B, B / C, A * B * C)])
    assert with_reciprocals(plain) == plain


@pytest.mark.slow
def test_no_function_of_a_package_divides_twice_by_a_number(
    package: Callable[[str], Generated],
) -> None:
    quick = [f for f in package("panda").functions if not f.divides]
    assert len(quick) >= 10
    for function in quick:
        nodes = [n for n in function.graph.nodes if n.operation in (ca.OP_DIV, ca.OP_INV)]
        divisors = [node.operands[-1] for node in nodes]
        assert len(divisors) == len(set(divisors))
