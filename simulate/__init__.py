# SPDX-License-Identifier: BSD-3-Clause
"""Time simulation of impacts: full nonlinear, linearised, chain, two masses, one mass."""

from .approach import Approach
from .controller import Controller, Reference
from .decoupling import Decoupling, decoupling_stiffness, is_isolated, scaled_springs
from .history import HORIZON, Fidelity, ImpactHistory, PeakDefinition
from .impact import simulate_impact
from .safe_speed import largest_safe_speed
from .simulator import SimulationFailed

__all__ = [
    "HORIZON",
    "Approach",
    "Controller",
    "Decoupling",
    "Fidelity",
    "ImpactHistory",
    "PeakDefinition",
    "Reference",
    "SimulationFailed",
    "decoupling_stiffness",
    "is_isolated",
    "largest_safe_speed",
    "scaled_springs",
    "simulate_impact",
]
