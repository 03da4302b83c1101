# SPDX-License-Identifier: BSD-3-Clause
"""What Pareto fronts of postures say, as a table and sentences."""

from __future__ import annotations

from itertools import pairwise
from math import log

from softimpact.optimize import ParetoPoint
from softimpact.optimize.study.poses import leaves_a_choice
from softimpact.optimize.units import ratio_in_words

from ..design.answers_in_words import answers_in_words
from ..design.checks import checks_in_words
from ..design.report import limit_kind, peak_in_words
from ..output.printed import Cell
from .pareto_report import CheckedFrontPoint, ParetoReport, price_of_deflection
from .words import FrontWords

MM = 1e3
"""Millimetres in a metre."""

UNMOVED = 1e-3
"""Change of a joint's coordinate [rad, m] below which a posture is the same."""

WORTH_SAYING = 5e-4
"""Share of a force that is worth a sentence."""

COLUMNS = (
    "deflection\nmm",
    "free\nN",
    "a tenth\nbuys N",
    "from",
    "best\ngiven\nN",
    "pose",
    "task's\nN",
    "safe,\nfree\nm/s",
    "safe,\ntask's\nm/s",
)

TABLE = "fronts.csv"
"""File with the points of all fronts."""

STATUS = "Ipopt"
"""Head of a column that is there where Ipopt failed at a level."""


def front_words(report: ParetoReport) -> FrontWords:
    """Return what the fronts say."""
    return FrontWords(
        heading(report),
        columns(report),
        rows(report),
        in_words(report),
        TABLE,
        "A dash: out of reach, or no better than a more accurate design.",
    )


def heading(report: ParetoReport) -> str:
    """Return what the table is about."""
    study = report.study
    held = "clamped" if study.contact.clamped else "free to give way"
    return (
        f"{study.title}\n{study.contact.region.title}, {held}, {study.speed:g} m/s; least "
        f"peak by the largest deflection allowed ({peak_in_words(study)})"
    )


def columns(report: ParetoReport) -> tuple[str, ...]:
    """Return the table's heads."""
    return (*COLUMNS, STATUS) if report.pareto.free.unsolved else COLUMNS


def rows(report: ParetoReport) -> list[list[Cell]]:
    """Return a row for each level; a dash is a level out of reach, or no better than another."""
    return [_row(report, float(level)) for level in report.pareto.levels]


def _row(report: ParetoReport, level: float) -> list[Cell]:
    free, given, task = (report.at(name, level) for name in ("free", "given", "task"))
    return [
        f"{MM * level:.4g}",
        _force(free),
        None if free is None else f"{price_of_deflection(free.point):.2g}",
        _start(free),
        _force(given),
        None if given is None else given.point.outcome.name,
        _force(task),
        None if free is None else f"{free.safe_speed:.3f}",
        None if task is None else f"{task.safe_speed:.3f}",
        *([_status(report, level)] if report.pareto.free.unsolved else []),
    ]


def _force(checked: CheckedFrontPoint | None) -> str | None:
    return None if checked is None else f"{checked.point.force:.1f}"


def _start(checked: CheckedFrontPoint | None) -> str | None:
    """The pose that the search began with; a held one that no other beats says so."""
    if checked is None:
        return None
    outcome = checked.point.outcome
    return outcome.name if outcome.mode == "free" else f"{outcome.name} held"


def _status(report: ParetoReport, level: float) -> str | None:
    i = report.pareto.levels.tolist().index(level)
    outcome = report.pareto.free.outcomes[i]
    if outcome is None:
        return None
    return "solved" if outcome.solved else outcome.status


def in_words(report: ParetoReport) -> list[str]:
    """Return what the fronts say, a sentence each."""
    return [
        *_trade_off(report),
        *_posture(report),
        *_at_the_studys_bound(report),
        *_limit(report),
        _check(report),
        *_unsolved(report),
    ]


