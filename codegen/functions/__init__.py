# SPDX-License-Identifier: BSD-3-Clause
"""What a package computes: its C functions as expressions over one set of symbols."""

from .arrival import impact_chain_of, linear_model_of
from .catalogue import functions_of
from .reductions import CHAIN_ENDS
from .symbols import coordinates_of, is_elastic, model_of, parameters_of

__all__ = [
    "CHAIN_ENDS",
    "coordinates_of",
    "functions_of",
    "impact_chain_of",
    "is_elastic",
    "linear_model_of",
    "model_of",
    "parameters_of",
]
