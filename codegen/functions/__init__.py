# SPDX-License-Identifier: BSD-3-Clause
"""What a package computes: its C functions as expressions over one set of symbols."""

from .arrival import has_potential, links_of
from .catalogue import functions_of
from .stages import stages_of
from .symbols import Symbols, coordinates_of, symbols_of

__all__ = [
    "Symbols",
    "coordinates_of",
    "functions_of",
    "has_potential",
    "links_of",
    "stages_of",
    "symbols_of",
]
