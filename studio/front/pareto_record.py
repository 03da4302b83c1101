# SPDX-License-Identifier: BSD-3-Clause
"""Pareto fronts as plain data: one JSON object, and one table."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

from softimpact.optimize import Front, ParetoPoint
from softimpact.optimize.answers import by_name

from ..design.checks import doubts
from ..design.report import inputs, limit_kind, versions
from ..output.cautions import study_warnings
from .pareto_report import FRONTS, CheckedFrontPoint, ParetoReport, price_of_deflection

GENERATOR = "softimpact pareto"
"""Marks a folder of results as one that may be replaced."""


def pareto_record(report: ParetoReport) -> dict[str, Any]:
    """Return a report as plain data, for ``results.json``."""
    study, pareto = report.study, report.pareto
    return {
        "generator": GENERATOR,
        "versions": versions(),
        "study": {**inputs(study), "pareto": study.levels.model_dump()},
        "region": study.contact.region.name,
        "limit": report.limit,
        "limit_kind": limit_kind(study),
        "peak_definition": "peak",
        "warnings": [*study_warnings(study), *_doubts(report)],
        "accuracy": "largest deflection of the tip by the springs under the study's forces [m]",
        "solver": {
            "compiled": pareto.compiled,
            "searches": pareto.searches,
            "impact_duration": pareto.timing.duration,
            "impact_steps": pareto.timing.steps,
        },
        "levels": pareto.levels,
        "reference": {
            "name": study.task_pose.name,
            **vars(pareto.reference),
            "safe_speed": report.reference_speed,
        },
        "fronts": {
            name: [
                {**_checked(point, report), "knee": i == report.knee(name)}
                for i, point in enumerate(report.fronts[name])
            ]
            for name in FRONTS
        },
        "held": {
            name: [_point(point) for point in front.points] for name, front in pareto.held.items()
        },
        "unsolved": {
            name: _unsolved(front, report)
            for name, front in {"free": pareto.free, **pareto.held}.items()
            if front.unsolved
        },
    }


def _doubts(report: ParetoReport) -> list[str]:
    """Return a line for each design whose force simulation contradicts on the unsafe side."""
    return [
        line
        for name in FRONTS
        for one in report.fronts[name]
        for line in doubts(
            one.check.nlp,
            one.check.linearised,
            one.check.full,
            of=f"the design of {1e3 * one.point.deflection:.3g} mm ({name} front)",
        )
    ]


def _point(point: ParetoPoint) -> dict[str, Any]:
    outcome = point.outcome
    return {
        "bound": point.bound,
        "deflection": point.deflection,
        "force": point.force,
        "start": outcome.name,
        "mode": outcome.mode,
        "status": outcome.status,
        "iterations": outcome.iterations,
        "attempts": outcome.attempts,
        "violation": outcome.violation,
        "q": outcome.q,
        "springs": outcome.springs,
    }


def _checked(checked: CheckedFrontPoint, report: ParetoReport) -> dict[str, Any]:
    meaning = checked.point.meaning
    return {
        **_point(checked.point),
        "meets_limit": checked.point.force <= report.limit,
        "safe_speed": checked.safe_speed,
        "check": vars(checked.check),
        "prices": [] if meaning is None else meaning.prices,
        "indifferent": {} if meaning is None else by_name(report.study, meaning.indifferent),
    }


def _unsolved(front: Front, report: ParetoReport) -> list[dict[str, Any]]:
    """Levels at which Ipopt failed, with its status and the best it left."""
    return [
        {
            "bound": bound,
            "status": outcome.status,
            "force": outcome.force,
            "violation": outcome.violation,
        }
        for bound, outcome in zip(report.pareto.levels, front.outcomes, strict=True)
        if outcome is not None and not outcome.solved
    ]


def write_table(report: ParetoReport, path: Path) -> None:
    """Write the fronts as CSV, a row a point, in SI units."""
    joints, springs = report.study.robot.joint_names, report.study.spring_names
    header = ["front", "bound_m", "deflection_m", "force_N", "safe_speed_m_per_s", "meets_limit"]
    header += ["knee", "a_tenth_more_buys_N", "linearised_N", "full_N", "status", "mode", "start"]
    header += [f"k_s_{joint}" for joint in springs] + [f"q_{joint}" for joint in joints]
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(header)
        for name in FRONTS:
            for i, checked in enumerate(report.fronts[name]):
                is_knee = str(i == report.knee(name)).lower()
                table.writerow([name, *_row(checked, report, is_knee)])


def _row(checked: CheckedFrontPoint, report: ParetoReport, is_knee: str) -> list[object]:
    point, outcome = checked.point, checked.point.outcome
    return [
        *(point.bound, point.deflection, point.force, checked.safe_speed),
        str(point.force <= report.limit).lower(),
        is_knee,
        price_of_deflection(point),
        *(checked.check.linearised, checked.check.full),
        *(outcome.status, outcome.mode, outcome.name),
        *map(float, outcome.springs),
        *map(float, outcome.q),
    ]
