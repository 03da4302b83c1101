# SPDX-License-Identifier: BSD-3-Clause
"""The report of a program."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from softimpact.simulate import simulate_impact

from ..design.report import versions
from ..figures.program import program_figure
from ..output.printed import Cell, shown
from ..program.moments import approach_at, at_point
from ..program.record import COLUMNS, ProgramResult, in_a_sentence, moment_row
from ..program.table import LIMITS
from .arms import ORIGIN, arm_picture
from .page import ArmPicture, Hit, Page, Section, TableOfNumbers, write_page
from .provenance import command, digest_of


def write_program_report(found: ProgramResult, path: Path) -> Path:
    """Write the report of a program."""
    record, table = found.record, found.answer.table
    page = Page(
        question=_question(record),
        answer=_answer(record),
        is_good=record["slowed"] == 0,
        sections=[
            Section(
                "How fast it may run",
                words=[f"{in_a_sentence(record)}."],
                figure=program_figure(table, record["robot"]),
                caption="Factor on the program's speed over time, marked by what binds, and the "
                "factor by the standard's two-body formula (dotted).",
                tables=[_binding(found)] if record["slowed"] else [],
            ),
            Section("The worst moments", arms=list(_arms(found)), tables=[_moments(record)]),
            _trust(found),
            Section("What it rests on", tables=[_bodies(found), _joints(found), _numbers(found)]),
            Section(
                "What to know",
                words=[] if record["warnings"] else ["Nothing was ignored or assumed."],
                lines=record["warnings"],
            ),
        ],
        command=command(),
        versions=versions(),
        digests={
            "robot": found.question.model.robot.digest(),
            "program": digest_of(Path(record["motion"])),
        },
    )
    return write_page(page, path)


def _question(record: dict[str, Any]) -> str:
    regions = ", ".join(record["regions"])
    name = Path(record["motion"]).name
    return f"How fast may {record['robot']} run {name} where it may hit: {regions}?"


def _answer(record: dict[str, Any]) -> str:
    before, after = record["time_before"], record["time_after"]
    if not record["worst"]:
        return "As fast as it is: nothing moves where somebody may be."
    worst = record["worst"][0]
    where = f"at {worst['t']:.4g} s, where {worst['point']} meets the {worst['region']}"
    share = 100 * worst["share_of_limit"]
    if not record["slowed"]:
        return (
            f"As fast as it is, {before:.4g} s: the worst moment uses {share:.0f} % of the "
            f"{worst['limit']} limit, {where}."
        )
    return (
        f"It must slow down to {100 * worst['factor']:.0f} % {where} with {worst['peak']:.0f} N "
        f"({share:.0f} % of the {worst['limit']} limit); in all, {before:.4g} s become "
        f"{after:.4g} s."
    )


def _binding(found: ProgramResult) -> TableOfNumbers:
    """Return what binds how often, and what it costs."""
    table = found.answer.table
    slow = np.flatnonzero(table.factor < 1)
    codes = np.column_stack([table.point, table.body, table.limit, table.motors])[slow]
    half = np.diff(table.time) / 2
    own = np.append(half, 0.0) + np.append(0.0, half)  # of the time, for each sample
    added = own * (1 / table.factor - 1)
    rows: list[tuple[Cell, ...]] = []
    for code in np.unique(codes, axis=0):
        at = slow[(codes == code).all(axis=1)]
        point, body, limit, motors = (int(c) for c in code)
        names = table.names
        words = names.points[point], names.regions[body], LIMITS[limit], names.motors[motors]
        rows.append((*words, len(at), float(table.factor[at].min()), float(added[at].sum())))
    rows.sort(key=lambda row: -float(row[-1] or 0))
    heads = ("point", "region", "limit", "motors", "samples", "least factor", "adds s")
    return TableOfNumbers("What binds, and what it costs", heads, rows)


def _arms(found: ProgramResult) -> Iterator[ArmPicture]:
    for moment in found.record["worst"]:
        hit = Hit(ORIGIN, moment["direction"], moment["share_of_limit"])
        words = (
            f"At {moment['t']:.4g} s: {moment['point']} at {moment['speed']:.3g} m/s, "
            f"{moment['peak']:.0f} N on the {moment['region']}."
        )
        yield arm_picture(found.question.model.robot, moment["q"], {moment["point"]: hit}, words)


def _moments(record: dict[str, Any]) -> TableOfNumbers:
    more: dict[str, str] = {}
    for moment in record["worst"]:
        more |= {"band N": "band"} if "band" in moment else {}
        more |= {"pressure MPa": "pressure"} if "pressure" in moment else {}
    rows = []
    for moment in record["worst"]:
        cells: list[Cell] = [*moment_row(moment), moment["iso_safe_speed"]]
        if "band N" in more:
            cells.append(f"{moment['band'].low:.0f} to {moment['band'].high:.0f}")
        if "pressure MPa" in more:
            pressure = moment.get("pressure")
            cells.append(None if pressure is None else 1e-6 * pressure)
        rows.append(cells)
    return TableOfNumbers(
        "At the program's own speed",
        (*(" ".join(head.split()) for head in COLUMNS), "by the formula m/s", *more),
        rows,
    )


def _trust(found: ProgramResult) -> Section:
    record, engine = found.record, found.answer.engine
    words = [
        "Each rung of the ladder of models checks the one below it; full is the nonlinear robot, "
        "at the worst moment and the speed that is said to be safe there."
    ]
    if engine["name"] == "c":
        words.append(
            f"The generated C looked at all samples. Python decided {engine['decided_by_python']} "
            f"of them, and was asked at {engine['checked']} more: both differ by at most "
            f"{100 * engine['largest_difference']:.2g} % (C leaves up to 2 % of a limit free)."
        )
    else:
        words.append("Every sample was integrated in Python; forces are right to 0.2 %.")
    if not any("band" in moment for moment in record["worst"]):
        words.append("How far what is not known exactly moves the numbers: repeat with --band.")
    tables = [_ladder(found)] if record["worst"] else []
    return Section("How far to trust it", words=words, tables=tables)


def _ladder(found: ProgramResult) -> TableOfNumbers:
    question, moment = found.question, found.record["worst"][0]
    body = question.bodies[moment["body"]]
    speed = moment["factor"] * moment["speed"]
    model = at_point(question.model, moment["point"])
    approach = approach_at(question, moment, speed)
    motors, horizon = question.ends[moment["motors"]], question.horizon
    limit = body.limits.transient.force
    rows: list[tuple[Cell, ...]] = []
    for rung in ("linearised", "full"):
        history = simulate_impact(
            model,
            approach,
            body.contact,
            "full" if rung == "full" else "linearised",
            motors=motors,
            horizon=horizon,
        )
        rows.append((rung, history.peak, 100 * history.peak / limit))
    heads = ("model", "largest force N", "% of the transient limit")
    return TableOfNumbers(f"The worst moment at {speed:.3g} m/s", heads, rows)


def _bodies(found: ProgramResult) -> TableOfNumbers:
    rows: list[tuple[Cell, ...]] = []
    for body in found.question.bodies:
        limits, region = body.limits, body.contact.region
        pressing = limits.quasi_static
        zones = ", ".join(zone.name for zone in body.zones) or "everywhere"
        held = "held" if body.contact.clamped else "free to give way"
        transient = _finite(limits.transient.force)
        late = None if pressing is None else _finite(pressing.force)
        rows.append((region.title, held, zones, limits.transient.quantity, transient, late))
    heads = ("body", "how", "where", "least limit of", "transient N", "quasi-static N")
    return TableOfNumbers("Who may be met (limits as forces; – is none)", heads, rows)


def _finite(force: float) -> float | None:
    return force if np.isfinite(force) else None


def _joints(found: ProgramResult) -> TableOfNumbers:
    record = found.record
    rotors = np.array(record["rotor_inertia"], dtype=float).ravel()
    rows = list(zip(record["joints"], record["joint_stiffness"], rotors.tolist(), strict=True))
    heads = ("joint", "k_s N·m/rad", "rotor kg m²")
    return TableOfNumbers("Joints (stiffness – is rigid)", heads, rows)


def _numbers(found: ProgramResult) -> TableOfNumbers:
    question = found.question
    reaction = next(iter(question.ends.values())).reaction_time
    rows: list[tuple[Cell, ...]] = [
        ("motors", " or ".join(question.ends), ""),
        ("reaction time", shown(reaction) if np.isfinite(reaction) else "none", "s"),
        ("horizon", question.horizon, "s"),
        ("payload and tool", question.payload, "kg"),
        ("watched points", ", ".join(question.points), ""),
        ("samples", float(found.record["samples"]), ""),
    ]
    return TableOfNumbers("Numbers", ("what", "value", "unit"), rows)
