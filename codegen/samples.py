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

from softimpact.symbolic import JointKind, Robot

from .description import Parameter

STEPS = 1024
"""Joint coordinates are multiples of 1/1024 rad or m."""

UNLIMITED = {JointKind.HINGE: math.pi, JointKind.SLIDE: 1.0}
"""Largest coordinate sampled of a joint without limits [rad, m]."""


@dataclass(frozen=True)
class Sample:
    """Inputs of every function of a package.

    Attributes:
        q: joint coordinates within their limits.
        n: direction of any length but zero.
        parameters: one vector a field of the parameter struct.
    """

    q: tuple[float, ...]
    n: tuple[float, ...]
    parameters: tuple[tuple[float, ...], ...]


def draw_samples(
    robot: Robot, parameters: Sequence[Parameter], count: int, seed: int
) -> list[Sample]:
    """Return random samples; ``random.Random`` promises the same ones everywhere."""
    source = random.Random(seed)
    return [
        Sample(
            tuple(_coordinate(source, *bounds) for bounds in _ranges(robot)),
            _direction(source),
            tuple(tuple(_value(source, p.name) for _ in range(robot.n)) for p in parameters),
        )
        for _ in range(count)
    ]


def _ranges(robot: Robot) -> list[tuple[float, float]]:
    return [
        (max(joint.lower, -UNLIMITED[joint.kind]), min(joint.upper, UNLIMITED[joint.kind]))
        for joint in robot.joints
    ]


def _between(source: random.Random, low: int, high: int) -> int:
    return low + int(source.random() * (high - low + 1))


def _coordinate(source: random.Random, lower: float, upper: float) -> float:
    low, high = math.ceil(lower * STEPS), math.floor(upper * STEPS)
    if low > high:  # the joint hardly moves
        return float(np.float32((lower + upper) / 2))
    return _between(source, low, high) / STEPS


def _direction(source: random.Random) -> tuple[float, ...]:
    while True:
        n = tuple(_between(source, -64, 64) / 32 for _ in range(3))
        if any(n):
            return n


def _value(source: random.Random, name: str) -> float:
    if name == "joint_stiffness":
        return float(math.floor(2 ** (7 + 10 * source.random())))
    if name == "rotor_inertia":
        return _between(source, 4, 64) / 64
    return float(_between(source, 0, 4096))


def as_columns(samples: Sequence[Sample]) -> list[NDArray[np.float64]]:
    """Return q, n and the parameters of all samples, each as an array of size × samples."""
    rows = [[s.q, s.n, *s.parameters] for s in samples]
    return [np.array(column, dtype=float).T for column in zip(*rows, strict=True)]
