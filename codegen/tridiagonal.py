# SPDX-License-Identifier: BSD-3-Clause
"""Eigenvalues of a symmetric tridiagonal matrix, by the steps and in the precision of the C code.

NumPy's ``eigh`` computes in double whatever it is given, and would hide what float loses here.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.floating[Any]]

STEPS, APART = 30, 1e-6
"""Most QL steps for an eigenvalue, and the coupling over diagonal entries that counts as none."""


def eigen_rows(diagonal: Numbers, off: Numbers, rows: Numbers) -> tuple[Numbers, Numbers]:
    """Return the eigenvalues, and rows of numbers turned into the eigenvectors' axes.

    QL with implicit shifts keeps small eigenvalues accurate if entries grow downwards.

    Args:
        diagonal: n entries.
        off: n − 1 entries beside it.
        rows: any number of rows of n entries.

    Raises:
        ArithmeticError: if an eigenvalue takes more steps than C would.
    """
    d, x = diagonal.copy(), rows.copy()
    e = np.append(off, off.dtype.type(0))
    for first in range(len(d)):
        for _ in range(STEPS + 1):
            last = _end_of_block(d, e, first)
            if last == first:
                break
            _sweep(d, e, x, first, last)
        else:
            raise ArithmeticError("QL does not converge")
    return d, x


def _end_of_block(d: Numbers, e: Numbers, first: int) -> int:
    last = first
    while last + 1 < len(d) and abs(e[last]) > APART * (abs(d[last]) + abs(d[last + 1])):
        last += 1
    return last


def _sweep(d: Numbers, e: Numbers, x: Numbers, first: int, last: int) -> None:
    half = (d[first + 1] - d[first]) / (e[first] + e[first])
    length = np.sqrt(half * half + 1)
    g = d[last] - d[first] + e[first] / (half + (-length if half < 0 else length))
    s, c, p = type(g)(1), type(g)(1), type(g)(0)
    for i in range(last - 1, first - 1, -1):
        f, b = s * e[i], c * e[i]
        r = np.sqrt(f * f + g * g)
        e[i + 1] = r
        if not r > 0:  # the rotation is none: the matrix falls apart here
            d[i + 1] -= p
            e[last] = 0
            return
        s, c = f / r, g / r
        g = d[i + 1] - p
        t = (d[i] - g) * s + 2 * c * b
        p = s * t
        d[i + 1] = g + p
        g = c * t - b
        x[:, i], x[:, i + 1] = c * x[:, i] - s * x[:, i + 1], s * x[:, i] + c * x[:, i + 1]
    d[first] -= p
    e[first] = g
    e[last] = 0
