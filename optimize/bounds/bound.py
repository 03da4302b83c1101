# SPDX-License-Identifier: BSD-3-Clause
"""What a bound is: figures of a machine in a posture, and how large or small they may be."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar, Literal, Protocol, Self

from softimpact.symbolic import Matrix

from ..machine.machine import Machine


class Bound(Protocol):
    """A bound, as a frozen dataclass that derives from ``AtMost`` or ``AtLeast``.

    The search asks each figure's share of its limit to be at most one, and evaluates the same
    figures again for all postures when it has ended.

    Attributes:
        kind: its name in the table ``[bounds]`` of a study file.
        unit: of its figures and limit.
        sense: which side of the limit is allowed.
        needs_speed: whether it depends on how fast the study's impacts are.
    """

    kind: ClassVar[str] = ""
    unit: ClassVar[str] = ""
    sense: ClassVar[Literal["most", "least"]]
    needs_speed: ClassVar[bool] = False

    @property
    def limit(self) -> float:
        """The limit, in ``unit``."""
        ...

    @property
    def name(self) -> str:
        """The field of a study file that it stands in."""
        return f"bounds.{self.kind}.{self.sense}"

    def at(self, limit: float) -> Self:
        """Return the bound with another limit."""
        changed: dict[str, Any] = {self.sense: limit}
        return replace(self, **changed)  # type: ignore[type-var]

    def figures(self, machine: Machine, q: Matrix) -> Matrix:
        """Return the figures that are bounded, a column in ``unit``; differentiable.

        Where a figure is approximate, it must be on the safe side.

        Args:
            machine: the robot with the hardware that is sought; expressions.
            q: link angles, length n, an expression.
        """
        ...


class AtMost(Bound, Protocol):
    """A bound whose figures are at least zero and may not exceed ``most``."""

    sense: ClassVar[Literal["most", "least"]] = "most"
    most: float

    @property
    def limit(self) -> float:
        """The limit, in ``unit``."""
        return self.most


class AtLeast(Bound, Protocol):
    """A bound whose figures must reach ``least``."""

    sense: ClassVar[Literal["most", "least"]] = "least"
    least: float

    @property
    def limit(self) -> float:
        """The limit, in ``unit``."""
        return self.least


STEEPNESS = {"most": 2, "least": 1}
"""Slope of a row by the logarithm of its figure where the bound binds."""


def row(sense: str, figures: Matrix, limit: Matrix) -> Matrix:
    """Return what is at most zero where figures keep a limit; smooth where they pass zero."""
    return (figures / limit) ** 2 - 1 if sense == "most" else 1 - figures / limit
