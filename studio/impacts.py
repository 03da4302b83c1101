# SPDX-License-Identifier: BSD-3-Clause
"""Several impacts in one call: all combinations of points, directions and regions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

from softimpact.symbolic import InvalidValue

from .impact import TypedImpact, contact_of, impact
from .impact_record import record_of
from .output import print_table
from .progress import progress_bar
from .situation import Typed

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
    """Print a line for each impact."""
    records = result["impacts"]
    first = records[0]
    print_table(
        f"{first['robot']} at {first['speed']:.3g} m/s, model {first['model']}",
        ("", "point", "direction", "hit", "motors", "peak N", "pressing N", "of limit %",
         "binding", "verdict", "safe m/s"),
        [
            (
                "worst" if i == result["worst"] else "",
                record["tip"],
                ", ".join(f"{x:.3g}" for x in record["direction"]),
                f"{record['region']} ({'held' if record['clamped'] else 'free'})",
                record["motors"],
                record["peak"],
                record["pressing"],
                f"{100 * record['share_of_limit']:.0f}",
                record["binding"],
                record["verdict"],
                record["safe_speed"],
            )
            for i, record in enumerate(records)
        ],
    )  # fmt: skip
