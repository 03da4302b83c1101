# SPDX-License-Identifier: BSD-3-Clause
"""Numbers of the sine and cosine in double precision.

As in ``sine``, with which it shares the form: three parts of a quarter turn whose products with
up to a hundred thousand quarter turns are exact, and polynomials of (sin r − r)/r³ and
(cos r − 1 + r²/2)/r⁴ over r² for |r| ≤ π/4 that interpolate at Chebyshev's nodes.
"""

from __future__ import annotations

import math

LIMIT = 1e5
"""As in ``sine``."""

TURN = math.tau
"""As in ``sine``."""

PER_QUARTER = 0.6366197723675814

ADDED = 65536.0
"""As in ``sine``."""

QUARTER = (1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21)
"""The first two have 33 bits."""

SINE = (
    -0.16666666666666666,
    0.008333333333330948,
    -0.00019841269836758574,
    2.755731610255244e-06,
    -2.5051131845003624e-08,
    1.5918129294866608e-10,
)
COSINE = (
    0.041666666666666664,
    -0.0013888888888887398,
    2.480158729876569e-05,
    -2.7557317271729793e-07,
    2.08761462684032e-09,
    -1.1382632425521717e-11,
)

ERROR = 2e-16
"""Bound of the error of both."""
