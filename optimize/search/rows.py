# SPDX-License-Identifier: BSD-3-Clause
"""CasADi functions evaluated on the rows of arrays, without CasADi's own matrices in between.

For a few rows these would cost as much as the impacts that are simulated.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from softimpact.symbolic.robot.rigid import Array

AT_ONCE = 64
"""Rows evaluated in one call, where there are as many."""


@lru_cache(maxsize=32)
def loaded(serialised: str) -> ca.Function:
    """Return a function that was sent as text."""
    return ca.Function.deserialize(serialised)


def by_rows(function: ca.Function, *arguments: Array) -> list[Array]:
    """Return what a function of dense vectors makes of each row of its arguments.

    Args:
        function: its first inputs are the arguments; others are zero.
        arguments: m×size each, in matrices column by column.

    Returns:
        for each output m×size; a matrix is one row of m, column by column.

    Raises:
        RuntimeError: the function failed.
    """
    given = [np.ascontiguousarray(each, dtype=float) for each in arguments]
    rows = len(given[0])
    found = [np.empty((rows, function.nnz_out(i))) for i in range(function.n_out())]
    many = rows - rows % AT_ONCE
    for begin in range(0, many, AT_ONCE):
        some = slice(begin, begin + AT_ONCE)
        columns = zip(function.name_in(), (each[some].T for each in given), strict=False)
        together = function.map(AT_ONCE)(**dict(columns))
        for each, name in zip(found, function.name_out(), strict=True):
            each[some] = together[name].full().T.reshape(AT_ONCE, -1)
    buffer: Any  # CasADi's stubs want what its Python does not take
    buffer, evaluate = function.buffer()
    row = [np.empty(each.shape[1]) for each in given]
    made = [np.empty(each.shape[1]) for each in found]
    for i, argument in enumerate(row):
        buffer.set_arg(i, argument.data)
    for i, result in enumerate(made):
        buffer.set_res(i, result.data)
    for k in range(many, rows):
        for argument, each in zip(row, given, strict=True):
            argument[:] = each[k]
        evaluate()
        if buffer.ret():
            raise RuntimeError(f"{function.name()} failed")
        for result, each in zip(made, found, strict=True):
            each[k] = result
    return found
