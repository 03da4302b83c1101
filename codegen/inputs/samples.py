# SPDX-License-Identifier: BSD-3-Clause
"""Random inputs of a package's functions, the same on every machine.

All numbers have so few binary digits that ``float`` holds them exactly, so that errors measured on
them are those of the computation alone.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic import Joint, JointKind, Robot

from .closed_samples import closed_configurations
from .parameters import SCALARS, Parameter

STEPS_PER_UNIT = 1024
"""Joint coordinates are multiples of 1/1024 rad or m."""

UNLIMITED = {JointKind.HINGE: math.pi, JointKind.SLIDE: 1.0}
"""Largest coordinate sampled of a joint without limits [rad, m]."""

FARTHEST_LIMIT = 128.0
"""Limits farther away than this are none [rad, m]."""

DRAWN = {
    "rotor_inertia": (4, 64, 64),
    "position_gain": (0, 4096, 1),
    "damping_gain": (0, 64, 1),
    "payload_mass": (0, 128, 16),
    "payload_com": (-64, 64, 256),
    "speed": (1, 128, 64),
    "restitution": (0, 64, 64),
    "other_mobility": (0, 64, 64),
    "duration": (0, 64, 1024),
}
"""Least and largest numerator of other numbers sampled, and their denominator."""


@dataclass(frozen=True)
class Sample:
    """Inputs of every function of a package.

    Attributes:
        q: joint coordinates within their limits; of closed chains near home, with closed loops.
        n: direction of any length but zero.
        parameters: one vector a parameter; of one that is frozen, its numbers.
        scalars: one number for each of ``SCALARS``.
    """

    q: tuple[float, ...]
    n: tuple[float, ...]
    parameters: tuple[tuple[float, ...], ...]
    scalars: tuple[float, ...] = (1.0, 0.0, 0.0, 0.02)


def draw_samples(
    robot: Robot, parameters: Sequence[Parameter], count: int, seed: int
) -> list[Sample]:
    """Return random samples; ``random.Random`` promises the same ones everywhere."""
    source = random.Random(seed)
    beside = random.Random(~seed)
    closed = iter(closed_configurations(robot, source, count) if robot.loops else ())

    def configuration() -> tuple[float, ...]:
        if robot.loops:
            return tuple(next(closed).tolist())
        return tuple(_coordinate(source, *_range(joint)) for joint in robot.joints)

    return [
        Sample(
            configuration(),
            _direction(source),
            tuple(_values(source, p) for p in parameters),
            tuple(_value(beside, p.name) for p in SCALARS),
        )
        for _ in range(count)
    ]


def _range(joint: Joint) -> tuple[float, float]:
    """Return between which coordinates a joint is sampled: all that its limits allow."""
    most = UNLIMITED[joint.kind]
    lower = joint.lower if joint.lower >= -FARTHEST_LIMIT else min(-most, joint.upper - most)
    upper = joint.upper if joint.upper <= FARTHEST_LIMIT else max(most, joint.lower + most)
    return lower, upper


def _between(source: random.Random, low: int, high: int) -> int:
    return low + int(source.random() * (high - low + 1))


def _coordinate(source: random.Random, lower: float, upper: float) -> float:
    low, high = math.ceil(lower * STEPS_PER_UNIT), math.floor(upper * STEPS_PER_UNIT)
    if low > high:  # the joint hardly moves
        return float(np.float32((lower + upper) / 2))
    return _between(source, low, high) / STEPS_PER_UNIT


def _direction(source: random.Random) -> tuple[float, ...]:
    while True:
        n = tuple(_between(source, -64, 64) / 32 for _ in range(3))
        if any(n):
            return n


def _values(source: random.Random, parameter: Parameter) -> tuple[float, ...]:
    drawn = tuple(_value(source, parameter.name) for _ in range(parameter.size))
    return drawn if parameter.frozen is None else parameter.frozen


def _value(source: random.Random, name: str) -> float:
    if name == "joint_stiffness":
        return float(math.floor(2 ** (7 + 10 * source.random())))
    low, high, steps = DRAWN[name]
    return _between(source, low, high) / steps


def as_columns(samples: Sequence[Sample]) -> list[NDArray[np.float64]]:
    """Return all inputs of all samples, each as an array of size × samples."""
    rows = [[s.q, s.n, *s.parameters, *((x,) for x in s.scalars)] for s in samples]
    return [np.array(column, dtype=float).T for column in zip(*rows, strict=True)]
