# SPDX-License-Identifier: BSD-3-Clause
"""What ``softimpact program`` leaves behind: a record, tables, a figure."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from .figures.program import program_figure
from .output import plain, write_json
from .program_record import ProgramResult, moment_of
from .results_folder import RESULTS

MOMENT = ("sample", "t", "factor", "point", "region", "limit", "motors", "speed", "safe_speed")


def write_program(found: ProgramResult, folder: Path) -> None:
    """Write a program's results: ``results.json``, ``program.csv``, ``points.csv``, a figure."""
    write_json(folder / RESULTS, found.record)
    program_figure(found.motion, found.safe, found.record["robot"], folder / "program.png")
    rows = []
    for k, factor in enumerate(found.safe.factor):
        moment = moment_of(found.motion, found.safe, k) if factor < 1 else None
        own = {"sample": k, "t": found.motion.time[k], "factor": factor}
        rows.append({**own, **(moment or {}), "iso_factor": found.safe.two_body[k]})
    _write_csv(folder / "program.csv", (*MOMENT, "peak", "iso_factor"), rows)
    _write_csv(folder / "points.csv", POINTS, list(_points(found)))


POINTS = (*MOMENT, "x", "y", "z", "peak", "share_of_limit", "iso_safe_speed")


def _points(found: ProgramResult) -> Iterator[dict[str, Any]]:
    """Yield a row for each pass of each point by each region."""
    for danger in found.dangers:
        factor = danger.factor
        for row, k in enumerate(danger.sample):
            x, y, z = danger.direction[row]
            yield {
                "sample": int(k),
                "t": found.motion.time[k],
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


def _write_csv(path: Path, columns: Sequence[str], rows: Sequence[dict[str, Any]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, restval="", extrasaction="ignore")
        writer.writeheader()
        writer.writerows({key: _cell(value) for key, value in row.items()} for row in rows)


def _cell(value: Any) -> Any:
    value = plain(value)
    if value is None:
        return ""
    return f"{value:.9g}" if isinstance(value, float) else value
