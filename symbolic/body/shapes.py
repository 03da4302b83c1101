# SPDX-License-Identifier: BSD-3-Clause
"""What of the robot touches, and a bound on the pressure under it.

The skin is the pad of a measuring device: rubber that keeps its volume, bonded to something solid,
without friction at the robot, which is rigid. Where the contact is small beside the pad's thickness
the pressure p_H is that on a half-space (Hertz); where it is large, p_T is that of a thin layer,
whose rubber must flow sideways: t³/(3G) ∇²p = −w for the depth w of the surface (Johnson, Contact
Mechanics, §5.8). In between the pressure is below p_H + p_T; tests hold this against the numerical
solution of the layer. Covers are left out: they spread the force further.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from ..errors import InvalidValue
from .pads import HARDEST, Pad

ENDS = 1.5
"""How much higher than along its middle the pressure may be at the rounded ends of an edge."""

CONSTRAINT = 4 / 3
"""E*/E = 1/(1 − ν²) of rubber, ν = 1/2."""


class Shape(Protocol):
    """A shape that touches."""

    def pressure(self, force: float, pad: Pad = HARDEST) -> float:
        """Return a bound on the largest pressure [Pa] under a force [N]; rises with the force."""
        ...


@dataclass(frozen=True)
class Sphere:
    """A ball, or any bump.

    Attributes:
        radius: of its sharpest curvature [m].
    """

    radius: float

    def __post_init__(self) -> None:
        _positive(radius=self.radius)

    def pressure(self, force: float, pad: Pad = HARDEST) -> float:
        """Return a bound on the pressure [Pa] under a force [N].

        p_H = (6 F E*²/(π³R²))^⅓; p_T = 3F/(πa²) with a⁶ = 32 R t³F/(π G).
        """
        E, R, t = pad.modulus, self.radius, pad.thickness
        p_H = math.cbrt(6 * force * (CONSTRAINT * E) ** 2 / (math.pi**3 * R**2))
        square = math.cbrt(32 * R * t**3 * force / (math.pi * E / 3))
        return p_H + (3 * force / (math.pi * square) if force else 0.0)


@dataclass(frozen=True)
class Edge:
    """A rounded edge that lies along the skin; its ends are balls of its radius.

    Attributes:
        radius: of its rounding [m].
        length: of the straight part that touches [m].
    """

    radius: float
    length: float

    def __post_init__(self) -> None:
        _positive(radius=self.radius, length=self.length)

    def pressure(self, force: float, pad: Pad = HARDEST) -> float:
        """Return a bound on the pressure [Pa] under a force [N], with f the force per length.

        p_H = √(f E*/(πR)); p_T = 15f/(16a) with a⁵ = 15 R t³f/(2G); ``ENDS`` times as much at the
        ends, but never more than under a ball of the same radius.
        """
        line = _under_a_line(force / self.length, self.radius, pad)
        return min(ENDS * line, Sphere(self.radius).pressure(force, pad))


def _under_a_line(f: float, R: float, pad: Pad) -> float:
    """Return a bound on the pressure [Pa] under an edge without ends and f [N/m]."""
    E, t = pad.modulus, pad.thickness
    p_H = math.sqrt(f * CONSTRAINT * E / (math.pi * R))
    half_width = (7.5 * R * t**3 * f / (E / 3)) ** 0.2
    return p_H + (15 * f / (16 * half_width) if f else 0.0)


@dataclass(frozen=True)
class Flat:
    """A flat face with a rounded rim.

    Attributes:
        area: of the face [m²].
        rim_radius: of its rounding [m]; a sharp rim has no bound.
    """

    area: float
    rim_radius: float

    def __post_init__(self) -> None:
        _positive(area=self.area, rim_radius=self.rim_radius)

    def pressure(self, force: float, pad: Pad = HARDEST) -> float:
        """Return a bound on the pressure [Pa] under a force [N].

        In the middle at most twice the mean (a round face on a thin layer), at the rim at most that
        of an edge that carries all; it is as long as that of a round face, the shortest. The sum is
        up to five times too much, but holds for square faces, too.
        """
        rim = 2 * math.sqrt(math.pi * self.area)
        return 2 * force / self.area + _under_a_line(force / rim, self.rim_radius, pad)


def shape_from(text: str) -> Shape:
    """Return a shape by its name and lengths in m: ``sphere:R``, ``edge:R,L`` or ``flat:AREA,R``.

    Raises:
        InvalidValue: there is no such shape, or a number is missing or impossible.
    """
    name, _, numbers = text.partition(":")
    if name not in SHAPES:
        raise InvalidValue("shape", f"must be {', '.join(HOW.values())}, not '{text}'")
    try:
        values = [float(number) for number in numbers.split(",")]
    except ValueError:
        values = []
    if len(values) != HOW[name].count(",") + 1:
        raise InvalidValue("shape", f"must be {HOW[name]}, with numbers in m and m², not '{text}'")
    try:
        return SHAPES[name](*values)
    except InvalidValue as error:
        raise InvalidValue(f"shape.{error.field}", error.reason) from None


SHAPES: dict[str, Callable[..., Shape]] = {"sphere": Sphere, "edge": Edge, "flat": Flat}
"""Every shape by the name that the command line has for it."""

HOW = {"sphere": "sphere:RADIUS", "edge": "edge:RADIUS,LENGTH", "flat": "flat:AREA,RIM_RADIUS"}
"""How each is written."""


def force_at_pressure(shape: Shape, pressure: float, pad: Pad = HARDEST) -> float:
    """Return the largest force [N] whose pressure bound is at most ``pressure`` [Pa]."""
    low, high = 0.0, 1.0
    while shape.pressure(high, pad) < pressure:
        low, high = high, 2 * high
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if shape.pressure(middle, pad) <= pressure else (low, middle)
    return low


def _positive(**lengths: float) -> None:
    for field, value in lengths.items():
        if not 0 < value < math.inf:
            raise InvalidValue(field, f"must be finite and greater than 0, not {value}")