def _trade_off(report: ParetoReport) -> list[str]:
    points = [checked.point for checked in report.fronts["free"]]
    first, last = points[0], points[-1]
    saved = 100 * (1 - last.force / first.force)
    lines = [
        f"Accuracy: from {MM * first.deflection:.3g} to {MM * last.deflection:.3g} mm of "
        f"deflection the force falls from {first.force:.1f} to {last.force:.1f} N "
        f"({saved:.1f} %)."
    ]
    if len(points) > 1:
        a, b = max(pairwise(points), key=lambda pair: _slope(*pair))
        of = "deflection"
        lines.append(
            f"It pays most from {MM * a.deflection:.3g} to {MM * b.deflection:.3g} mm: "
            f"{a.force - b.force:.1f} N for {ratio_in_words(b.deflection / a.deflection, of)}."
        )
    bend = report.knee("free")
    if bend is not None:
        at = points[bend]
        lines.append(
            f"The knee is at {MM * at.deflection:.3g} mm and {at.force:.1f} N: more deflection "
            "buys less for what it costs, more accuracy costs more."
        )
        if at.meaning is not None:
            lines += answers_in_words(report.study, at.meaning.indifferent, at.meaning.prices)
    return lines


def _slope(a: ParetoPoint, b: ParetoPoint) -> float:
    """Force saved between two points, by the logarithm of the deflection [N]."""
    return (a.force - b.force) / log(b.deflection / a.deflection)


def _posture(report: ParetoReport) -> list[str]:
    """What a free posture buys over the task's own, in force and in accuracy."""
    name = report.study.task_pose.name
    free, task = report.fronts["free"], report.fronts["task"]
    if not task:
        return [f"Posture: held as in {name}, no accuracy of these is within reach."]
    reached = (
        f"and reaches {MM * free[0].point.deflection:.3g} mm; {name} reaches "
        f"{MM * task[0].point.deflection:.3g} mm."
    )
    if not leaves_a_choice(report.study):
        return [f"Posture: the task leaves no other than that of {name}."]
    pairs = [(p.point, report.within("free", p.point.deflection)) for p in task]
    gains = [
        (1 - better.point.force / point.force, point.deflection)
        for point, better in pairs
        if better is not None and _moved(point, better.point)
    ]
    most, at = max(gains, default=(0.0, 0.0))
    if most < WORTH_SAYING:
        return [f"Posture: freeing it saves nothing of the force of {name}, {reached}"]
    return [
        f"Posture: freeing it saves up to {100 * most:.1f} % of the force of {name} (at "
        f"{MM * at:.3g} mm), {reached}"
    ]


def _moved(held: ParetoPoint, free: ParetoPoint) -> bool:
    """Whether a posture differs from the one held; else it has no part in what is saved."""
    return float(abs(free.outcome.q - held.outcome.q).max()) > UNMOVED


def _at_the_studys_bound(report: ParetoReport) -> list[str]:
    study, reference = report.study, report.pareto.reference
    before = (
        f"{study.task_pose.name} with nominal springs has {MM * reference.deflection:.3g} mm and "
        f"{reference.force:.1f} N"
    )
    found = report.within("free", study.max_deflection)
    if found is None:
        return [f"Before the design {before}."]
    return [
        f"Within the study's {MM * study.max_deflection:.3g} mm: {found.point.force:.1f} N; before "
        f"the design {before}."
    ]


def _limit(report: ParetoReport) -> list[str]:
    free, kind = report.fronts["free"], limit_kind(report.study).replace("_", "-")
    limit = f"the {kind} limit of {report.limit:g} N (ISO/TS 15066)"
    good = [p for p in free if p.point.force <= report.limit]
    speed = f"{report.study.speed:g} m/s"
    met = (
        f"At {speed} {limit} is met from {MM * good[0].point.deflection:.3g} mm on."
        if good
        else f"At {speed} no accuracy meets {limit}."
    )
    return [
        met,
        f"Speed: the limit is met at {free[0].safe_speed:.3f} m/s at the accurate end and at "
        f"{free[-1].safe_speed:.3f} m/s at the soft end ({report.reference_speed:.3f} m/s before "
        "the design).",
    ]


def _check(report: ParetoReport) -> str:
    checks = [checked.check for points in report.fronts.values() for checked in points]
    return checks_in_words("", checks)


def _unsolved(report: ParetoReport) -> list[str]:
    fronts = [report.pareto.free, *report.pareto.held.values()]
    asked = sum(o is not None for front in fronts for o in front.outcomes)
    failed = [outcome for front in fronts for outcome in front.unsolved]
    if not failed:
        return [f"Ipopt solved all {asked} levels of all postures."]
    kinds = ", ".join(sorted({outcome.status for outcome in failed}))
    return [f"Ipopt failed at {len(failed)} of {asked} levels of all postures ({kinds})."]
