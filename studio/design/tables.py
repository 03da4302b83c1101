# SPDX-License-Identifier: BSD-3-Clause
"""A design's results as tables and sentences for people."""

from __future__ import annotations

from softimpact.optimize import Outcome
from softimpact.optimize.study.poses import leaves_a_choice
from softimpact.symbolic.robot.rigid import Array

from ..output.dashes import explain, reasons
from ..output.printed import Cell, print_table, say, tables_are_csv
from .answers_in_words import answers_in_words
from .report import (
    DesignReport,
    RankedPose,
    band_in_words,
    gains_in_words,
    limit_kind,
    nominal_in_words,
    peak_in_words,
    reactions_in_words,
)

MODES = ("table\nN", "free\nN")
"""Columns of the searches, each of which one may leave out."""

COLUMNS = (
    "rank",
    "pose",
    "m_c\nkg",
    "k_r\nkN/m",
    "m_a\nkg",
    "GIAF",
    "before\nN",
    *MODES,
    "Ipopt",
    "best k_s\nkN·m/rad",
)

NARROW = 12
"""Characters of the springs' column that 80 columns have room for: springs that are all equal."""


def print_design(report: DesignReport) -> None:
    """Print the ranking, the winner, what bought the gain, and the checks."""
    study = report.study
    contact = study.contact
    held = "clamped" if contact.clamped else "free to give way"
    rows = [_row(pose) for pose in report.poses]
    fits = tables_are_csv() or all(len(str(row[-1])) <= NARROW for row in rows)
    columns = dict(zip(COLUMNS, zip(*rows, strict=True), strict=True))
    if not fits:
        del columns[COLUMNS[-1]]
    for mode in MODES if not tables_are_csv() else ():
        if not any(columns[mode]):
            del columns[mode]
    print_table(
        f"{study.title}\n{contact.region.title}, {held}, {study.speed:g} m/s; "
        f"{peak_in_words(study)}. Nominal: k_s = {_stiffness(study.nominal)} kN·m/rad",
        list(columns),
        list(zip(*columns.values(), strict=True)),
    )
    if not fits:
        say("joint stiffness of each pose: --csv, or results.json")
    explain(reasons(pose.figures for pose in report.poses))
    for line in [*_notes(report), *_winner(report)]:
        say(line)


def ranking_rows(report: DesignReport) -> tuple[list[str], list[list[Cell]]]:
    """Return heads and rows of the ranking."""
    heads = [column.replace("\n", " ") for column in COLUMNS]
    return heads, [_row(pose) for pose in report.poses]


def _row(pose: RankedPose) -> list[Cell]:
    result, figures = pose.result, pose.figures
    return [
        str(pose.rank),
        result.candidate.pose.name + _marks(pose),
        figures.m_c,
        None if figures.k_r is None else 1e-3 * figures.k_r,
        figures.m_a,
        figures.giaf,
        _force(result.force_before, "" if result.keeps_before else "!"),
        _force(None if result.table is None else result.table.force),
        _force(None if result.free is None else result.free.force),
        _status(result.table, result.free),
        _stiffness(pose.best.springs),
    ]


def _marks(pose: RankedPose) -> str:
    candidate = pose.result.candidate
    return ("*" if candidate.pose.recovered else "") + ("~" if candidate.turned else "")


def _force(force: float | None, mark: str = "") -> str | None:
    return None if force is None else f"{force:.1f}{mark}"


def _stiffness(springs: Array) -> str:
    """Joint stiffnesses in kN·m/rad, once if they are all the same."""
    shown = [f"{1e-3 * float(k):.3g}" for k in springs]
    return shown[0] if len(set(shown)) == 1 else " ".join(shown)


def _status(*outcomes: Outcome | None) -> str:
    found = [outcome for outcome in outcomes if outcome is not None]
    if all(outcome.solved for outcome in found):
        return "solved"
    return ", ".join(f"{o.mode}: {o.status}" for o in found if not o.solved)


def _notes(report: DesignReport) -> list[str]:
    notes = []
    if any(pose.result.candidate.pose.recovered for pose in report.poses):
        notes.append("* not in the source, recovered between its neighbours")
    if any(not pose.result.keeps_before for pose in report.poses):
        notes.append("! nominal springs that break a bound in that pose")
    turned = [
        f"{pose.result.candidate.pose.name} by {pose.result.candidate.turned:.2f} rad"
        for pose in report.poses
        if pose.result.candidate.turned
    ]
    if turned:
        notes.append(f"~ given turned about the base and turned back: {', '.join(turned)}")
    for mode in ("table", "free"):
        outcomes = report.design.outcomes(mode)
        if outcomes:
            forces = [outcome.force for outcome in outcomes if outcome.solved]
            near = sum(force <= 1.005 * min(forces) for force in forces)
            notes.append(
                f"{mode}: {len(forces)} of {len(outcomes)} solved, {near} within 0.5 % of the best"
            )
    if report.design.optima:
        ended = ", ".join(f"{each.best.force:.1f}" for each in report.design.optima[:5])
        count, pieces = len(report.design.optima), report.design.branches
        notes.append(
            f"free: {count} different local optima ({ended}{', …' if count > 5 else ''} N)"
            + (f"; {pieces} pieces of the self-motion searched" if pieces else "")
        )
    if not leaves_a_choice(report.study):
        notes.append("free: left out, because the task leaves this arm no other posture")
    return notes


def _winner(report: DesignReport) -> list[str]:
    design, check = report.design, report.check
    winner, region = design.winner, report.study.contact.region
    ratio = winner.force / report.limit
    kind = limit_kind(report.study).replace("_", "-")
    return [
        "",
        f"Winner: {winner.name}, {winner.mode} mode, {winner.force:.1f} N; "
        f"{ratio:.2f} times the {kind} limit of {report.limit:g} N "
        f"(ISO/TS 15066, {region.title.lower()})",
        f"  q   = [{', '.join(f'{angle:.4f}' for angle in winner.q)}] rad",
        f"  k_s = [{', '.join(f'{k:.0f}' for k in winner.springs)}] N·m/rad",
        *(f"  {line}" for line in [*_meaning(report), *_gains(report)]),
        f"Check of the winner: linearised by SUNDIALS {check.linearised:.2f} N "
        f"({100 * (check.linearised / check.nlp - 1):+.3f} % from the optimum), "
        f"nonlinear {check.full:.2f} N ({100 * (check.full / check.nlp - 1):+.2f} %)",
    ]


UNBENT = 1e-9
"""Deflection [m] that counts as none."""


def _meaning(report: DesignReport) -> list[str]:
    """What binds, which numbers matter, and whether the nominal springs are a fair reference."""
    study, answers = report.study, report.design.answers
    bound, reference = study.max_deflection, answers.reference
    bent = "" if answers.deflection > UNBENT else " (no force of the study bends a spring)"
    lines = [
        f"deflection {1e3 * answers.deflection:.4g} mm of {1e3 * bound:.4g} mm{bent}; motors "
        f"{answers.worst_motors.kind} are the worst",
        *answers_in_words(study, answers.indifferent, answers.prices),
    ]
    unfair = nominal_in_words(report.design)
    if unfair is not None:
        lines.append(f"{unfair} (k_s = {_stiffness(reference.springs)} kN·m/rad)")
    return lines


def _gains(report: DesignReport) -> list[str]:
    gains = report.design.gains
    if gains is None:
        return [f"The limit is met at {report.speed_after:.3f} m/s."]
    return [*gains_in_words(gains, report), *reactions_in_words(report), *band_in_words(report)]
