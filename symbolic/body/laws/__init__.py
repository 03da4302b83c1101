# SPDX-License-Identifier: BSD-3-Clause
"""Laws of contact, one a file; a new one needs nothing else."""

from .curve import Curve
from .law import Law
from .power import HERTZ_EXPONENT, PowerLaw
from .series import Series, in_series

__all__ = ["HERTZ_EXPONENT", "Curve", "Law", "PowerLaw", "Series", "in_series"]
