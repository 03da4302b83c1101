# SPDX-License-Identifier: BSD-3-Clause
"""A program slowed down sample by sample, by the generated C where that is worth it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from softimpact.simulate import Approach
from softimpact.simulate.band import Band, impact_band
from softimpact.simulate.program import Danger, formula_speed, program_dangers
from softimpact.simulate.trajectory import Passes
from softimpact.simulate.zones import Somebody
from softimpact.symbolic import ImpactModel, InvalidValue, Motors
from softimpact.symbolic.robot.rigid import Array

from .motion_source import MotionSource, Survey, passes_of, samples_of
from .program_engine import CompiledEngine, Engine, compiled_engine
from .program_table import Names, ProgramTable

FEW = 20_000
"""Impacts (samples, points, bodies and kinds of motors) that Python is asked for in a minute, or as
long as C takes to compile."""

BLOCK = {"c": 32_768, "python": 2_000}
"""Samples that are looked at together."""

KEPT = 1_000_000
"""Impacts of which every one is kept for a table of its own."""

CHECKED = 20
"""Samples of a program by C at which Python is asked, too, beside the worst."""

AGREED = 0.04
"""Largest difference of both, relative: C leaves 1 to 2.3 % of a limit free, up to 3.8 %
on bodies that damp hard."""

Announce = Callable[[str, float], AbstractContextManager[Callable[[float], None]]]


@dataclass(frozen=True, eq=False)
class Question:
    """What may meet whom, as ``program_dangers`` takes it."""

    model: ImpactModel
    points: Sequence[str]
    bodies: Sequence[Somebody]
    ends: Mapping[str, Motors]
    horizon: float
    payload: float

    @property
    def width(self) -> int:
        """Impacts a sample."""
        return len(self.points) * len(self.bodies) * len(self.ends)

    def dangers(
        self, met: Passes, seen: Callable[[int], None] = lambda count: None
    ) -> list[Danger]:
        """Return what is dangerous at some samples, by Python."""
        return program_dangers(
            self.model,
            met,
            self.points,
            self.bodies,
            self.ends,
            horizon=self.horizon,
            payload=self.payload,
            seen=seen,
        )


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
    worst = _worst(source, question, table, band)
    return SlowedProgram(table, kept, worst, agreement, warnings)


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
    slowed = np.flatnonzero(table.factor < 1)
    among = slowed if slowed.size else np.arange(len(table))
    spread = among[np.linspace(0, len(among) - 1, min(CHECKED, len(among))).astype(int)]
    rows = np.unique([*spread.tolist(), *table.worst()])
    own = _by_python(source, question, table, rows)
    difference = table.factor[rows] / own.factor - 1
    lower = own.factor < table.factor[rows]
    if lower.any():
        _take(table, rows[lower], own, np.flatnonzero(lower))
    return {"checked": len(rows), "largest_difference": float(abs(difference).max())}


def _by_python(
    source: MotionSource, question: Question, table: ProgramTable, rows: NDArray[np.intp]
) -> ProgramTable:
    """Return Python's rows of a table."""
    found = samples_of(source, [int(row) for row in rows])
    parts = [
        replace(found[int(k)], sample=0 * found[int(k)].sample + i) for i, k in enumerate(rows)
    ]
    met = Passes(*(np.concatenate([vars(p)[name] for p in parts]) for name in vars(parts[0])))
    own = ProgramTable.empty(table.names, table.time[rows])
    own.put(question.dangers(met), 0)
    return own


def _take(
    table: ProgramTable, rows: NDArray[np.intp], other: ProgramTable, others: NDArray[np.intp]
) -> None:
    for name, values in vars(other).items():
        if name not in ("names", "time"):
            getattr(table, name)[rows] = values[others]


def _worst(
    source: MotionSource, question: Question, table: ProgramTable, band: bool
) -> list[dict[str, Any]]:
    """Return the worst moments, with all that Python knows of them."""
    rows = np.array(table.worst(), dtype=np.intp)
    if not rows.size:
        return []
    found = samples_of(source, [int(k) for k in rows])
    own = _by_python(source, question, table, rows)
    moments = []
    for i, k in enumerate(rows):
        met, factor = found[int(k)], table.factor[k]
        moment = own.moment(i)
        assert moment is not None
        moment |= {"sample": int(k), "t": table.time[k], "factor": factor, "q": met.q[0]}
        if factor < 1:
            moment["safe_speed"] = factor * moment["speed"]
        moment["body"] = int(own.body[i])
        body = question.bodies[moment["body"]]
        moment["iso_safe_speed"] = formula_speed(question.model, body, question.payload)
        moment["joint_velocity"] = _pass(question, met, moment)
        if body.shape is not None:
            moment["pressure"] = body.shape.pressure(moment["peak"])
        if band:
            moment["band"] = _band(question, body, moment)
        moments.append(moment)
    return moments


def _pass(question: Question, met: Passes, moment: dict[str, Any]) -> Array:
    """Return the joint velocities of the pass of a sample that is meant."""
    at = at_point(question.model, moment["point"])
    J = np.array(at.jacobian(ca.DM(met.q[0])), dtype=float)
    rate = met.velocity[:, list(at.independent)]
    along = rate @ J.T @ moment["direction"]
    return np.asarray(met.velocity[int(np.argmin(abs(along - moment["speed"])))])


def at_point(model: ImpactModel, point: str) -> ImpactModel:
    """Return an arm with another contact point."""
    return replace(model, tip=model.robot.frame(point).name)


def approach_at(question: Question, moment: dict[str, Any], speed: float | None = None) -> Approach:
    """Return how a point moves at one of the worst moments, at that speed or another."""
    at = at_point(question.model, moment["point"])
    rate = np.array(moment["joint_velocity"])[list(at.independent)] / moment["speed"]
    direction = np.array(moment["direction"], dtype=float)
    return Approach(moment["q"], direction, moment["speed"] if speed is None else speed, rate)


def _band(question: Question, body: Somebody, moment: dict[str, Any]) -> Band:
    """Return the band of the peak at the program's own speed."""
    return impact_band(
        at_point(question.model, moment["point"]),
        approach_at(question, moment),
        body.contact,
        question.ends.values(),
        body.limits,
        horizon=question.horizon,
    ).peak
