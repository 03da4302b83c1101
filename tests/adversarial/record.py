# SPDX-License-Identifier: BSD-3-Clause
"""What a search found, as packages and the documentation say it.

Usage: PYTHONPATH=tests python -m adversarial.record writes the documentation anew from the record.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from softimpact.codegen.record.searched import (
    ASKED,
    RECORD,
    Searched,
    Sum,
    searched_table,
    sources_digest,
)

from .search import Found

Rows = Sequence[tuple[Mapping[str, Any], Mapping[str, Any]]]
"""Rounds and what they found."""

PAGE = Path(__file__).parents[2] / "docs/impacts-in-c.md"

FROM, TO = "<!-- searched -->", "<!-- /searched -->"
"""What the table stands between."""


def summed(rows: Rows) -> dict[tuple[str, str], Found]:
    """Return the sums of questions, and of what was drawn."""
    sums: dict[tuple[str, str], Found] = {}
    for job, found in rows:
        name = (str(job["question"]), "wide" if job["wide"] else "plain")
        sums[name] = sums.get(name, Found()).joined(Found(**found))
    return sums


def write(rows: Rows) -> None:
    """Write what was found, of the runtime as it is, and the page that tells it."""
    kept = ("inputs", "bounded", "integrated", "above", "lost", "worst", "below")
    sums = [
        Sum(question, width, **{name: getattr(total, name) for name in kept})
        for (question, width), total in sorted(summed(rows).items(), key=_order)
    ]
    seeds = [job["seed"] for job, _ in rows]
    robots = tuple(sorted({str(job["robot"]) for job, _ in rows}))
    told = Searched(sources_digest(), robots, min(seeds), max(seeds), tuple(sums))
    RECORD.write_text(json.dumps(asdict(told), indent=1) + "\n", encoding="utf-8")
    renew()


def _order(row: tuple[tuple[str, str], Found]) -> tuple[int, str]:
    """Return where a question stands: as the search has them."""
    return list(ASKED).index(row[0][0]), row[0][1]


def page() -> str:
    """Return the page with the table as it should be."""
    before, rest = PAGE.read_text(encoding="utf-8").split(FROM)
    return f"{before}{FROM}\n\n{searched_table()}\n\n{TO}{rest.split(TO)[1]}"


def renew() -> None:
    """Write the page anew."""
    PAGE.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    renew()
