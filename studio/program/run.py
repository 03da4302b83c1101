# SPDX-License-Identifier: BSD-3-Clause
"""A program slowed down sample by sample, by the generated C where that is worth it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from softimpact.simulate.program import Danger
from softimpact.symbolic import InvalidValue

from .engine import CompiledEngine, Engine, compiled_engine
from .moments import Question, band_at, by_python, moments_at, slowed
from .motion_source import MotionSource, Survey, passes_of
from .table import Names, ProgramTable
from .trust import nonlinear_share

FEW = 20_000
"""Impacts (samples, points, bodies and kinds of motors) that Python is asked for in a minute, or as
long as C takes to compile."""

BLOCK = {"c": 32_768, "python": 2_000}
"""Samples that are looked at together."""

KEPT = 1_000_000
"""Impacts of which every one is kept for a table of its own."""

CHECKED = 20
"""Samples of a program by C at which Python is asked, too, beside the worst."""

DOUBTED = 5
"""Samples at which the nonlinear robot is asked where that is needed, beside the worst."""

AGREED = 0.04
"""Largest difference of both, relative: C leaves 1 to 2.3 % of a limit free, up to 3.8 %
on bodies that damp hard."""

Announce = Callable[[str, float], AbstractContextManager[Callable[[float], None]]]


@dataclass(frozen=True, eq=False)
class SlowedProgram:
    """The answer.

    Attributes:
        table: a row a sample.
        dangers: all of them, part by part; none where there are too many, or C was asked.
        worst: the worst moments, each with its posture ``q``.
        engine: who found it, and how well C and Python agree.
        warnings: a line each.
    """

    table: ProgramTable
    dangers: Sequence[Sequence[Danger]]
    worst: Sequence[dict[str, Any]]
    engine: dict[str, Any]
    warnings: Sequence[str]


def slowed_program(
    source: MotionSource,
    seen: Survey,
    question: Question,
    engine: Engine,
    band: bool,
    progress: Announce,
) -> SlowedProgram:
    """Return by how much a program must slow down.

    Args:
        source: of the motion.
        seen: of it.
        question: what it may do to whom.
        engine: C, Python, or the quicker one.
        band: whether the worst moments get theirs.
        progress: shows how far it is.

    Raises:
        InvalidValue: C was asked for, and cannot answer.
        SoftImpactError: as ``program_dangers``.
    """
    compiled, warnings = _engine(question, engine, len(seen.time))
    names = Names(
        tuple(question.points),
        tuple(body.contact.region.name for body in question.bodies),
        tuple(question.ends),
    )
    table = ProgramTable.empty(names, seen.time)
    kept: list[list[Danger]] = []
    python = 0
    with progress("samples", len(table)) as done:
        for met in passes_of(source, BLOCK["c" if compiled else "python"]):
            unsure = met
            if compiled is not None:
                samples = compiled.fill(table, met, 0)
                table.forget(samples)
                unsure = met.taken(np.isin(met.sample, samples))
                python += len(samples)
            if len(unsure.q):
                dangers = question.dangers(unsure)
                table.put(dangers, 0)
                if compiled is None and question.width * len(table) <= KEPT:
                    kept.append(dangers)
            done(len(np.unique(met.sample)))
    agreement: dict[str, Any] = {"name": "python"}
    if compiled is not None:
        agreement = {"name": "c", "decided_by_python": python}
        agreement |= _checked(source, question, table)
        if agreement["largest_difference"] > AGREED:
            warnings.append(
                f"C and Python differ by up to {100 * agreement['largest_difference']:.1f} % at "
                f"{agreement['checked']} samples; the slower counted there. Please report this"
            )
    rows = table.worst()
    others = [k for k in _spread(table, DOUBTED) if k not in rows]
    moments = moments_at(source, question, table, [*rows, *others])
    share, moments, told = nonlinear_share(question, moments)
    if share < 1:
        table.lower(share)
        kept = [[danger.lowered(share) for danger in part] for part in kept]
    worst = [slowed(moment, table.factor[moment["sample"]]) for moment in moments[: len(rows)]]
    if band:
        worst = [{**moment, "band": band_at(question, moment)} for moment in worst]
    return SlowedProgram(table, kept, worst, agreement, [*warnings, *told])


def _engine(
    question: Question, engine: str, samples: int
) -> tuple[CompiledEngine | None, list[str]]:
    impacts = samples * question.width
    if engine == "python" or (engine == "auto" and impacts <= FEW):
        return None, []
    found = compiled_engine(
        question.model,
        question.points,
        question.bodies,
        question.ends,
        horizon=question.horizon,
        payload=question.payload,
    )
    if isinstance(found, CompiledEngine):
        return found, []
    if engine == "c":
        raise InvalidValue("engine", f"cannot be c: {found}; choose python")
    minutes = impacts * SLOW / 60
    return None, [f"{found}: Python did it, some {minutes:.0f} minutes for {impacts:,} impacts"]


SLOW = 3e-3
"""What an impact takes in Python [s]."""


def _checked(source: MotionSource, question: Question, table: ProgramTable) -> dict[str, Any]:
    """Ask Python at the worst and at some other samples, and keep what is slower."""
    rows = np.unique([*_spread(table, CHECKED), *table.worst()])
    own = by_python(source, question, table, rows.tolist())
    difference = table.factor[rows] / own.factor - 1
    lower = own.factor < table.factor[rows]
    if lower.any():
        _take(table, rows[lower], own, np.flatnonzero(lower))
    return {"checked": len(rows), "largest_difference": float(abs(difference).max())}


def _spread(table: ProgramTable, count: int) -> list[int]:
    """Return some samples, of those that slow down if there are any."""
    slow = np.flatnonzero(table.factor < 1)
    among = slow if slow.size else np.arange(len(table))
    return list(among[np.linspace(0, len(among) - 1, min(count, len(among))).astype(int)].tolist())


def _take(
    table: ProgramTable, rows: NDArray[np.intp], other: ProgramTable, others: NDArray[np.intp]
) -> None:
    for name, values in vars(other).items():
        if name not in ("names", "time"):
            getattr(table, name)[rows] = values[others]
