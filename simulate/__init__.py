# SPDX-License-Identifier: BSD-3-Clause
"""Time simulation of impacts: full nonlinear, linearised, chain, two masses, one mass."""

from .approach import Approach
from .controller import Controller, Reference
from .history import Fidelity, ImpactHistory, PeakDefinition
from .impact import simulate_impact
from .safe_speed import largest_safe_speed
from .simulator import SimulationFailed

__all__ = [
    "Approach",
    "Controller",
    "Fidelity",
    "ImpactHistory",
    "PeakDefinition",
    "Reference",
    "SimulationFailed",
    "largest_safe_speed",
    "simulate_impact",
]
