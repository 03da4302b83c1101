# SPDX-License-Identifier: BSD-3-Clause
"""What an impact did: the contact force over time and its peaks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from softimpact.symbolic import InvalidValue, Motors, UnknownName
from softimpact.symbolic.body.verdict import QUASI_STATIC_FROM
from softimpact.symbolic.record import Record, Row
from softimpact.symbolic.robot.rigid import Array

Fidelity = Literal["one_mass", "two_mass", "chain", "linearised", "full"]
"""Models of the robot, from the simplest to the most faithful."""

PeakDefinition = Literal["peak", "first_contact", "first_peak"]
"""Maximum over all contacts, maximum until separation, or first local maximum (MSM's)."""

HORIZON = QUASI_STATIC_FROM
"""How long forces count by default: as long as the transient limit does [s]."""

LONGEST_HORIZON = 10.0
"""How long forces may count at most [s]: all of an impact is over by then, and steps are finite."""

FASTEST = 1e3
"""Largest speed of an impact [m/s]: no robot comes near, and integrators lose their way beyond."""

PRESSED_UNTIL = 0.6
"""Until when the force is followed that a clamped body still bears after ``HORIZON`` [s]."""


def require_horizon(horizon: float) -> None:
    """Raise InvalidValue unless forces can count for so long [s]."""
    if not 0 < horizon <= LONGEST_HORIZON:
        reason = f"must be greater than 0 and at most {LONGEST_HORIZON:g} s, not {horizon:g}"
        raise InvalidValue("horizon", reason)


def require_speed(speed: float) -> None:
    """Raise InvalidValue unless an impact can be so fast [m/s]."""
    if not 0 < speed <= FASTEST:
        reason = f"must be greater than 0 and at most {FASTEST:g} m/s, not {speed:g}"
        raise InvalidValue("speed", reason)


@dataclass(frozen=True, eq=False)
class ImpactHistory(Record):
    """The contact force of an impact.

    The peaks part where a light mass at the contact point bounces before what is behind it
    arrives, and where the robot hits again.

    Attributes:
        fidelity: of the robot's model.
        motors: what they did; None for the papers' controller and for lone masses.
        time: since first touch [s], length K.
        force: f_c at these times [N].
        reading: of a measuring device at these times [N]: the force in the body's spring, which is
            f_c but for the inertia of a plate.
        peak: largest force over all contacts up to the horizon [N].
        time_of_peak: [s].
        first_contact: largest force until separation [N].
        first_peak: first local maximum [N]; None where the force rises to the end.
        time_of_first_contact_peak: [s].
        time_of_first_peak: [s].
        separation: when the first contact ends [s]; None if it outlasts the simulation.
        pressing: largest force on a clamped body from ``HORIZON`` to ``PRESSED_UNTIL`` [N]; zero
            on a free one; None where the simulation ends before.
        largest_torque: that a servo added to each motor's [N·m], length n; None without a servo.
    """

    fidelity: Fidelity
    motors: Motors | None
    time: Array
    force: Array
    reading: Array
    peak: float
    time_of_peak: float
    first_contact: float
    first_peak: float | None
    time_of_first_contact_peak: float
    time_of_first_peak: float | None
    separation: float | None
    pressing: float | None
    largest_torque: Array | None = None

    def rows(self) -> list[Row]:
        """Return a line for each time."""
        columns = (self.time.tolist(), self.force.tolist(), self.reading.tolist())
        names = ("time", "force", "reading")
        return [dict(zip(names, values, strict=True)) for values in zip(*columns, strict=True)]

    def force_of(self, definition: PeakDefinition = "peak") -> float:
        """Return the peak force [N] of a definition.

        Raises:
            UnknownName: there is no such definition.
            InvalidValue: the force has no local maximum.
        """
        if definition not in get_args(PeakDefinition):
            raise UnknownName("peak definition", definition, get_args(PeakDefinition))
        if definition == "peak":
            return self.peak
        if definition == "first_contact":
            return self.first_contact
        if self.first_peak is None:
            raise InvalidValue("first_peak", "does not exist: the force rises to the end")
        return self.first_peak
