# SPDX-License-Identifier: BSD-3-Clause
"""Everything that the paper's tables and figures need, computed on all cores."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any

import numpy as np

from softimpact.optimize.running.workers import as_completed, cores, workers
from softimpact.simulate import Decoupling, decoupling_stiffness
from softimpact.symbolic import Contact, InvalidValue, body_region, static_stiffness
from softimpact.symbolic.robot.rigid import Array

from .ladder import DEFINITIONS, LADDER, REGIONS, impact_at, motors_on
from .scenarios import SCENARIOS, PaperScenario

BETWEEN = 1
"""Stiffnesses computed between any two of the paper's grid."""

SPEEDS = np.linspace(0.25, 2.5, 10)
SPEED_STIFFNESS = 1e4
COMPARED = ("two_mass", "chain_controlled", "full")
"""Models in the figures over time and over speed."""

SHOWN = {"a": (1, 3, 5, 6, 8, 10), "f": (0, 2, 3, 4, 6, 9)}
"""Which of the grid's stiffnesses are shown over time."""

SHOWN_DURATION = 0.06
DECOUPLED = ("full", "two_mass")
SOFTER = 0.1
"""Share of the softest k_s where the search for decoupling starts."""

PeakTable = dict[str, dict[str, dict[str, float]]]
"""Peak force [N] by region, model and definition."""


@dataclass(frozen=True, eq=False)
class SweepPoint:
    """A scenario with one joint stiffness.

    Attributes:
        stiffness: k_s [N·m/rad].
        m_c: [kg].
        k_r: [N/m].
        m_a: [kg].
        k_c: Kishi's static stiffness [N/m].
        peaks: of all models.
    """

    stiffness: float
    m_c: float
    k_r: float
    m_a: float
    k_c: float
    peaks: PeakTable


@dataclass(frozen=True, eq=False)
class Trace:
    """Contact force [N] over time [s] of a model."""

    time: Array
    force: Array


@dataclass(frozen=True, eq=False)
class Results:
    """What was computed; keys are scenarios' names.

    Attributes:
        sweeps: over k_s.
        nominal: at the stiffness of the sweeps over speed, without peaks.
        speeds: first peaks on the head by speed's index and model.
        traces: force over time on the head by k_s and model.
        decoupling: by region and model [N·m/rad]; None where peaks are one on the softest springs.
        motor_rates: of the motors at 1 m/s [rad/s].
        seconds: wall time of one impact by model, in one process after another.
    """

    sweeps: dict[str, list[SweepPoint]]
    nominal: dict[str, SweepPoint]
    speeds: dict[str, list[dict[str, float]]]
    traces: dict[str, dict[float, dict[str, Trace]]]
    decoupling: dict[str, dict[str, dict[str, Decoupling | None]]]
    motor_rates: dict[str, list[float]]
    seconds: dict[str, float]


def point(name: str, stiffness: float) -> SweepPoint:
    """Compute one stiffness of a scenario's sweep."""
    scenario = SCENARIOS[name]
    peaks: PeakTable = {region: {} for region in REGIONS}
    for region in REGIONS:
        for rung in LADDER:
            history = impact_at(scenario, rung, stiffness, region)
            peaks[region][rung] = {d: history.force_of(d) for d in DEFINITIONS}
    return _parameters(scenario, stiffness, peaks)


def _parameters(scenario: PaperScenario, stiffness: float, peaks: PeakTable) -> SweepPoint:
    model, approach = scenario.at(stiffness)
    at = (approach.q, approach.direction)
    reduced = model.reduced(*at)
    m_c, k_r, m_a = (float(x) for x in (reduced.m_c, reduced.k_r, reduced.m_a))
    return SweepPoint(stiffness, m_c, k_r, m_a, float(static_stiffness(model.linear(*at))), peaks)


def at_speed(name: str, speed: float) -> dict[str, float]:
    """Return the first peaks on the head at a speed."""
    scenario = SCENARIOS[name]
    return {
        rung: impact_at(scenario, rung, SPEED_STIFFNESS, "head", speed).force_of("first_peak")
        for rung in COMPARED
    }


def trace(name: str, stiffness: float) -> dict[str, Trace]:
    """Return force over time on the head."""
    found = {}
    for rung in COMPARED:
        history = impact_at(SCENARIOS[name], rung, stiffness, "head", horizon=SHOWN_DURATION)
        found[rung] = Trace(history.time, history.force)
    return found


