# SPDX-License-Identifier: BSD-3-Clause
"""Random impacts of a package's robot, and the right peak forces of them."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from softimpact.symbolic import REGIONS, BodyRegion, Contact, Robot, closed_chain
from softimpact.symbolic.body.laws.series import points_of
from softimpact.symbolic.robot.rigid import Array

from ..expressions.evaluate import evaluate_rounded
from ..functions import Symbols
from ..functions.description import CFunction
from ..inputs.parameters import Parameter, is_elastic
from ..inputs.regions import hertz_stiffness
from ..inputs.samples import Sample, as_columns, draw_samples
from .accuracy import rounded_unit
from .reference import (
    ReferenceArrival,
    ReferenceBody,
    ReferenceMotors,
    reference_bracket,
    reference_peak,
)

BODIES = ("head", "chest", "hand")
"""Regions of the random impacts."""

SLOWEST, FASTEST = 0.05, 2.0
"""Range of their speeds [m/s]."""

CMotorKind = Literal["free_or_driven", "free", "driven", "servo"]

KINDS: tuple[CMotorKind, ...] = ("free_or_driven", "free", "driven", "servo")
"""What motors do in them, by turns; the numbers of C's enumeration."""

REACTION_TIMES = (1 / 64, 1 / 32, 1.0)
"""When they are released [s]; the last is never."""

GOLDEN_HORIZON = 3 / 32
"""For how long [s]."""


@dataclass(frozen=True)
class Impact:
    """An impact of a sampled robot.

    Attributes:
        sample: configuration, direction and parameters.
        contact: what it hits.
        speed: of the approach [m/s], exact in float.
        motors: what they do.
        reaction_time: until they are released [s].
        horizon: for how long forces count [s].
        built_in: number of a contact that the package has built in; None: a region of the standard.
    """

    sample: Sample
    contact: Contact
    speed: float
    motors: CMotorKind = "free"
    reaction_time: float = REACTION_TIMES[0]
    horizon: float = GOLDEN_HORIZON
    built_in: int | None = None

    @property
    def region(self) -> BodyRegion:
        """The region that it hits."""
        return self.contact.region

    @property
    def clamped(self) -> bool:
        """Whether that is held."""
        return self.contact.clamped

    @property
    def body(self) -> ReferenceBody:
        """The contact as the integrator sees it."""
        mass = None if self.clamped else self.region.effective_mass
        skin = hertz_stiffness(self.contact.law) or points_of(self.contact.law)
        return ReferenceBody(self.region.stiffness, self.region.damping, mass, skin)

    @property
    def kind(self) -> int:
        """What motors do, as C counts."""
        return KINDS.index(self.motors)


def draw_impacts(
    robot: Robot, parameters: Sequence[Parameter], directions: Array, count: int, seed: int
) -> list[Impact]:
    """Return random impacts in directions in which the robot moves.

    The same on every machine, and exact in float.
    """
    source = random.Random(seed)
    impacts = []
    for i, sample in enumerate(draw_samples(robot, parameters, count, seed)):
        speed = math.exp(math.log(SLOWEST) + source.random() * math.log(FASTEST / SLOWEST))
        chosen = replace(sample, n=_within(sample.n, directions))
        impacts.append(
            Impact(
                chosen,
                Contact(REGIONS[BODIES[i // 4 % len(BODIES)]], source.random() < 0.5),
                round(1024 * speed) / 1024,
                KINDS[i % len(KINDS)],
                REACTION_TIMES[int(source.random() * len(REACTION_TIMES))],
            )
        )
    return impacts


def _within(n: Sequence[float], directions: Array) -> tuple[float, ...]:
    shadow = directions.T @ (directions @ np.array(n))
    chosen = shadow if np.linalg.norm(shadow) > 1e-3 else directions[0]
    return tuple(map(float, chosen.astype(np.float32)))


def reference_arrival(
    symbols: Symbols, links: CFunction, impact: Impact, directions: Array
) -> ReferenceArrival | None:
    """Return the robot of an impact in numbers; None where it cannot move along n alone."""
    robot, elastic = symbols.robot, is_elastic(symbols.robot)
    columns = as_columns([impact.sample])
    n = rounded_unit(columns[1], np.float64)
    values = evaluate_rounded(links.graph, [columns[0], n, *columns[2:]], np.float64)
    found = {output.name: _matrix(v[:, 0], output.shape, output.symmetric)
             for output, v in zip(links.outputs, values, strict=False)}  # fmt: skip
    independent = list(closed_chain(robot).independent)
    motors = np.array([robot.actuated[i] for i in independent])
    J, M = found["J"][:3], found["M"]
    moved = directions @ J * motors
    square = moved @ moved.T
    if np.linalg.eigvalsh(square)[0] <= 1e-12 * np.trace(square):
        return None
    names = [p.name for p in symbols.parameters]

    def parameter(name: str) -> Array:
        return np.array(impact.sample.parameters[names.index(name)])[independent]

    held = motors.astype(float)
    return ReferenceArrival(
        mass=M,
        potential=found.get("K", np.zeros_like(M)),
        row=n[:, 0] @ J,
        rates=moved.T @ np.linalg.solve(square, directions @ n[:, 0]),
        springs=parameter("joint_stiffness") if elastic else None,
        rotors=parameter("rotor_inertia"),
        gains=(parameter("position_gain") * held, parameter("damping_gain") * held),
        motors=motors,
        damping=robot.damping[independent],
    )


def _matrix(entries: Array, shape: tuple[int, ...], symmetric: bool) -> Array:
    rows, columns = shape if len(shape) == 2 else (1, 1) if not shape else (shape[0], 1)
    if not symmetric or len(shape) != 2:
        return entries.reshape(rows, columns)
    matrix = np.zeros((rows, columns))
    matrix[np.tril_indices(rows)] = entries
    return np.asarray(matrix + np.tril(matrix, -1).T)


def reference_force(
    symbols: Symbols,
    links: CFunction,
    impact: Impact,
    directions: Array,
    fastest: float,
    heaviest: float,
) -> float | None:
    """Return the right peak force [N]; None at poses that C calls singular, or nearly so."""
    arrival = reference_arrival(symbols, links, impact, directions)
    if arrival is None or arrival.rates @ arrival.rates > 0.25 * fastest:
        return None
    if arrival.row @ np.linalg.solve(arrival.mass, arrival.row) * heaviest < 4:
        return None
    kind = impact.motors
    motors = ReferenceMotors(
        "free" if kind == "free_or_driven" else kind, impact.reaction_time, impact.horizon
    )
    if kind == "free_or_driven":
        return reference_bracket(arrival, impact.speed, impact.body, motors)
    return reference_peak(arrival, impact.speed, impact.body, motors)
