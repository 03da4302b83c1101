# SPDX-License-Identifier: BSD-3-Clause
"""Where and when somebody may be met: boxes in the robot's cell and spans of its program's time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic import Contact, InvalidValue
from softimpact.symbolic.body.shapes import Shape
from softimpact.symbolic.body.verdict import Limits, limits_of
from softimpact.symbolic.robot.rigid import Array


@dataclass(frozen=True)
class Zone:
    """A box, a span of time, or both at once.

    Attributes:
        name: of it.
        lower: corner of the box with the least coordinates, in the robot's base [m].
        upper: the opposite one.
        begin: of the span, in the program's own time [s].
        end: of the span.
    """

    name: str
    lower: tuple[float, float, float] = (-np.inf, -np.inf, -np.inf)
    upper: tuple[float, float, float] = (np.inf, np.inf, np.inf)
    begin: float = -np.inf
    end: float = np.inf

    def check(self) -> None:
        """Raise InvalidValue if it holds nothing."""
        if not all(low < high for low, high in zip(self.lower, self.upper, strict=True)):
            raise InvalidValue(f"zones.{self.name}.box", "needs a lower and an upper corner [m]")
        if not self.begin < self.end:
            raise InvalidValue(f"zones.{self.name}.time", "needs a begin and a later end [s]")

    def holds(self, time: Array, place: Array, way: Array) -> NDArray[np.bool_]:
        """Return which samples may be within.

        Args:
            time: of the samples [s].
            place: of a point there, S×3 [m].
            way: farthest that the point goes from there to a sample beside it [m]; by that much
                the box counts as larger, as nobody looks between samples.
        """
        within = (time >= self.begin) & (time <= self.end)
        for axis in range(3):
            within &= place[:, axis] >= self.lower[axis] - way
            within &= place[:, axis] <= self.upper[axis] + way
        return np.asarray(within)


@dataclass(frozen=True, eq=False)
class Somebody:
    """Who may be met.

    Attributes:
        contact: with the region of the body.
        shape: of what touches it; None: pressure is not judged.
        zones: any of which a point must be in; none: everywhere.
    """

    contact: Contact
    shape: Shape | None = None
    zones: Sequence[Zone] = field(default=())

    @property
    def limits(self) -> Limits:
        """What is to be kept."""
        return limits_of(self.contact.region, self.contact.clamped, self.shape)

    def may_be_met(self, time: Array, place: Array, way: Array) -> NDArray[np.bool_]:
        """Return at which samples a point may meet them; see ``Zone.holds``."""
        if not self.zones:
            return np.ones(len(time), dtype=bool)
        within = [zone.holds(time, place, way) for zone in self.zones]
        return np.asarray(np.logical_or.reduce(within))
