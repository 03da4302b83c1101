# SPDX-License-Identifier: BSD-3-Clause
"""Eigenvalues and eigenvectors of symmetric 3×3 matrices, as expressions without a branch."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from .matrices import Matrix

SWEEPS = 5
"""Rounds of Jacobi rotations; the error falls cubically, and four reach double precision."""

TINY = float(np.finfo(np.float32).tiny)
"""Keeps a rotation finite where nothing is left to rotate; small against any matrix of use."""


@dataclass(frozen=True, eq=False)
class Eigen:
    """Eigenvalues in rising order, length 3, and unit eigenvectors as columns, 3×3."""

    values: Matrix
    vectors: Matrix


def symmetric_eigen(matrix: Matrix) -> Eigen:
    """Return the eigenvalues and eigenvectors of a symmetric 3×3 matrix (cyclic Jacobi).

    Vectors stay orthonormal where eigenvalues meet; their derivatives do not exist there.
    """
    A = [[matrix[max(i, j), min(i, j)] for j in range(3)] for i in range(3)]
    V: list[list[Matrix]] = [[float(i == j) for j in range(3)] for i in range(3)]
    for _ in range(SWEEPS):
        for p, q in ((0, 1), (0, 2), (1, 2)):
            _rotate(A, V, p, q)
    pairs = [(A[k][k], [V[i][k] for i in range(3)]) for k in range(3)]
    for i in (0, 1, 0):
        pairs[i], pairs[i + 1] = _sorted(pairs[i], pairs[i + 1])
    values = ca.vertcat(*[value for value, _ in pairs])
    return Eigen(values, ca.horzcat(*[ca.vertcat(*vector) for _, vector in pairs]))


def _rotate(A: list[list[Matrix]], V: list[list[Matrix]], p: int, q: int) -> None:
    """Turn A's entry (p, q) to zero, and V along (Golub and Van Loan, Matrix Computations, 8.5)."""
    r = 3 - p - q
    off, gap = A[p][q], A[q][q] - A[p][p]
    reach = ca.fabs(gap) + ca.sqrt(gap * gap + 4 * off * off) + TINY
    t = 2 * off * ca.copysign(1, gap) / reach
    c = 1 / ca.sqrt(1 + t * t)
    s = t * c
    A[p][p], A[q][q] = A[p][p] - t * off, A[q][q] + t * off
    A[p][q] = A[q][p] = 0 * off
    toward_p, toward_q = A[r][p], A[r][q]
    A[r][p] = A[p][r] = c * toward_p - s * toward_q
    A[r][q] = A[q][r] = s * toward_p + c * toward_q
    for row in V:
        row[p], row[q] = c * row[p] - s * row[q], s * row[p] + c * row[q]


Pair = tuple[Matrix, list[Matrix]]


def _sorted(first: Pair, second: Pair) -> tuple[Pair, Pair]:
    """Return two eigenpairs, the smaller eigenvalue first."""
    stay = (1 + ca.copysign(1, second[0] - first[0])) / 2

    def pick(a: Matrix, b: Matrix) -> Matrix:
        return b + stay * (a - b)

    def both(a: Pair, b: Pair) -> Pair:
        return pick(a[0], b[0]), [pick(x, y) for x, y in zip(a[1], b[1], strict=True)]

    return both(first, second), both(second, first)
