# SPDX-License-Identifier: BSD-3-Clause
"""Time simulation of impacts: full nonlinear, linearised, chain, two masses, one mass."""

from .approach import Approach
from .history import Fidelity, ImpactHistory, PeakDefinition
from .impact import simulate_impact
from .safe_speed import largest_safe_speed
from .simulator import SimulationFailed

__all__ = [
    "Approach",
    "Fidelity",
    "ImpactHistory",
    "PeakDefinition",
    "SimulationFailed",
    "largest_safe_speed",
    "simulate_impact",
]
