# SPDX-License-Identifier: BSD-3-Clause
"""The report of a front over two or three objectives."""

from __future__ import annotations

from pathlib import Path

from ..design.robust import meets_limit, share_of_limit
from ..figures.trade_off import figure_of_front
from ..figures.trade_off_hardware import figure_of_hardware
from ..front.trade_off_report import TradeOffReport
from ..front.trade_off_words import columns, in_words, rows, values_in_words
from .arms import ORIGIN, arm_picture
from .page import Hit, Section, TableOfNumbers, write_page
from .study_pages import study_page


def write_trade_off_report(report: TradeOffReport, path: Path) -> Path:
    """Write the report of a front."""
    study, found = report.study, report.found
    names = [view.label for view in report.views]
    question = (
        f"What do {', '.join(names[:-1])} and {names[-1]} of {study.robot.name} cost each other?"
    )
    place = found.knee if found.knee is not None else 0
    point = report.points[place]
    which = "at the knee" if found.knee is not None else "at the first of them"
    answer = (
        f"{len(report.points)} designs that no other beats in all of them; {which}: "
        f"{values_in_words(report.views, point.values)}."
    )
    one = point.scenarios[point.worst.index]
    frame = point.scenarios.points[one.point]
    hit = Hit(ORIGIN, point.scenarios.directions[one.direction], share_of_limit(point))
    words = f"The worst scenario of the design {which}: {point.worst.force:.0f} N at {frame}."
    arm = arm_picture(
        study.robot, point.postures[one.pose], {frame: hit}, words, list(point.postures)
    )
    heads = [column.replace("\n", " ") for column in columns(report)]
    checks = [
        (str(i + 1), p.worst.force, check.linearised, check.full)
        for i, (p, check) in enumerate(zip(report.points, report.checks, strict=True))
    ]
    heads_of_checks = ("design", "optimiser N", "linearised N", "nonlinear N")
    sections = [
        Section(
            "The front",
            lines=in_words(report),
            figure=figure_of_front(report),
            caption="Designs that no other beats in all objectives.",
            tables=[TableOfNumbers("Designs", heads, rows(report))],
        ),
        Section(
            "The hardware",
            figure=figure_of_hardware(report),
            caption="Each value of the hardware along the front, with its indifferent range.",
        ),
        Section("The worst scenario", arms=[arm]),
        Section(
            "How far to trust it",
            words=["The worst scenario of each design, integrated independently."],
            tables=[TableOfNumbers("By model", heads_of_checks, checks)],
        ),
    ]
    good = any(meets_limit(p) for p in report.points)
    return write_page(study_page(study, question, answer, good, sections), path)
