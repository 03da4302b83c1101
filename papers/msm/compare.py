# SPDX-License-Identifier: BSD-3-Clause
"""Our number beside each printed one, and what to think of the difference."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from softimpact.simulate import PeakDefinition
from softimpact.symbolic import Robot, load_robot
from softimpact.symbolic.robot.rigid import Array

from . import printed
from .compute import SPEED_STIFFNESS, Results, SweepPoint
from .ladder import LADDER, REGIONS
from .scenarios import GRID, SCENARIOS

PrintedVerdict = Literal["input", "agrees", "misprint", "not determined by the text"]

ROUNDING = 5e-3
"""Relative difference within which a number that the text determines agrees."""

POINTS = 1.0
"""Percentage points within which a mean error agrees."""


@dataclass(frozen=True)
class Comparison:
    """A printed number and ours.

    Attributes:
        section: where it belongs.
        what: the quantity.
        scenario: a to f, or the robot's part.
        unit: of both.
        printed: number.
        ours: number.
        difference: in percent of the printed number; of percentages, in points.
        verdict: what to think of it.
        note: why.
    """

    section: str
    what: str
    scenario: str
    unit: str
    printed: float
    ours: float
    difference: float
    verdict: PrintedVerdict
    note: str = ""


def compared(results: Results) -> list[Comparison]:
    """Return every printed number that the results cover."""
    parts = (_links, _reduced, _one_mass, _motor_rates, _mean_errors, _speeds, _decoupling, _time)
    return [line for part in parts for line in part(results)]


def grid_points(points: list[SweepPoint]) -> list[SweepPoint]:
    """Return the points of the paper's grid among those of a finer sweep."""
    return points[:: (len(points) - 1) // (GRID - 1)]


def mean_error(
    points: list[SweepPoint],
    region: str,
    rung: str,
    definition: PeakDefinition,
    against: str = "full",
) -> float:
    """Return a model's mean absolute error over the paper's grid [%]."""
    errors = [
        p.peaks[region][rung][definition] / p.peaks[region][against][definition] - 1
        for p in grid_points(points)
    ]
    return float(100 * np.mean(np.abs(errors)))


def _exact(
    section: str, what: str, scenario: str, unit: str, theirs: float, ours: float,
    last_digit: float, otherwise: tuple[PrintedVerdict, str] = ("not determined by the text", ""),
) -> Comparison:  # fmt: skip
    """Compare numbers that the text determines: to the last digit, which may be cut off."""
    near = abs(ours - theirs) < max(last_digit, ROUNDING * abs(theirs))
    verdict: PrintedVerdict = "agrees" if near else otherwise[0]
    note = "" if near else otherwise[1]
    difference = 0.0 if ours == theirs else 100 * (ours / theirs - 1) if theirs else np.inf
    return Comparison(section, what, scenario, unit, theirs, ours, float(difference), verdict, note)


def _links(results: Results) -> Iterator[Comparison]:
    for name in dict.fromkeys(SCENARIOS[s].arm.robot for s in results.sweeps):
        robot = load_robot(name)
        table = "Table 1" if name == "rr" else "Table 2"
        for joint, theirs in printed.LINKS[name].items():
            ours = _link(robot, joint)
            units = ("m", "kg", "kg m²", "m")
            names = ("length", "mass", "inertia", "centre of mass")
            for what, unit, a, b in zip(names, units, theirs, ours, strict=True):
                line = _exact(table, what, f"link of {joint}", unit, a, b, 1e-9)
                yield replace(line, verdict="input" if line.verdict == "agrees" else line.verdict)


def _link(robot: Robot, name: str) -> tuple[float, float, float, float]:
    index = robot.joint_names.index(name)
    joint = robot.joints[index]
    mass = joint.inertia.mass
    com = joint.inertia.first_moment / mass
    about_com = joint.inertia.about_origin - mass * (com @ com * np.eye(3) - np.outer(com, com))
    return _length(robot, index), mass, float(about_com[2, 2]), float(np.linalg.norm(com))


def _length(robot: Robot, index: int) -> float:
    ends: list[Array] = [f.placement.translation for f in robot.frames.values() if f.joint == index]
    ends += [j.placement.translation for j in robot.joints if j.parent == index]
    return float(max(np.linalg.norm(end) for end in ends))


def _reduced(results: Results) -> Iterator[Comparison]:
    for name in results.sweeps:
        point = results.sweeps[name][0]
        note = "" if name in "abcd" else "the distance O11-O21, not printed, is inferred from it"
        line = _exact("Reduced model", "m_c", name, "kg", printed.M_C[name], point.m_c, 0.01)
        yield Comparison(**{**vars(line), "note": line.note or note})
    for name in printed.K_R:
        if name not in results.nominal:
            continue
        at = results.nominal[name]
        what = f"k_r at k_s = {SPEED_STIFFNESS:g} N·m/rad"
        k_r = at.k_r / 1e4
        yield _exact("Reduced model", what, name, "10⁴ N/m", printed.K_R[name], k_r, 0.1)
        what = f"m_a at k_s = {SPEED_STIFFNESS:g} N·m/rad"
        yield _exact("Reduced model", what, name, "kg", printed.M_A[name], at.m_a, 0.01)


def _one_mass(results: Results) -> Iterator[Comparison]:
    for region in REGIONS:
        for name, points in results.sweeps.items():
            ours = points[0].peaks[region]["one_mass"]["first_peak"]
            note = printed.MISPRINTED_FORCES.get((region, name), "")
            yield _exact(
                "One mass", f"peak force, {region}", name, "N", printed.ONE_MASS[region][name],
                ours, 1.0, ("misprint" if note else "not determined by the text", note),
            )  # fmt: skip


def _motor_rates(results: Results) -> Iterator[Comparison]:
    for name, theirs in printed.MOTOR_RATES.items():
        for i, rate in enumerate(results.motor_rates.get(name, ())):
            yield _exact(
                "R-Min before the impact", f"speed of motor {i + 1}", name, "rad/s", theirs[i],
                rate, 0.01, ("not determined by the text", "no distance O11-O21 gives all four"),
            )  # fmt: skip


def _mean_errors(results: Results) -> Iterator[Comparison]:
    tables = {"two_mass": printed.TWO_MASS_ERROR, "one_mass": printed.ONE_MASS_ERROR}
    for rung, table in tables.items():
        for region in REGIONS:
            for name, points in results.sweeps.items():
                ours = mean_error(points, region, rung, "first_peak")
                what = f"{LADDER[rung].title}, mean error of the first peak, {region}"
                yield _points("Error over joint stiffness", what, name, table[region][name], ours)


def _speeds(results: Results) -> Iterator[Comparison]:
    for name, peaks in results.speeds.items():
        if peaks:
            ours = max(100 * abs(p["two_mass"] / p["full"] - 1) for p in peaks)
            what = "two masses, largest error of the first peak, head"
            yield _points("Error over speed", what, name, printed.SPEED_ERROR[name], ours)


def _points(section: str, what: str, scenario: str, theirs: float, ours: float) -> Comparison:
    near = abs(ours - theirs) <= POINTS
    note = "" if near else "rests on the controller's details and on where two peaks merge"
    verdict: PrintedVerdict = "agrees" if near else "not determined by the text"
    return Comparison(section, what, scenario, "%", theirs, ours, ours - theirs, verdict, note)


def _decoupling(results: Results) -> Iterator[Comparison]:
    """The printed stiffnesses are steps of a grid: ours must lie between them and the next."""
    for name, theirs in printed.DECOUPLING.items():
        found = results.decoupling.get(name, {}).get("head", {}).get("full")
        if found is None or found.isolated is None:
            continue
        grid = SCENARIOS[name].arm.stiffnesses()
        above = grid[grid > 1.001 * theirs][0]
        agrees = theirs <= found.isolated < above
        merged = f"; as a maximum of its own it lasts to {found.distinct:.0f}"
        note = f"twelve steps of a grid fit the print, the next is {above:.0f}"
        if not agrees:
            note = f"the text does not say when peaks count as apart{merged}"
        yield Comparison(
            "Stiffness that decouples", "largest k_s with an isolated first peak, head", name,
            "N·m/rad", theirs, found.isolated, 100 * (found.isolated / theirs - 1),
            "agrees" if agrees else "not determined by the text", note,
        )  # fmt: skip


def _time(results: Results) -> Iterator[Comparison]:
    theirs = printed.SECONDS[1] / printed.SECONDS[0]
    ours = results.seconds["full"] / results.seconds["two_mass"]
    yield Comparison(
        "Time", "full simulation over reduced, both by SUNDIALS here", "f", "1", theirs, ours,
        100 * (ours / theirs - 1), "not determined by the text",
        "integrators and machines differ; see benchmarks/impact for compiled code",
    )  # fmt: skip
