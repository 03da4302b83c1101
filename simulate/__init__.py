# SPDX-License-Identifier: BSD-3-Clause
"""Time simulation of impacts: full nonlinear, linearised, chain, two masses, one mass."""

from .approach import Approach
from .history import Fidelity, ImpactHistory, PeakDefinition
from .impact import simulate_impact
from .simulator import SimulationFailed

__all__ = [
    "Approach",
    "Fidelity",
    "ImpactHistory",
    "PeakDefinition",
    "SimulationFailed",
    "simulate_impact",
]
