# SPDX-License-Identifier: BSD-3-Clause
"""Sine and cosine in single precision at once, as float builds of a package compute them.

For the two of an angle newlib takes some 160 instructions on a Cortex-M4F, and 90 on a Cortex-M7,
whose double registers it uses; this takes 55, as one call computes those of all angles.
The angle is reduced by quarter turns, which are subtracted in three parts so that the products are
exact, and the polynomials are least-error fits of (sin r − r)/r³ and (cos r − 1 + r²/2)/r⁴ over
r² for |r| ≤ π/4.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

LIMIT = 200.0
"""Angle [rad] from which on a package takes whole turns off first."""

TURN = math.tau
"""What is taken off [rad]; rounding it is less than half a unit in the last place of the angle."""

PER_QUARTER = 0.636619772
"""Quarter turns in a radian."""

ADDED = 128.0
"""Quarter turns added while the nearest is sought: whole turns, and more than ``LIMIT`` has."""

QUARTER = (1.5703125, 4.83751296997070e-4, 7.54978995489188e-8)
"""A quarter turn in three parts [rad]."""

SINE = (-0.166666552, 0.00833217334, -0.000195166562)
COSINE = (0.0416666456, -0.00138873619, 2.44377297e-05)

ERROR = 1.2e-7
"""Bound of the error of both."""


def sine_and_cosine(x: NDArray[np.float32]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return sine and cosine of angles [rad], rounded as the C code rounds.

    Args:
        x: single precision, less than ``LIMIT``.
    """
    f = np.float32
    quarter = (x * f(PER_QUARTER) + f(ADDED + 0.5)).astype(np.int64)
    k = quarter.astype(f) - f(ADDED)
    r = ((x - k * f(QUARTER[0])) - k * f(QUARTER[1])) - k * f(QUARTER[2])
    z = r * r
    sine = r + r * z * (f(SINE[0]) + z * (f(SINE[1]) + z * f(SINE[2])))
    cosine = f(COSINE[0]) + z * (f(COSINE[1]) + z * f(COSINE[2]))
    cosine = f(1.0) - f(0.5) * z + z * z * cosine
    odd = quarter % 2 == 1
    first, second = np.where(odd, cosine, sine), np.where(odd, sine, cosine)
    return (
        np.where(quarter % 4 >= 2, -first, first),
        np.where((quarter + 1) % 4 >= 2, -second, second),
    )


def sine(x: NDArray[Any]) -> NDArray[Any]:
    """Return the sine in the precision of x."""
    return sine_and_cosine(x)[0] if x.dtype == np.float32 else np.asarray(np.sin(x))


def cosine(x: NDArray[Any]) -> NDArray[Any]:
    """Return the cosine in the precision of x."""
    return sine_and_cosine(x)[1] if x.dtype == np.float32 else np.asarray(np.cos(x))
