# SPDX-License-Identifier: BSD-3-Clause
"""Time simulation of impacts: full nonlinear, linearised, chain, two masses, one mass."""

from .arrival import Approach
from .assessment import Assessment, assess_impact
from .assessments import Assessments, assess_impacts
from .bracket import bracket
from .controller import Controller, ControllerReference
from .decoupling import Decoupling, decoupling_stiffness, is_isolated, scaled_springs
from .history import HORIZON, Fidelity, ImpactHistory, PeakDefinition
from .impact import simulate_impact, simulate_masses
from .many import many_peaks
from .safe_speed import ForceLimits, largest_safe_speed
from .simulator import SimulationFailed
from .stepping import ManyPeaks

__all__ = [
    "HORIZON",
    "Approach",
    "Assessment",
    "Assessments",
    "Controller",
    "ControllerReference",
    "Decoupling",
    "Fidelity",
    "ForceLimits",
    "ImpactHistory",
    "ManyPeaks",
    "PeakDefinition",
    "SimulationFailed",
    "assess_impact",
    "assess_impacts",
    "bracket",
    "decoupling_stiffness",
    "is_isolated",
    "largest_safe_speed",
    "many_peaks",
    "scaled_springs",
    "simulate_impact",
    "simulate_masses",
]