def decoupled(name: str, region: str, rung: str) -> Decoupling | None:
    """Return the largest k_s that keeps the first peak apart, None if the softest does not."""
    scenario, step = SCENARIOS[name], LADDER[rung]
    arm = scenario.arm
    try:
        return decoupling_stiffness(
            scenario.at,
            Contact(body_region(region)),
            (SOFTER * arm.softest, arm.stiffest),
            step.fidelity,
            motors=motors_on(scenario, step),
            accuracy=1e-3,
        )
    except InvalidValue:
        return None


Job = tuple[str, tuple[Any, ...]]
WORK: dict[str, Callable[..., Any]] = {
    "sweep": point,
    "speed": at_speed,
    "trace": trace,
    "decoupling": decoupled,
}


def work_of(scenarios: tuple[str, ...], between: int = BETWEEN) -> list[Job]:
    """Return everything to compute for some scenarios, the longest first."""
    tasks: list[Job] = []
    for name in scenarios:
        tasks += [("decoupling", (name, r, rung)) for r in REGIONS for rung in DECOUPLED]
    for name in scenarios:
        grid = SCENARIOS[name].arm.stiffnesses()
        tasks += [("sweep", (name, float(k))) for k in SCENARIOS[name].arm.stiffnesses(between)]
        tasks += [("trace", (name, float(grid[i]))) for i in SHOWN.get(name, ())]
        if SCENARIOS[name].arm.robot == "rr":
            tasks += [("speed", (name, float(v))) for v in SPEEDS]
    return tasks


def compute(
    scenarios: tuple[str, ...] = tuple(SCENARIOS),
    between: int = BETWEEN,
    on_done: Callable[[str], None] = lambda _: None,
) -> Results:
    """Compute everything for some scenarios.

    Args:
        scenarios: their names.
        between: stiffnesses between any two of the paper's grid.
        on_done: told the kind of each task when it ends.
    """
    tasks = work_of(scenarios, between)
    found: dict[Job, Any] = {}
    with workers(min(len(tasks), cores())) as pool:
        futures: dict[Future[Any], Job] = {
            pool.submit(WORK[kind], *arguments): (kind, arguments) for kind, arguments in tasks
        }
        for future in as_completed(futures):
            found[futures[future]] = future.result()
            on_done(futures[future][0])
    return _collected(scenarios, tasks, found)


def _collected(scenarios: tuple[str, ...], tasks: list[Job], found: dict[Job, Any]) -> Results:
    def of(kind: str, name: str) -> list[tuple[tuple[Any, ...], Any]]:
        return [(a[1:], found[k, a]) for k, a in tasks if k == kind and a[0] == name]

    decoupling: dict[str, dict[str, dict[str, Decoupling | None]]] = {}
    for name in scenarios:
        decoupling[name] = {region: {} for region in REGIONS}
        for (region, rung), stiffness in of("decoupling", name):
            decoupling[name][region][rung] = stiffness
    return Results(
        sweeps={name: [p for _, p in of("sweep", name)] for name in scenarios},
        nominal={n: _parameters(SCENARIOS[n], SPEED_STIFFNESS, {}) for n in scenarios},
        speeds={name: [s for _, s in of("speed", name)] for name in scenarios},
        traces={name: {k[0]: t for k, t in of("trace", name)} for name in scenarios},
        decoupling=decoupling,
        motor_rates={name: _motor_rates(SCENARIOS[name]) for name in scenarios},
        seconds=_seconds(SCENARIOS[scenarios[-1]]),
    )


def _motor_rates(scenario: PaperScenario) -> list[float]:
    model, approach = scenario.at(scenario.arm.softest)
    assert approach.link_velocity is not None
    return [float(v) for v in approach.link_velocity[list(model.actuated)]]


def _seconds(scenario: PaperScenario, repeats: int = 5) -> dict[str, float]:
    """Return the least wall time of an impact on the head, model and integrator at hand."""
    seconds = {}
    for rung in COMPARED:
        times = []
        for _ in range(repeats):
            start = time.perf_counter()
            impact_at(scenario, rung, scenario.arm.softest, "head")
            times.append(time.perf_counter() - start)
        seconds[rung] = min(times)
    return seconds
