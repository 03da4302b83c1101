# SPDX-License-Identifier: BSD-3-Clause
"""What a robust design found, checked by simulation, as plain data and in words."""

from __future__ import annotations

from typing import Any

import numpy as np

from softimpact.optimize.robust import RobustDesign, Worst
from softimpact.simulate import Approach, simulate_impact
from softimpact.symbolic import impact_model, with_load
from softimpact.symbolic.robot.rigid import Array

from .design_report import GENERATOR, inputs, versions

KEEPS = 1 + 1e-5
"""Deflection over its bound up to which the bound counts as kept."""


def simulated_worst(design: RobustDesign) -> float:
    """Return the peak force of the worst scenario, by SUNDIALS up to the horizon [N]."""
    study, scenarios = design.study, design.scenarios
    one = scenarios[design.worst.index]
    load = scenarios.payloads[one.payload]
    robot, point = study.robot, scenarios.points[one.point]
    if load:
        robot = with_load(robot, study.model.tip, load)
    model = impact_model(robot, point, drives_=study.model.with_springs(design.springs).drives)
    approach = Approach(
        design.postures[one.pose], scenarios.directions[one.direction], scenarios.speeds[one.speed]
    )
    motors, contact = scenarios.motors[one.motors], scenarios.contacts[one.contact]
    return simulate_impact(model, approach, contact, motors=motors, horizon=study.horizon).peak


def robust_record(design: RobustDesign) -> dict[str, Any]:
    """Return a robust design as plain data, for ``results.json``."""
    study, scenarios, worst = design.study, design.scenarios, design.worst
    equal, equal_springs = design.equal
    names = study.robot.joint_names
    return {
        "generator": GENERATOR,
        "versions": versions(),
        "study": inputs(study),
        "peak_definition": "peak",
        "winner": {
            "springs": design.springs,
            "postures": {
                pose.pose.name: q for pose, q in zip(scenarios.poses, design.postures, strict=True)
            },
            "deflection": worst.deflection,
            "meets_limit": worst.share <= 1,
        },
        "worst_force": worst.force,
        "worst_share": worst.share,
        "worst_scenario": _scenario(design, worst),
        "check": {"nlp": worst.force, "linearised": simulated_worst(design)},
        "before": _other(design, design.before, study.nominal),
        "equal": _other(design, equal, equal_springs),
        "indifferent": _by_joint(names, design.indifferent),
        "prices": design.prices,
        "conflicts": [],
        "certificate": {
            "scenarios": len(scenarios),
            "worst_share": worst.share,
            "bound": design.bound,
            "exchanges": design.rounds,
            "active": [scenarios.describe(scenarios[i]) for i in design.active],
        },
        "solver": {
            "compiled": design.compiled,
            "impact_duration": design.timing.duration,
            "impact_steps": design.timing.steps,
        },
    }


def _by_joint(names: tuple[str, ...], ranges: Array) -> dict[str, list[float]]:
    return {name: ends.tolist() for name, ends in zip(names, ranges, strict=True)}


def _scenario(design: RobustDesign, worst: Worst) -> dict[str, object]:
    one = design.scenarios[worst.index]
    return {**design.scenarios.describe(one), "limit": design.scenarios.limit(one)}


def _other(design: RobustDesign, worst: Worst, springs: Array) -> dict[str, Any]:
    return {
        "springs": springs,
        "worst_force": worst.force,
        "worst_share": worst.share,
        "worst_scenario": _scenario(design, worst),
        "deflection": worst.deflection,
        "keeps_bounds": _keeps(design, worst),
    }


def _keeps(design: RobustDesign, worst: Worst) -> bool:
    return worst.deflection <= design.study.max_deflection * KEEPS


def robust_in_words(design: RobustDesign) -> list[str]:
    """Return what was found, a sentence each."""
    study, worst = design.study, design.worst
    equal, springs = design.equal
    saved = 100 * (1 - worst.share / equal.share)
    lines = [
        f"{study.title}: {len(design.scenarios)} scenarios",
        f"k_s = [{', '.join(f'{k:.0f}' for k in design.springs)}] N·m/rad",
        f"Worst: {worst.force:.1f} N, {worst.share:.2f} times its limit: {_place(design, worst)}",
        f"Deflection: {1e3 * worst.deflection:.4g} mm at most, of "
        f"{1e3 * study.max_deflection:.4g} mm allowed",
        f"Equal proportions, just accurate (k_s = {_range(springs)}): {equal.force:.1f} N, "
        f"{equal.share:.2f} times; the design saves {saved:.1f} %",
        f"Before: {design.before.force:.1f} N, {design.before.share:.2f} times, "
        f"{1e3 * design.before.deflection:.4g} mm"
        + ("" if _keeps(design, design.before) else ", which breaks the bound on the deflection"),
    ]
    ranges = zip(study.robot.joint_names, design.indifferent, strict=True)
    named = ", ".join(f"{name} {low:.0f}–{high:.0f}" for name, (low, high) in ranges)
    lines.append(f"Costs less than 0.5 %, one at a time: {named} N·m/rad")
    lines += [f"{p.bound}: {p.room} buys {p.newtons:.2g} N" for p in design.prices]
    lines.append(
        f"Certificate: all {len(design.scenarios)} scenarios evaluated, none above "
        f"{worst.share:.4f} times its limit; the {len(design.active)} that decide allow no less "
        f"than {design.bound:.4f} (a local optimum)"
    )
    return lines


def _place(design: RobustDesign, worst: Worst) -> str:
    words = design.scenarios.describe(design.scenarios[worst.index])
    direction = np.round(np.array(words["direction"], dtype=float), 3).tolist()
    return (
        f"pose {words['pose']}, {words['point']} along {direction} against {words['region']}, "
        f"{words['payload']:g} kg, {words['speed']:g} m/s, motors {words['motors']}"
    )


def _range(springs: Array) -> str:
    low, high = float(springs.min()), float(springs.max())
    return f"{low:.0f}" if high - low < 1 else f"{low:.0f}–{high:.0f}"
