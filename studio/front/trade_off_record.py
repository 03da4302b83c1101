# SPDX-License-Identifier: BSD-3-Clause
"""Fronts over two or three objectives as plain data: one JSON object, and one table."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

from softimpact.optimize.answers import by_name
from softimpact.optimize.front.trade_off import TradePoint

from ..design.checks import Check, doubts
from ..design.report import inputs, versions
from ..design.robust import catalogue_record, meets_limit, share_of_limit
from ..design.scenario_checks import scenario_record
from ..output.cautions import study_warnings
from .pareto_record import GENERATOR
from .trade_off_report import TradeOffReport, broken_before

FORM = "objectives"
"""Tells this form of the Pareto command's results from the fronts of postures."""


def trade_off_record(report: TradeOffReport) -> dict[str, Any]:
    """Return a front as plain data, for ``results.json``, as docs/objectives.schema.json has it."""
    found, study = report.found, report.study
    return {
        "generator": GENERATOR,
        "form": FORM,
        "versions": versions(),
        "study": {**inputs(study), "pareto": study.levels.model_dump()},
        "peak_definition": "peak",
        "warnings": [*study_warnings(study), *_doubts(report)],
        "objectives": [
            {
                "kind": axis.kind,
                "unit": axis.unit,
                "better": "more" if axis.more_is_better else "less",
                "sought": axis is found.axes.sought,
                "levels": found.levels.get(axis.kind),
            }
            for axis in found.axes.all
        ],
        "scenarios": len(found.scenarios),
        "points": [
            _point(report, point, check, i == found.knee)
            for i, (point, check) in enumerate(zip(report.points, report.checks, strict=True))
        ],
        "before": {
            "values": _values(report, found.before_values),
            "springs": study.nominal,
            "worst_force": found.before.force,
            "worst_share": found.before.share,
            "keeps_bounds": not broken_before(found),
            "breaks": broken_before(found),
        },
        "levels_searched": found.searched,
        "levels_out_of_reach": found.out_of_reach,
        "levels_not_sold": found.not_sold,
        "levels_unsolved": found.unsolved,
        "solver": {
            "compiled": found.compiled,
            "impact_duration": found.timing.duration,
            "impact_steps": found.timing.steps,
        },
    }


def _doubts(report: TradeOffReport) -> list[str]:
    """Return a line for each design whose force simulation contradicts on the unsafe side."""
    pairs = enumerate(zip(report.points, report.checks, strict=True), 1)
    return [
        line
        for i, (point, check) in pairs
        for line in doubts(point.worst.force, check.linearised, check.full, of=f"design {i}")
    ]


def _values(report: TradeOffReport, values: tuple[float, ...]) -> dict[str, float]:
    return dict(zip((view.kind for view in report.views), values, strict=True))


def _point(report: TradeOffReport, point: TradePoint, check: Check, knee: bool) -> dict[str, Any]:
    study, worst = point.study, point.worst
    names = study.range.names[max(study.groups) + 1 :]
    poses = (pose.pose.name for pose in point.scenarios.poses)
    return {
        "values": _values(report, point.values),
        "knee": knee,
        "springs": point.springs,
        "others": dict(zip(names, point.others.tolist(), strict=True)),
        "postures": dict(zip(poses, point.postures.tolist(), strict=True)),
        "worst_force": worst.force,
        "worst_share": share_of_limit(point),
        "worst_scenario": scenario_record(point, worst.index),
        "meets_limit": meets_limit(point),
        "check": check,
        "bounds": worst.bounds,
        "indifferent": by_name(study, point.indifferent),
        "prices": point.prices,
        "catalogue": catalogue_record(point.bought),
        "bound": point.bound * point.scenarios.allowed,
        "status": point.status,
    }


def write_points(report: TradeOffReport, path: Path) -> None:
    """Write the front as CSV, a row a point, in SI units."""
    study = report.study
    others = study.range.names[max(study.groups) + 1 :]
    poses = [pose.pose.name for pose in report.found.scenarios.poses]
    joints = study.robot.joint_names
    units = [axis.unit for axis in report.found.axes.all]
    header = [f"{v.kind} [{unit}]" for v, unit in zip(report.views, units, strict=True)]
    header += [
        "knee",
        "worst_force_N",
        "worst_share",
        "linearised_N",
        "full_N",
        "meets_limit",
        "status",
    ]
    header += [f"k_s_{joint}" for joint in study.spring_names] + list(others)
    header += [f"q_{joint} in {pose}" for pose in poses for joint in joints]
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(header)
        for i, (point, check) in enumerate(zip(report.points, report.checks, strict=True)):
            table.writerow(
                [
                    *point.values,
                    str(i == report.found.knee).lower(),
                    *(point.worst.force, share_of_limit(point)),
                    *(check.linearised, check.full),
                    str(meets_limit(point)).lower(),
                    point.status,
                    *point.springs.tolist(),
                    *point.others.tolist(),
                    *point.postures.ravel().tolist(),
                ]
            )
