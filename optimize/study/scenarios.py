# SPDX-License-Identifier: BSD-3-Clause
"""Scenarios: the many ways in which one machine meets people, held as their axes alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from softimpact.symbolic import Contact, Motors
from softimpact.symbolic.robot.rigid import Array, Indices

from ..impact.impact_program import impact_numbers
from .poses import Candidate
from .study import transient_limit


class Scenario(NamedTuple):
    """One impact, by its places on the axes of ``Scenarios``."""

    pose: int
    point: int
    direction: int
    contact: int
    payload: int
    speed: int
    motors: int


@dataclass(frozen=True, eq=False)
class Scenarios:
    """All impacts that a design must bear: the product of its axes, or a list of rows of it.

    What motors may do is an axis like the others: where it is unknown both ends are scenarios.

    Attributes:
        poses: postures that serve their tasks.
        points: frames that hit.
        directions: unit vectors, D×3.
        contacts: what is hit.
        payloads: at the end of the arm [kg].
        speeds: [m/s].
        motors: what they do.
        rows: places on all axes but the motors', for a list; None for the product.
        allowed: share of the regions' limits that counts as the limit.
    """

    poses: tuple[Candidate, ...]
    points: tuple[str, ...]
    directions: Array
    contacts: tuple[Contact, ...]
    payloads: tuple[float, ...]
    speeds: tuple[float, ...]
    motors: tuple[Motors, ...]
    rows: Indices | None = None
    allowed: float = 1.0

    @property
    def _sizes(self) -> tuple[int, ...]:
        axes = (self.poses, self.points, self.directions, self.contacts, self.payloads, self.speeds)
        return tuple(len(axis) for axis in axes)

    def __len__(self) -> int:
        """Return the number of impacts."""
        count = len(self.rows) if self.rows is not None else int(np.prod(self._sizes))
        return count * len(self.motors)

    def at(self, begin: int, end: int) -> Indices:
        """Return the places of some scenarios, (end − begin)×7; nothing else is made of them."""
        which, motors = np.divmod(np.arange(begin, end), len(self.motors))
        if self.rows is not None:
            places = self.rows[which]
        else:
            places = np.column_stack(np.unravel_index(which, self._sizes))
        return np.column_stack([places, motors]).astype(np.int64)

    def __getitem__(self, index: int) -> Scenario:
        """Return a scenario by its number."""
        return Scenario(*(int(i) for i in self.at(index, index + 1)[0]))

    def groups(self) -> Iterator[Scenario]:
        """Yield one scenario for each pose, point and direction that occurs."""
        if self.rows is not None:
            seen = np.unique(self.rows[:, :3], axis=0)
        else:
            count = int(np.prod(self._sizes[:3]))
            seen = np.column_stack(np.unravel_index(np.arange(count), self._sizes[:3]))
        for pose, point, direction in seen:
            yield Scenario(int(pose), int(point), int(direction), 0, 0, 0, 0)

    def numbers(self, one: Scenario, step: float) -> Array:
        """Return an impact's numbers as the compiled program takes them."""
        return impact_numbers(
            self.directions[one.direction],
            self.speeds[one.speed],
            self.contacts[one.contact],
            self.motors[one.motors],
            step,
            self.payloads[one.payload],
        )

    @property
    def limits(self) -> Array:
        """Force that reaches a transient limit of each contact [N], times what is allowed of it."""
        return self.allowed * np.array([transient_limit(contact) for contact in self.contacts])

    def limit(self, one: Scenario) -> float:
        """Return the largest force that a scenario allows [N]."""
        return float(self.limits[one.contact])

    def faster(self, factor: float) -> Scenarios:
        """Return the scenarios with all speeds times a factor."""
        return replace(self, speeds=tuple(factor * speed for speed in self.speeds))

    def within(self, share: float) -> Scenarios:
        """Return the scenarios with a share of the regions' limits allowed."""
        return replace(self, allowed=share)

    def describe(self, one: Scenario) -> dict[str, object]:
        """Return a scenario in words and numbers."""
        contact = self.contacts[one.contact]
        return {
            "pose": self.poses[one.pose].pose.name,
            "point": self.points[one.point],
            "direction": self.directions[one.direction].tolist(),
            "region": contact.region.name,
            "clamped": contact.clamped,
            "payload": self.payloads[one.payload],
            "speed": self.speeds[one.speed],
            "motors": self.motors[one.motors].kind,
        }
