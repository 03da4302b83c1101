# SPDX-License-Identifier: BSD-3-Clause
"""Bounds on a design, one a file; the search stacks whatever is here."""

from .bound import STEEPNESS, AtLeast, AtMost, Bound, row
from .deflection import Deflection

__all__ = ["STEEPNESS", "AtLeast", "AtMost", "Bound", "Deflection", "row"]
