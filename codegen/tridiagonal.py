# SPDX-License-Identifier: BSD-3-Clause
"""Eigenvalues of a chain's tridiagonal matrix, by the steps and in the precision of the C code.

NumPy's ``eigh`` computes in double whatever it is given, and would hide what float loses here.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.floating[Any]]

STEPS, APART = 30, 1e-6
"""Most QL steps for an eigenvalue, and the coupling over diagonal entries that counts as none."""

SLOW, OFF = 1e-2, 1e-5
"""Shares of the largest eigenvalue: below which one is sharpened, and how far off it may be."""


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


def sharpened(mass: Numbers, stiffness: Numbers, squared: Numbers) -> Numbers:
    """Return a chain's squared frequencies with the slow ones right by themselves.

    QL's errors are shares of the largest. A step of Newton's on the dynamic stiffness at the first
    mass, built up from the last without a difference of springs, leaves shares of each.

    Args:
        mass: n masses.
        stiffness: n springs, the last to ground.
        squared: eigenvalues by QL.
    """
    most = squared.max()
    found = squared.copy()
    for k in np.flatnonzero(squared < squared.dtype.type(SLOW) * most):
        z, slope = stiffness[-1] - squared[k] * mass[-1], -mass[-1]
        for m, spring in zip(mass[-2::-1], stiffness[-2::-1], strict=True):
            share = spring / (z + spring)
            z, slope = z * share - squared[k] * m, slope * share * share - m
        change = z / slope
        if abs(change) <= squared.dtype.type(OFF) * most:
            found[k] -= change
    return found
