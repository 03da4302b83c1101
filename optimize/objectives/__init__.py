# SPDX-License-Identifier: BSD-3-Clause
"""Objectives of a design, one a file."""

from .objective import Objective, Own
from .worst_force import WorstForce

__all__ = ["Objective", "Own", "WorstForce"]
