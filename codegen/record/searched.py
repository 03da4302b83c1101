# SPDX-License-Identifier: BSD-3-Clause
"""What search the runtime has stood: read from what the search itself wrote, said in one place."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

RECORD = Path(__file__).parent / "searched.json"
"""Written by ``python -m adversarial --record``."""

RUNTIME = Path(__file__).parents[1] / "runtime"

ASKED = {
    "limit": "safe speeds",
    "slower": "many slower speeds",
    "laws": "laws by table, covers",
    "pressing": "what presses after 0.5 s",
    "place": "points given at run time",
    "motion": "joint velocities given",
    "worst": "the hardest direction",
}
"""What is asked, by the search's names."""

WIDTHS = {"plain": "what arms and bodies have", "wide": "many decades"}
"""What is drawn, by the search's names."""


@dataclass(frozen=True)
class Sum:
    """What was found of one question.

    Attributes:
        question: of ``ASKED``.
        width: of ``WIDTHS``.
        inputs: that were looked at.
        bounded: of these, answered by a bound.
        integrated: impacts integrated.
        above: inputs with a force above its limit.
        lost: inputs answered though motors cannot move the contact point along n at all.
        worst: largest force over its limit.
        below: the same at speeds below the answer.
    """

    question: str
    width: str
    inputs: int
    bounded: int
    integrated: int
    above: int
    lost: int
    worst: float
    below: float


@dataclass(frozen=True)
class Searched:
    """What was searched.

    Attributes:
        sources: digest of the runtime then.
        robots: that were looked at.
        first_seed: of the rounds.
        last_seed: of the rounds.
        sums: what was found.
    """

    sources: str
    robots: tuple[str, ...]
    first_seed: int
    last_seed: int
    sums: tuple[Sum, ...]


def sources_digest() -> str:
    """Return a digest of the runtime's C."""
    files = sorted(RUNTIME.glob("*.[ch]"))
    return hashlib.sha256(b"\0".join(path.read_bytes() for path in files)).hexdigest()[:16]


@cache
def record() -> Searched:
    """Return what the search wrote."""
    read: dict[str, Any] = json.loads(RECORD.read_text(encoding="utf-8"))
    sums = tuple(Sum(**row) for row in read.pop("sums"))
    return Searched(**{**read, "robots": tuple(read["robots"]), "sums": sums})


def _of(width: str) -> tuple[int, int, float]:
    sums = [one for one in record().sums if one.width == width]
    return (
        sum(one.inputs for one in sums),
        sum(one.above for one in sums),
        max(one.worst for one in sums),
    )


def searched() -> str:
    """Return what packages say about it."""
    told = record()
    (plain, above, worst), (wide, above_wide, worst_wide) = _of("plain"), _of("wide")
    which = "" if told.sources == sources_digest() else ", by the runtime before its last changes"
    return (
        f"{plain:,} random and hill-climbed inputs that arms and bodies have, on "
        f"{len(told.robots)} robots, float and double (make adversarial){which}: forces at the "
        f"answers and at slower speeds by the tests' own integrator, {above:,} inputs above the "
        f"limit, the hardest at {worst:.4f} of it; spread over many decades {above_wide:,} of "
        f"{wide:,}, at most {worst_wide:.4f}. By questions: docs/impacts-in-c.md"
    )


def searched_table() -> str:
    """Return the table of the documentation."""
    told = record()
    lines = [
        f"Seeds {told.first_seed} to {told.last_seed}, {', '.join(told.robots)}; digest of "
        f"`codegen/runtime` then: `{told.sources}`.",
        "",
        "| asked | drawn from | inputs | by a bound | impacts | above | lost | worst | slower |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for one in told.sums:
        slower = f"{one.below:.4f}" if one.below else ""
        lines.append(
            f"| {ASKED[one.question]} | {WIDTHS[one.width]} | {one.inputs:,} | {one.bounded:,} | "
            f"{one.integrated:,} | {one.above:,} | {one.lost:,} | {one.worst:.4f} | {slower} |"
        )
    return "\n".join(lines)
