# SPDX-License-Identifier: BSD-3-Clause
"""Random inputs of all contenders."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from softimpact.simulate import Approach, simulate_impact
from softimpact.symbolic import REGIONS, Contact, Robot, body_region, drives, impact_model

Array = NDArray[np.float64]

PARTS = ("head", "chest", "hand")

SLOWEST, FASTEST = 0.1, 1.0
"""Speeds of impacts [m/s]."""


@dataclass(frozen=True, eq=False)
class Sample:
    """What every contender is given; the force [N] is that of SUNDIALS, 0 where nothing is hit."""

    q: Array
    n: Array
    springs: Array
    rotors: Array
    gains: Array
    region: str = "head"
    clamped: bool = True
    speed: float = 0.0
    force: float = 0.0

    def __str__(self) -> str:
        vectors = np.concatenate([self.q, self.n, self.springs, self.rotors, self.gains])
        part = list(REGIONS).index(self.region)
        return f"{text(vectors)} {part} {int(self.clamped)} {self.speed!r} {self.force!r}"


def still_samples(robot: Robot, count: int) -> list[Sample]:
    """Return random configurations, directions and drives."""
    random = np.random.default_rng(0)
    return [_draw(robot, random) for _ in range(count)]


def impacts(robot: Robot, order: int, count: int) -> list[Sample]:
    """Return random impacts while the motors are free, with the forces of chains of an order."""
    random = np.random.default_rng(1)
    drawn = [
        replace(
            _draw(robot, random),
            gains=np.zeros(robot.n),
            region=PARTS[k % len(PARTS)],
            clamped=bool(k % 2),
            speed=float(np.exp(random.uniform(math.log(SLOWEST), math.log(FASTEST)))),
        )
        for k in range(count)
    ]
    return [replace(sample, force=_force(robot, sample, order)) for sample in drawn]


def _force(robot: Robot, sample: Sample, order: int) -> float:
    model = impact_model(robot, drives=drives(robot, sample.springs, sample.rotors))
    approach = Approach(sample.q, sample.n, sample.speed)
    contact = Contact(body_region(sample.region), sample.clamped)
    history = simulate_impact(model, approach, contact, "chain", order=order, tolerance=1e-9)
    return history.first_contact


def _draw(robot: Robot, random: np.random.Generator) -> Sample:
    n = random.normal(size=3)
    return Sample(
        random.uniform(*robot.limits, robot.n),
        n / np.linalg.norm(n),
        np.exp(random.uniform(math.log(1e3), math.log(3e4), robot.n)),
        robot.armature * random.uniform(0.5, 1.5, robot.n),
        random.uniform(0, 3e3, robot.n),
    )


def text(numbers: Array) -> str:
    """Return numbers with all their digits."""
    return " ".join(repr(float(x)) for x in numbers)
