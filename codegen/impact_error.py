# SPDX-License-Identifier: BSD-3-Clause
"""How far a package's impacts are from those of the whole linear robot, and from exact ones."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic import REGIONS, BodyRegion, Robot
from softimpact.symbolic.body.contact import HERTZ_STIFFNESS
from softimpact.symbolic.robot.rigid import Array

from .accuracy import is_regular, rounded_unit, rounded_up
from .description import CFunction
from .evaluate import evaluate_rounded
from .functions import CHAIN_ENDS, Symbols, coordinates_of
from .impact import Body, Modes, modes_of_chain, peak_force
from .inputs import Parameter
from .samples import Sample, as_columns, draw_samples
from .tridiagonal import Numbers

CASES = 128
"""Random impacts that a chain is judged by."""

FINER = 4.0
"""How much finer the steps of reference impacts are."""

BODIES = ("head", "chest", "hand")
"""Regions of the random impacts."""

SLOWEST, FASTEST = 0.05, 2.0
"""Range of their speeds [m/s]."""

GAIN = "position_gain"

USUAL = 0.95
"""Share of the impacts by which an order of the chain is chosen."""

LEAST = 1e-5
"""Least error stated."""

UNFELT = 1e-12
"""Share of the mobility and of the velocity below which references leave a mode out: it would only
shorten their steps."""


@dataclass(frozen=True)
class Impact:
    """An impact of a sampled robot.

    Attributes:
        sample: configuration, direction and parameters.
        region: what it hits.
        clamped: whether that is held.
        speed: of the approach [m/s], exact in float.
    """

    sample: Sample
    region: BodyRegion
    clamped: bool
    speed: float

    @property
    def body(self) -> Body:
        """The region as the integrator sees it."""
        mass = None if self.clamped else self.region.effective_mass
        return Body(self.region.stiffness, self.region.damping, mass, HERTZ_STIFFNESS)


def draw_impacts(
    robot: Robot, parameters: Sequence[Parameter], directions: Array, count: int, seed: int
) -> list[Impact]:
    """Return random impacts in directions in which the robot moves; every second has free motors.

    The same on every machine, and exact in float.
    """
    source = random.Random(seed)
    impacts = []
    for i, sample in enumerate(draw_samples(robot, parameters, count, seed)):
        speed = math.exp(math.log(SLOWEST) + source.random() * math.log(FASTEST / SLOWEST))
        region = REGIONS[BODIES[i // 2 % len(BODIES)]]
        clamped = source.random() < 0.5
        chosen = replace(sample, n=_within(sample.n, directions))
        if i % 2:
            chosen = _released(chosen, parameters)
        impacts.append(Impact(chosen, region, clamped, round(1024 * speed) / 1024))
    return impacts


def _within(n: Sequence[float], directions: Array) -> tuple[float, ...]:
    shadow = directions.T @ (directions @ np.array(n))
    chosen = shadow if np.linalg.norm(shadow) > 1e-3 else directions[0]
    return tuple(map(float, chosen.astype(np.float32)))


def _released(sample: Sample, parameters: Sequence[Parameter]) -> Sample:
    zeros = (0.0,) * len(sample.q)
    pairs = zip(parameters, sample.parameters, strict=True)
    values = tuple(zeros if p.name == GAIN and p.frozen is None else v for p, v in pairs)
    return replace(sample, parameters=values)


def is_held(impact: Impact, symbols: Symbols) -> bool:
    """Whether a controller holds a motor; a chain then keeps its spring to ground."""
    pairs = zip(symbols.parameters, impact.sample.parameters, strict=True)
    (gains,) = [values for p, values in pairs if p.name == GAIN]
    return holds_a_motor(symbols.robot, gains)


def holds_a_motor(robot: Robot, gains: Sequence[float]) -> bool:
    """Whether gains of a controller, one a joint, hold a joint that has a motor."""
    return any(a and gain > 0 for a, gain in zip(robot.actuated, gains, strict=True))


def regular_impacts(function: CFunction, impacts: Sequence[Impact]) -> list[Impact]:
    """Return the impacts at which the robot can arrive."""
    regular = is_regular(function, [impact.sample for impact in impacts])
    return [impact for impact, ok in zip(impacts, regular, strict=True) if ok]


def linear_forces(linear: CFunction, impacts: Sequence[Impact]) -> Array:
    """Return the peak forces [N] of the whole linear robot, with fine steps; NaN if endless."""
    M0, K0, J_c, velocity = _values(linear, impacts, np.float64)
    size = len(J_c)
    forces = []
    for k, impact in enumerate(impacts):
        root = np.linalg.cholesky(M0[:, k].reshape(size, size))
        half = np.linalg.solve(root, K0[:, k].reshape(size, size))
        squared, shapes = np.linalg.eigh(np.linalg.solve(root, half.T))
        at_contact = shapes.T @ np.linalg.solve(root, J_c[:, k])
        rates = shapes.T @ (root.T @ velocity[:, k])
        modes = _felt(Modes(squared, at_contact**2, at_contact * rates))
        forces.append(peak_force(modes, impact.speed, impact.body, FINER).force)
    return np.array(forces)


def _felt(modes: Modes) -> Modes:
    weight, velocity = modes.weight, modes.velocity
    felt = (weight > UNFELT * weight.sum()) | (abs(velocity) > UNFELT)
    return Modes(modes.squared_frequency[felt], weight[felt], velocity[felt])


def chain_forces(
    chain: CFunction,
    symbols: Symbols,
    impacts: Sequence[Impact],
    order: int,
    kind: type[np.floating[Any]] = np.float64,
    finer: float = 1.0,
) -> Array:
    """Return the peak forces [N] of the first ``order`` masses of a chain, as C computes them.

    NaN where an impact does not end within the steps.
    """
    mass, stiffness, velocity = _values(chain, impacts, kind)
    coordinates = coordinates_of(symbols.robot)
    forces = []
    for k, impact in enumerate(impacts):
        m, springs, v = mass[:order, k], stiffness[:order, k].copy(), velocity[:order, k]
        length = chain_length(m, springs)
        if length == order < coordinates and not is_held(impact, symbols):
            springs[-1] = 0
        modes = modes_of_chain(m[:length], springs[:length], v[:length])
        forces.append(peak_force(modes, impact.speed, impact.body, finer).force)
    return np.array(forces)


def chain_length(mass: Numbers, stiffness: Numbers) -> int:
    """Return the number of masses before which a chain ends."""
    for i in range(1, len(mass)):
        own = stiffness[i - 1] + (stiffness[i - 2] if i > 1 else 0)
        with np.errstate(all="ignore"):
            share = stiffness[i - 1] ** 2 * mass[i - 1] / (mass[i] * own * own)
        if not share > CHAIN_ENDS:
            return i
    return len(mass)


def _values(
    function: CFunction, impacts: Sequence[Impact], kind: type[np.floating[Any]]
) -> list[NDArray[Any]]:
    q, n, *parameters = as_columns([impact.sample for impact in impacts])
    arguments = [q, rounded_unit(n, kind), *parameters]
    return evaluate_rounded(function.graph, arguments, kind)[: len(function.outputs)]


def errors_of_order(off: Array) -> tuple[float, float, float]:
    """Return mean, 95 % quantile and maximum of absolute errors, rounded up to one digit."""
    found = np.sort(abs(off))
    usual = found[math.ceil(USUAL * len(found)) - 1]
    mean, high, worst = (rounded_up(max(float(x), LEAST)) for x in (found.mean(), usual, found[-1]))
    return mean, high, worst
