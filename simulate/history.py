# SPDX-License-Identifier: BSD-3-Clause
"""What an impact did: the contact force over time and its peaks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from softimpact.symbolic import UnknownName
from softimpact.symbolic.robot.rigid import Array

Fidelity = Literal["one_mass", "two_mass", "chain", "linearised", "full"]
"""Models of the robot, from the simplest to the most faithful."""

PeakDefinition = Literal["first_contact", "first_peak"]
"""Maximum until separation, or first local maximum (MSM's)."""


@dataclass(frozen=True, eq=False)
class ImpactHistory:
    """The contact force of an impact.

    The two peaks part where a light mass at the contact point bounces before what is behind it
    arrives.

    Attributes:
        fidelity: of the robot's model.
        time: since first touch [s], length K.
        force: f_c at these times [N].
        first_contact: largest force until separation [N].
        first_peak: first local maximum [N].
        time_of_first_contact_peak: [s].
        time_of_first_peak: [s].
        separation: when the first contact ends [s]; None if it outlasts the simulation.
    """

    fidelity: Fidelity
    time: Array
    force: Array
    first_contact: float
    first_peak: float
    time_of_first_contact_peak: float
    time_of_first_peak: float
    separation: float | None

    def peak(self, definition: PeakDefinition = "first_contact") -> float:
        """Return the peak force [N] of a definition; raises UnknownName."""
        if definition not in get_args(PeakDefinition):
            raise UnknownName("peak definition", definition, get_args(PeakDefinition))
        return self.first_peak if definition == "first_peak" else self.first_contact
