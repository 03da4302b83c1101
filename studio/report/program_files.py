# SPDX-License-Identifier: BSD-3-Clause
"""What ``softimpact program`` leaves behind: a record, tables, a figure."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from softimpact.simulate.program import Danger
from softimpact.symbolic import InvalidValue
from softimpact.symbolic.record import plain

from ..figures.program import program_figure
from ..figures.style import save
from ..output.printed import write_json
from ..output.results_folder import RESULTS
from ..program.moments import Question
from ..program.record import ProgramResult
from ..program.table import ProgramTable

MOMENT = ("sample", "t", "factor", "point", "region", "limit", "motors", "speed", "safe_speed")

POINTS = (*MOMENT, "x", "y", "z", "peak", "share_of_limit", "iso_safe_speed")


def write_program(found: ProgramResult, folder: Path) -> None:
    """Write a program's results: ``results.json``, tables, a figure."""
    table, dangers = found.answer.table, found.answer.dangers
    write_json(folder / RESULTS, found.record)
    save(program_figure(table, found.record["robot"]), folder / "program.png")
    _write_csv(folder / "program.csv", (*MOMENT, "peak", "iso_factor"), _samples(table))
    constraint = _constraint(found.question)
    if constraint is not None:
        constraint.save(str(folder / "speed_factor.casadi"))
    if dangers:
        rows = (row for part in dangers for danger in part for row in _points(table, danger))
        _write_csv(folder / "points.csv", POINTS, rows)


def _constraint(question: Question) -> Any:
    """Return (q, q̇) -> factor for all bodies, wherever they are; None where there is none."""
    from softimpact.optimize.impact.speed_factor import Watch, speed_factor

    watched = [Watch(question.points, body.contact, body.limits) for body in question.bodies]
    kinds, horizon = list(question.ends.values()), question.horizon
    try:
        return speed_factor(question.model, watched, kinds, horizon=horizon, compiled=False)
    except InvalidValue:
        return None


def _samples(table: ProgramTable) -> Iterator[dict[str, Any]]:
    """Yield a row for each sample."""
    formula = table.iso_factor
    for k, factor in enumerate(table.factor):
        moment = table.moment(k) if factor < 1 else None
        own = {"sample": k, "t": table.time[k], "factor": factor}
        yield {**own, **(moment or {}), "iso_factor": formula[k]}


def _points(table: ProgramTable, danger: Danger) -> Iterator[dict[str, Any]]:
    """Yield a row for each pass of a point by a region."""
    factor = danger.factor
    for row, k in enumerate(danger.sample):
        x, y, z = danger.direction[row]
        yield {
            "sample": int(k),
            "t": table.time[k],
            "factor": factor[row],
            "point": danger.point,
            "region": danger.region,
            "limit": danger.limit[row],
            "motors": danger.motors[row],
            "speed": danger.speed[row],
            "safe_speed": danger.safe_speed[row],
            "x": x,
            "y": y,
            "z": z,
            "peak": danger.peak[row],
            "share_of_limit": danger.share[row],
            "iso_safe_speed": danger.two_body,
        }


def _write_csv(path: Path, columns: Sequence[str], rows: Iterable[dict[str, Any]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows([_cell(row.get(name)) for name in columns] for row in rows)


def _cell(value: Any) -> Any:
    value = plain(value)
    if value is None:
        return ""
    return f"{value:.9g}" if isinstance(value, float) else value
