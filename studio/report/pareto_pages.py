# SPDX-License-Identifier: BSD-3-Clause
"""The reports of Pareto fronts, and of a ranking of postures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from softimpact.optimize import Study

from ..design.selection import NAMES, Criterion, PoseFigures, figures_table
from ..figures.pareto import figure_of_fronts, figure_of_speeds
from ..figures.pareto_designs import figure_of_designs
from ..figures.select import figure_of_selection
from ..front.pareto_report import ParetoReport
from ..front.pareto_words import columns, in_words, rows
from ..output.dashes import reasons
from .arms import ORIGIN, arm_picture
from .page import Hit, Section, TableOfNumbers, write_page
from .study_pages import impact_in_words, study_page


def write_pareto_report(report: ParetoReport, path: Path) -> Path:
    """Write the report of Pareto fronts."""
    study, points = report.study, report.fronts["free"]
    first, last = points[0].point, points[-1].point
    question = f"What does accuracy cost where {impact_in_words(study)}?"
    good = any(p.point.force <= report.limit for p in points)
    met = "some keep" if good else "none keeps"
    answer = (
        f"From {1e3 * first.deflection:.3g} to {1e3 * last.deflection:.3g} mm of deflection the "
        f"force falls from {first.force:.0f} to {last.force:.0f} N; {met} the limit of "
        f"{report.limit:g} N."
    )
    ends = [(first, "the most accurate"), (last, "the softest")]
    arms = [
        arm_picture(
            study.robot,
            point.outcome.q,
            {study.model.tip: Hit(ORIGIN, study.direction, point.force / report.limit)},
            f"{name.capitalize()} design: {point.force:.0f} N at {1e3 * point.deflection:.3g} mm.",
        )
        for point, name in ends
    ]
    heads = [column.replace("\n", " ") for column in columns(report)]
    sections = [
        Section(
            "Force by accuracy",
            lines=in_words(report),
            figure=figure_of_fronts(report),
            caption="Least peak force at each deflection, with the posture free and held.",
            tables=[TableOfNumbers("Fronts", heads, rows(report))],
        ),
        Section(
            "Safe speed by accuracy",
            figure=figure_of_speeds(report),
            caption="Speed at which the limit is met, at each deflection.",
        ),
        Section("The ends of the front", arms=arms),
        Section(
            "The designs",
            figure=figure_of_designs(report),
            caption="Joint stiffness and posture along the front.",
        ),
        _pareto_trust(report),
    ]
    return write_page(study_page(study, question, answer, good, sections), path)


def _pareto_trust(report: ParetoReport) -> Section:
    table = [
        (1e3 * p.point.deflection, p.check.nlp, p.check.linearised, p.check.full)
        for p in report.fronts["free"]
    ]
    heads = ("deflection mm", "optimiser N", "linearised N", "full N")
    return Section(
        "How far to trust it",
        words=["Each rung of the ladder of models checks the one below it."],
        tables=[TableOfNumbers("The front by model", heads, table)],
    )


def write_selection_report(
    study: Study, criterion: Criterion, ranked: Sequence[PoseFigures], path: Path
) -> Path:
    """Write the report of a ranking."""
    best, limit = ranked[0], study.limit
    least, most = (f([p.peak_force for p in ranked]) for f in (min, max))
    good = best.peak_force <= limit
    question = f"Which posture hurts least where {impact_in_words(study)}?"
    answer = (
        f"{best.name}, by {NAMES[criterion]}: {best.peak_force:.0f} N of {limit:g} N allowed; all "
        f"{len(ranked)} postures lie from {least:.0f} to {most:.0f} N."
    )
    hit = Hit(ORIGIN, study.direction, best.peak_force / limit)
    words = f"{best.name}, hit at {study.model.tip}; the other postures behind it."
    arm = arm_picture(study.robot, best.q, {study.model.tip: hit}, words, [p.q for p in ranked[1:]])
    heads, cells = figures_table(ranked)
    peaks = np.array([p.peak_force for p in ranked])
    spread = (
        f"The best posture by force has {100 * (1 - peaks.min() / peaks.max()):.0f} % less force "
        "than the worst. How far what is not known exactly moves a force: simulate --band."
    )
    sections = [
        Section(
            "The ranking",
            figure=figure_of_selection(study, criterion, ranked),
            caption="Peak force of each posture at the nominal stiffness, best first.",
            words=list(reasons(ranked)),
            tables=[TableOfNumbers("By rank", heads, cells)],
        ),
        Section("The posture", arms=[arm]),
        Section("How far to trust it", words=[spread, _rungs(study, best)]),
    ]
    return write_page(study_page(study, question, answer, good, sections), path)


def _rungs(study: Study, best: PoseFigures) -> str:
    from ..design.checks import simulated

    full = simulated(study, best.q, study.nominal, "full").peak
    off = 100 * (full / best.peak_force - 1)
    return f"The nonlinear robot, one rung up, gives {full:.1f} N for {best.name} ({off:+.2f} %)."
