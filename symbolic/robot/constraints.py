# SPDX-License-Identifier: BSD-3-Clause
"""What ties a robot's joints together besides its tree: loops, couplings, welds and tendons."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from ..matrices import Matrix

Terms = tuple[tuple[str, float], ...]
"""Names of joints and their coefficients."""


@dataclass(frozen=True)
class Loop:
    """Two frames of a closed chain whose origins coincide, by name."""

    name: str
    first: str
    second: str


@dataclass(frozen=True)
class Weld:
    """Two frames that a file holds together in all six directions; no model of ours does."""

    name: str
    first: str
    second: str


@dataclass(frozen=True)
class Ball:
    """Three hinges that stand for a ball joint; good for welding them, not for moving them."""

    name: str
    joints: tuple[str, ...]


@dataclass(frozen=True)
class Through:
    """What pulls on joints along a path through space; no model of ours knows it.

    Attributes:
        name: of the element.
        joints: that it crosses.
        what: it does, in words: ``the spring of tendon 't'``.
    """

    name: str
    joints: tuple[str, ...]
    what: str


@dataclass(frozen=True)
class Coupling:
    """Joints tied by gears, belts or tendons: Σ aᵢ qᵢ = offset + p(Σ bⱼ qⱼ − reference).

    URDF ``mimic``, and MJCF ``equality`` of ``joint`` and of fixed tendons.

    Attributes:
        name: of the element.
        driven: joints on the left with their coefficients a.
        leading: joints on the right with their coefficients b; none holds the left side still.
        polynomial: coefficients of p, that of the constant first.
        offset: of the left side [rad, m].
        reference: of the right side [rad, m].
    """

    name: str
    driven: Terms
    leading: Terms
    polynomial: tuple[float, ...]
    offset: float = 0.0
    reference: float = 0.0

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of all joints that it ties."""
        return tuple(name for name, _ in self.driven + self.leading)

    @property
    def follower(self) -> str | None:
        """The joint that follows from the others, where there is just one on the left."""
        return self.driven[0][0] if len(self.driven) == 1 else None

    def gap(self, coordinate: Callable[[str], Matrix]) -> Matrix:
        """Return left side minus right side, from each joint's coordinate."""
        return self._weighed(self.driven, coordinate) - self._right(coordinate)

    def follow(self, coordinate: Callable[[str], Matrix]) -> Matrix:
        """Return the follower's coordinate from the leading joints'."""
        return self._right(coordinate) / self.driven[0][1]

    def _right(self, coordinate: Callable[[str], Matrix]) -> Matrix:
        x = self._weighed(self.leading, coordinate) - self.reference
        total = 0.0 * x
        for coefficient in reversed(self.polynomial):  # Horner
            total = total * x + coefficient
        return total + self.offset

    @staticmethod
    def _weighed(terms: Terms, coordinate: Callable[[str], Matrix]) -> Matrix:
        return sum((weight * coordinate(name) for name, weight in terms), start=0.0)

    def with_locked(self, locked: Mapping[str, float]) -> Coupling:
        """Return what is left of the coupling when some joints stand still."""
        left = sum(a * locked[name] for name, a in self.driven if name in locked)
        right = sum(b * locked[name] for name, b in self.leading if name in locked)
        return replace(
            self,
            driven=tuple(term for term in self.driven if term[0] not in locked),
            leading=tuple(term for term in self.leading if term[0] not in locked),
            offset=self.offset - left,
            reference=self.reference - right,
        )


Constraint = Loop | Coupling | Weld | Ball | Through
"""An equation between a robot's joints, or what no model of ours knows of them."""


@dataclass(frozen=True)
class Tendon:
    """A fixed tendon, of length Σ cᵢ qᵢ, with inertia or a spring of its own.

    Attributes:
        name: of the element.
        terms: joints and their coefficients c.
        armature: inertia of what turns or slides with its length [kg m², kg].
        stiffness: of a spring on its length [N·m/rad, N/m].
        rest: length at which that spring is unloaded.
    """

    name: str
    terms: Terms
    armature: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
