# SPDX-License-Identifier: BSD-3-Clause
"""What is known of a program that was slowed down, for machines and as a table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from softimpact.simulate.zones import Somebody

from ..output.printed import Cell, folded, print_table, say, tables_are_csv
from .moments import Question
from .run import SlowedProgram

GENERATOR = "softimpact program"

MANY = 100_000
"""Samples from which on JSON leaves what is known of each to ``program.csv``."""


@dataclass(frozen=True, eq=False)
class ProgramResult:
    """A program that was looked at.

    Attributes:
        question: what may meet whom.
        answer: by how much it must slow down.
        record: for machines.
    """

    question: Question
    answer: SlowedProgram
    record: dict[str, Any]


def program_record(
    path: Path, question: Question, answer: SlowedProgram, warnings: list[str]
) -> dict[str, Any]:
    """Return everything that an answer depends on, and the answer."""
    model, table = question.model, answer.table
    springs = np.array(model.drives.springs, dtype=float).ravel()
    few = len(table) <= MANY
    if not few:
        line = f"{len(table):,} samples: what is known of each is in program.csv alone, see --out"
        warnings = [*warnings, line]
    return {
        "generator": GENERATOR,
        "motion": path,
        "robot": model.robot.name,
        "joints": model.robot.joint_names,
        "points": question.points,
        "regions": [*dict.fromkeys(table.names.regions)],
        "clamped": question.bodies[0].contact.clamped,
        "bodies": [_body(body) for body in question.bodies],
        "motors": question.ends,
        "horizon": question.horizon,
        "joint_stiffness": [
            float(k) if gives else None
            for k, gives in zip(springs, model.drives.elastic, strict=True)
        ],
        "rotor_inertia": model.drives.rotors,
        "engine": answer.engine,
        "samples": len(table),
        "slowed": int((table.factor < 1).sum()),
        "time": table.time if few else None,
        "factor": table.factor if few else None,
        "binding": [
            table.moment(k) if factor < 1 else None for k, factor in enumerate(table.factor)
        ]
        if few
        else None,
        "time_before": table.time_before,
        "time_after": table.time_after,
        "worst": answer.worst,
        "iso": {
            "factor": table.iso_factor if few else None,
            "time_after": table.time_by_formula,
        },
        "warnings": warnings,
    }


def _body(body: Somebody) -> dict[str, Any]:
    limits = body.limits
    return {
        "region": body.contact.region.name,
        "clamped": body.contact.clamped,
        "shape": body.shape,
        "zones": [zone.name for zone in body.zones],
        "transient": limits.transient,
        "quasi_static": limits.quasi_static,
    }


COLUMNS = ("at\ns", "factor", "point", "region", "limit", "motors", "m/s", "safe\nm/s", "N")


def print_program(found: ProgramResult, out: Path | None) -> None:
    """Print what limits a program as a table."""
    record = found.record
    rows = [[folded(cell) for cell in moment_row(moment)] for moment in record["worst"]]
    print_table(f"{record['robot']}: {in_a_sentence(record)}", COLUMNS, rows)
    banded = [moment for moment in record["worst"] if "band" in moment]
    if banded:
        print_table(
            "95 of 100 cases lie within, for what is not known exactly",
            ("at\ns", "N", "from\nN", "to\nN"),
            [(f"{m['t']:.4g}", m["peak"], m["band"].low, m["band"].high) for m in banded],
        )
    if out is not None:
        say(f"wrote {out}")


def in_a_sentence(record: dict[str, Any]) -> str:
    """Return how long a program takes when it is slowed down."""
    before, after = record["time_before"], record["time_after"]
    formula, ratio = record["iso"]["time_after"], after / before
    longer = f"+{100 * (ratio - 1):.3g} %" if ratio < 4 else f"{ratio:.3g} times as long"
    return (
        f"{before:.4g} s become {after:.4g} s ({longer}; by the two-body formula {formula:.4g} s); "
        f"{record['slowed']} of {record['samples']} samples slow down"
    )


def moment_row(moment: dict[str, Any]) -> Sequence[Cell]:
    """Return a moment as a row below ``COLUMNS``."""
    words = (moment[name] for name in ("point", "region", "limit", "motors"))
    safe = moment["safe_speed"]
    if safe is None and not tables_are_csv():
        safe = "more"  # than the program has
    return (f"{moment['t']:.4g}", moment["factor"], *words, moment["speed"], safe, moment["peak"])
