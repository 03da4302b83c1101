# SPDX-License-Identifier: BSD-3-Clause
"""Functions in many more digits than a double has, the same on every machine.

Golden vectors must not depend on the C library or the processor of whoever generates them, so
they are computed with ``decimal``, whose results its standard fixes to the last digit.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from typing import Any

import numpy as np

DIGITS = 50
"""Working precision; values printed have 17 digits."""

TWO_PI = Decimal("6.28318530717958647692528676655900576839433879875021164194988918461563281257")


def sine(x: Decimal) -> Decimal:
    """Return sin x by its power series after reduction to one turn."""
    x = x % TWO_PI
    return _series(x, x, 1)


def cosine(x: Decimal) -> Decimal:
    """Return cos x by its power series after reduction to one turn."""
    return _series(x % TWO_PI, Decimal(1), 0)


def _series(x: Decimal, term: Decimal, order: int) -> Decimal:
    total = Decimal(0)
    while abs(term) > Decimal(10) ** -DIGITS:
        total += term
        term *= -x * x / ((order + 1) * (order + 2))
        order += 2
    return total


def correctly_rounded(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a NumPy function that computes in double and rounds to its arguments' precision."""

    def rounded(*arguments: Any) -> Any:
        wide = function(*(np.asarray(a, dtype=np.float64) for a in arguments))
        return wide.astype(arguments[0].dtype)

    return rounded
