# SPDX-License-Identifier: BSD-3-Clause
"""Several impacts in one call: all combinations of points, directions and regions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

from softimpact.symbolic import InvalidValue

from ..output.printed import Cell, folded, print_table, tables_are_csv
from ..output.progress import progress_bar
from ..typed.situation import Typed
from .impact import TypedImpact, contact_of, impact
from .record import record_of

Asked = list[tuple[Typed, TypedImpact]]
"""Where, and how, for each impact."""


def combinations(
    where: Typed,
    how: TypedImpact,
    points: Sequence[str | None],
    directions: Sequence[str],
    regions: Sequence[str | None],
) -> Asked:
    """Return every combination, in the order of points, directions and regions."""
    return [
        (
            replace(where, arm=replace(where.arm, tip=point), direction=direction),
            replace(how, body=replace(how.body, region=region)),
        )
        for point, direction, region in product(points, directions, regions)
    ]


def impacts(asked: Asked, report: Path | None = None) -> dict[str, Any]:
    """Simulate several impacts, with a progress bar on stderr.

    Returns:
        ``impacts``, a record each; ``worst``, the place of the one that takes the largest share of
        a limit; ``safe_speed`` that keeps every limit in all of them, if asked for; ``warnings``.

    Raises:
        SoftImpactError: as ``impact`` does; a report is of one impact.
    """
    if report is not None:
        raise InvalidValue("report", "is of one impact; leave it out, or ask for one")
    for _, how in asked:
        contact_of(how.body)  # before the work
    found = []
    with progress_bar() as progress:
        task = progress.add_task("impacts", total=len(asked))
        for where, how in asked:
            found.append(record_of(impact(where, how)))
            progress.advance(task)
    speeds = [record["safe_speed"] for record in found if record["safe_speed"] is not None]
    return {
        "impacts": found,
        "worst": max(range(len(found)), key=lambda i: found[i]["share_of_limit"]),
        "safe_speed": min(speeds, default=None),
        "warnings": list(dict.fromkeys(line for record in found for line in record["warnings"])),
    }


def print_impacts(result: Mapping[str, Any]) -> None:
    """Print a line for each impact, the worst first; what all have in common is in the title."""
    records = sorted(result["impacts"], key=lambda record: -record["share_of_limit"])
    first, motors = records[0], {record["motors"] for record in records}
    columns: dict[str, list[Cell]] = {
        "point": [folded(record["tip"]) for record in records],
        "direction": [folded(_listed(record["direction"])) for record in records],
        "hit": [folded(f"{r['region']} ({'held' if r['clamped'] else 'free'})") for r in records],
        "motors": [record["motors"] for record in records],
        "peak\nN": [record["peak"] for record in records],
        "after\n0.5 s\nN": [record["pressing"] for record in records],
        "% of\nlimit": [100 * record["share_of_limit"] for record in records],
        "of": [folded(record["binding"]) for record in records],
        "verdict": [folded(record["verdict"]) for record in records],
        "safe\nm/s": [record["safe_speed"] for record in records],
    }
    known = f"model {first['model']}"
    if not tables_are_csv():
        if len(motors) == 1:
            known += f", motors {columns.pop('motors')[0]}"
        if result["safe_speed"] is None:
            del columns["safe\nm/s"]
    print_table(
        f"{first['robot']} at {first['speed']:.3g} m/s, {known}; the worst first",
        list(columns),
        list(zip(*columns.values(), strict=True)),
    )


def _listed(vector: Sequence[float]) -> str:
    return ", ".join(f"{x:.3g}" for x in vector)
