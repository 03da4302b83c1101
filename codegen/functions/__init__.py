# SPDX-License-Identifier: BSD-3-Clause
"""What a package computes: its C functions as expressions over one set of symbols."""

from .arrival import impact_chain_of, linear_model_of
from .catalogue import functions_of
from .reductions import CHAIN_ENDS
from .symbols import Symbols, coordinates_of, symbols_of

__all__ = [
    "CHAIN_ENDS",
    "Symbols",
    "coordinates_of",
    "functions_of",
    "impact_chain_of",
    "linear_model_of",
    "symbols_of",
]
