# SPDX-License-Identifier: BSD-3-Clause
"""The forces of all scenarios under given hardware, piece by piece; runs in worker processes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from softimpact.symbolic.robot.rigid import Array, Indices

from ..search.nlp import Program
from ..search.rows import by_rows
from ..study.scenarios import Scenario, Scenarios

SCENARIOS_IN_A_JOB = 1000
"""Scenarios in one job."""

SCENARIOS_REPORTED = 8
"""Scenarios of a piece that are reported: the worst, each of another pose, point or direction."""


@dataclass(frozen=True)
class Screened:
    """A scenario with its force.

    Attributes:
        index: of the scenario.
        share: of the force over its limit.
        force: largest peak [N].
    """

    index: int
    share: float
    force: float


@dataclass(frozen=True, eq=False)
class Screening:
    """A machine and the scenarios in which it is looked at, piece by piece.

    Attributes:
        program: functions of the impacts, one for each contact point.
        scenarios: all of them.
        postures: of each pose, P×n [rad].
        y: log10 of what impacts feel of the hardware.
        speeds: factor on the speed of all, or of each scenario; None where speeds stay.
        step: time step of the impacts [s].
    """

    program: Program
    scenarios: Scenarios
    postures: Array
    y: Array
    speeds: Array | None
    step: float


def screen(every: Screening, begin: int, end: int) -> list[Screened]:
    """Return the worst of the scenarios from one number up to before another, worst first."""
    places = every.scenarios.at(begin, end)
    force = forces_at(every, begin, end)
    share = force / every.scenarios.limits[places[:, 3]]
    kept: dict[tuple[int, ...], Screened] = {}
    for i in np.argsort(-share):
        kind = tuple(places[i, :3])
        if kind not in kept:
            kept[kind] = Screened(begin + int(i), float(share[i]), float(force[i]))
        if len(kept) == SCENARIOS_REPORTED:
            break
    return list(kept.values())


def forces_at(every: Screening, begin: int, end: int) -> Array:
    """Return the largest peak of each of these scenarios [N]."""
    places = every.scenarios.at(begin, end)
    x = np.column_stack([every.postures[places[:, 0]], np.tile(every.y, (len(places), 1))])
    if every.speeds is not None:
        which = np.arange(begin, end) // len(every.scenarios.motors) if every.speeds.size > 1 else 0
        x = np.column_stack([x, np.broadcast_to(np.log10(every.speeds[which]), len(places))])
    numbers = impact_numbers(every.scenarios, places, every.step)
    force = np.empty(len(places))
    for point in np.unique(places[:, 1]):
        at = np.flatnonzero(places[:, 1] == point)
        force[at] = largest_forces(every.program, int(point), x[at], numbers[at])
    return force


def impact_numbers(scenarios: Scenarios, places: Indices, step: float) -> Array:
    """Return the impacts' numbers, a row each; those that differ in nothing but the pose once."""
    kinds, which = np.unique(places[:, 2:], axis=0, return_inverse=True)
    rows = [scenarios.numbers(Scenario(0, 0, *(int(i) for i in kind)), step) for kind in kinds]
    return np.array(rows)[which.ravel()]


def largest_forces(program: Program, point: int, x: Array, numbers: Array) -> Array:
    """Return the largest peak of each impact [N].

    Args:
        program: its functions.
        point: that hits.
        x: posture, and log10 of what impacts feel of the hardware, a row each.
        numbers: of the impacts, m×``NUMBERS``.
    """
    peaks = by_rows(program.impacts[point]["peaks"], x, numbers, np.zeros((len(x), 1)))[0]
    forces = peaks.max(axis=1)
    return np.where(np.isnan(forces), np.inf, forces)  # else sorting would take it for the least
