# SPDX-License-Identifier: BSD-3-Clause
"""Evaluation of a graph in other arithmetics than CasADi's."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from decimal import Context, Decimal, localcontext
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from .exact import DIGITS
from .graph import Graph
from .operations import operation


def evaluate_exactly(
    graph: Graph, arguments: Sequence[Sequence[float | Decimal]]
) -> list[list[float]]:
    """Return all results to the last bit of a double, computed in 50 digits.

    Args:
        graph: what to evaluate.
        arguments: one vector for each of the graph's inputs.
    """
    with localcontext(Context(prec=DIGITS)):
        values = _replay(
            graph,
            Decimal,
            lambda i, k: Decimal(arguments[i][k]),
            lambda number: operation(number).exact,
        )
    return [[float(values[index]) for index in result] for result in graph.results]


def evaluate_rounded(
    graph: Graph, arguments: Sequence[NDArray[np.float64]], kind: type[np.floating[Any]]
) -> list[NDArray[Any]]:
    """Return all results for many samples at once, each operation rounded to ``kind``.

    Args:
        graph: what to evaluate.
        arguments: for each of the graph's inputs, an array of size × samples.
        kind: ``numpy.float32`` or ``numpy.float64``.

    Returns:
        For each result an array of elements × samples.
    """
    narrow = [argument.astype(kind) for argument in arguments]
    samples = arguments[0].shape[1]
    with np.errstate(all="ignore"):
        values = _replay(
            graph,
            lambda value: np.full(samples, value, dtype=kind),
            lambda i, k: narrow[i][k],
            lambda number: operation(number).rounded,
        )
    return [np.array([values[index] for index in result]) for result in graph.results]


def _replay(
    graph: Graph,
    constant: Callable[[float], Any],
    element: Callable[[int, int], Any],
    function: Callable[[int], Callable[..., Any]],
) -> dict[int, Any]:
    """Return the values of all results by node; others are let go after their last use."""
    last = graph.last_uses
    functions = {number: function(number) for number in graph.computations}
    values: dict[int, Any] = {}
    for index, node in enumerate(graph.nodes):
        if node.operation == ca.OP_CONST:
            values[index] = constant(node.value)
        elif node.operation == ca.OP_INPUT:
            values[index] = element(*node.element)
        else:
            values[index] = functions[node.operation](*[values[i] for i in node.operands])
            for i in node.operands:
                if last[i] == index:
                    values.pop(i, None)
    return values
