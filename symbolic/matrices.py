# SPDX-License-Identifier: BSD-3-Clause
"""CasADi matrices of any kind (SX, MX, DM), and the linear algebra the physics needs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, TypeVar

import casadi as ca
import numpy as np
from numpy.typing import NDArray

LEAST_SQUARE = float(np.finfo(np.float32).tiny)
"""Keeps the share of a row of zeros finite; it is lost in the square of any other."""

Matrix = ca.SX | Any
"""A CasADi matrix: SX, MX or DM, in formulas that mix them with each other and with numbers.

A checker takes anything for one, and holds what is done with it against SX: names that no matrix
has, and matrices where something else is wanted, are noticed. CasADi's types have no common base
that can be calculated with, and its stubs refuse SX with MX: a union of the three fails 1,200
times. Public functions of a robot say by overloads that they return the kind they are given
(``Kind``), and DM for ``Numbers``.
"""

MatrixExpression = ca.MX | Any
"""The same where it is MX in truth, as in programs for Ipopt: held against MX."""

Kind = TypeVar("Kind", ca.SX, ca.MX, ca.DM)
"""The kind of matrix that is given, and returned."""

Numbers = Sequence[float] | NDArray[Any]
"""Numbers that become a DM."""


@lru_cache(maxsize=256)
def _as_function(
    build: Callable[..., Matrix], sizes: tuple[int, ...], key: tuple[Any, ...]
) -> ca.Function:
    symbols = [ca.SX.sym(f"x{i}", size) for i, size in enumerate(sizes)]
    return ca.Function(build.__name__.strip("_"), symbols, [ca.cse(build(*key, *symbols))])


def on_scalars(build: Callable[..., Matrix], key: tuple[Any, ...], *arguments: Matrix) -> Matrix:
    """Evaluate ``build(*key, *arguments)``, which works on scalars, for any kind of matrix.

    SX arguments enter the expression itself; MX and DM arguments go through a cached Function.
    """
    if any(isinstance(argument, ca.SX) for argument in arguments):
        found = build(*key, *arguments)
        return found if isinstance(found, ca.SX) else ca.SX(found)  # what depends on no argument
    columns = [
        argument if isinstance(argument, ca.MX) else ca.DM(argument) for argument in arguments
    ]
    return _as_function(build, tuple(column.numel() for column in columns), key)(*columns)


class Factorisation:
    """M = L D Lᵀ of a symmetric positive definite matrix, without square roots.

    Works entry by entry, so that an SX graph holds no operation on a structural zero.
    """

    def __init__(self, matrix: Matrix) -> None:
        n = matrix.shape[0]
        self.n = n
        self.l: list[list[Matrix]] = [[] for _ in range(n)]
        self.d: list[Matrix] = []
        u: list[list[Matrix]] = [[] for _ in range(n)]  # L D
        for j in range(n):
            self.d.append(matrix[j, j] - _dot(self.l[j], u[j]))
            for i in range(j + 1, n):
                u[i].append(matrix[i, j] - _dot(self.l[i], u[j]))
                self.l[i].append(u[i][j] / self.d[j])

    def halfway(self, column: Matrix) -> list[Matrix]:
        """Return y with L y = column; then xᵀM⁻¹x = Σ y²/d."""
        y: list[Matrix] = []
        for i in range(self.n):
            y.append(column[i] - _dot(self.l[i], y))
        return y

    def solve(self, columns: Matrix) -> Matrix:
        """Return M⁻¹ columns."""
        return ca.horzcat(*[self._solve_one(columns[:, j]) for j in range(columns.shape[1])])

    def _solve_one(self, column: Matrix) -> Matrix:
        x = [y / d for y, d in zip(self.halfway(column), self.d, strict=True)]
        for i in reversed(range(self.n)):
            x[i] = x[i] - _dot([self.l[k][i] for k in range(i + 1, self.n)], x[i + 1 :])
        return ca.vertcat(*x)

    def inner(self, first: list[Matrix], second: list[Matrix]) -> Matrix:
        """Return aᵀM⁻¹b from the halfway solutions of a and b."""
        return _dot(first, [b / d for b, d in zip(second, self.d, strict=True)])


class OrthogonalRows:
    """J = L R of a matrix with full row rank: L unit lower triangular, the rows of R orthogonal.

    Gram and Schmidt's process without square roots. A row that depends on those before it leaves
    next to nothing, which counts as a row of zeros.
    """

    def __init__(self, matrix: Matrix) -> None:
        self.rows: list[Matrix] = []
        self.squares: list[Matrix] = []
        self.l: list[list[Matrix]] = []
        for i in range(matrix.shape[0]):
            row, shares = matrix[i, :], []
            for other, square in zip(self.rows, self.squares, strict=True):
                shares.append(ca.dot(row, other) / (square + LEAST_SQUARE))
                row = row - shares[-1] * other
            self.l.append(shares)
            self.rows.append(row)
            self.squares.append(ca.sumsqr(row))

    @property
    def volume(self) -> Matrix:
        """√det(J Jᵀ), the volume that the rows span."""
        product: Matrix = 1.0
        for square in self.squares:
            product = product * square
        return ca.sqrt(product)

    @property
    def pseudo_inverse(self) -> Matrix:
        """J⁺ = Jᵀ(J Jᵀ)⁻¹, one column for each row of J."""
        columns = [row / square for row, square in zip(self.rows, self.squares, strict=True)]
        for i in reversed(range(len(columns))):
            for k in range(i + 1, len(columns)):
                columns[i] = columns[i] - self.l[k][i] * columns[k]
        return ca.vertcat(*columns).T


def _dot(first: list[Matrix], second: list[Matrix]) -> Matrix:
    total: Matrix = 0.0
    for a, b in zip(first, second, strict=True):
        total = total + a * b
    return total


def symmetric(entries: Callable[[int, int], Matrix], n: int) -> Matrix:
    """Return the n×n matrix with the given entries on and below the diagonal, mirrored above."""
    lower = {(i, j): entries(i, j) for i in range(n) for j in range(i + 1)}
    rows = [ca.horzcat(*[lower[max(i, j), min(i, j)] for j in range(n)]) for i in range(n)]
    return ca.vertcat(*rows)


def count_flops(expression: Matrix) -> int:
    """Number of additions, multiplications and the like in an SX expression.

    Shared subexpressions count once; sines, cosines and the reading of inputs do not count.
    """
    symbols = ca.symvar(ca.veccat(expression))
    function = ca.Function("count", symbols, [ca.cse(expression)])
    free = {ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST, ca.OP_SIN, ca.OP_COS, ca.OP_PARAMETER}
    operations = [function.instruction_id(k) for k in range(function.n_instructions())]
    return sum(operation not in free for operation in operations)
