# SPDX-License-Identifier: BSD-3-Clause
"""The largest eigenvalue as an expression that is smooth and never too small."""

from __future__ import annotations

import casadi as ca

from softimpact.symbolic import Matrix

SQUARINGS = 8
"""The 256th power: an eigenvalue that occurs n times is found 256√n times too large, 0.3 % for two
and 0.8 % for seven; one that stands alone by 5 %, to 1e-8."""


def largest_eigenvalue(matrix: Matrix) -> Matrix:
    """Return (tr Aᵖ)^(1/p), just above the largest eigenvalue of A, p = 256.

    Args:
        matrix: A, with real eigenvalues of which none is negative; a product of two symmetric
            positive definite matrices has such.
    """
    logarithm: Matrix = 0.0
    for k in range(SQUARINGS + 1):
        size = ca.trace(matrix)
        logarithm = logarithm + ca.log(size) / 2**k
        matrix = matrix / size
        matrix = ca.mtimes(matrix, matrix)
    return ca.exp(logarithm)
