# SPDX-License-Identifier: BSD-3-Clause
"""The reports of a design, and of one machine for many scenarios."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from softimpact.optimize.robust.robust import RobustDesign

from ..design.report import (
    DesignReport,
    band_in_words,
    gains_in_words,
    nominal_in_words,
    reactions_in_words,
)
from ..design.robust import meets_limit, robust_in_words
from ..design.scenario_checks import CheckedScenario, place_in_words
from ..design.tables import ranking_rows
from ..figures import (
    figure_of_forces,
    figure_of_gains,
    figure_of_ranking,
    figure_of_springs,
)
from ..figures.robust import figure_of_robust_design
from ..output.dashes import reasons
from ..output.printed import Cell
from .arms import ORIGIN, arm_picture
from .page import Hit, Section, TableOfNumbers, write_page
from .study_pages import impact_in_words, joints, study_page


def write_design_report(report: DesignReport, path: Path) -> Path:
    """Write the report of a design."""
    study, winner = report.study, report.design.winner
    question = f"Which springs and posture hurt least where {impact_in_words(study)}?"
    good = winner.force <= report.limit
    keeps = "keeps" if good else "breaks"
    answer = (
        f"{winner.name}, {'posture held' if winner.mode == 'table' else 'posture free'}: "
        f"{winner.force:.0f} N, which {keeps} the limit of {report.limit:g} N; every limit is kept "
        f"up to {report.speed_after:.3g} m/s ({report.speed_before:.3g} m/s before)."
    )
    return write_page(study_page(study, question, answer, good, list(_design(report))), path)


def _design(report: DesignReport) -> Iterator[Section]:
    study, design = report.study, report.design
    winner, answers, gains = design.winner, design.answers, design.gains
    yield Section(
        "What springs, posture and speed buy",
        lines=[
            *(
                [unfair[0].upper() + unfair[1:] + "."]
                if (unfair := nominal_in_words(design))
                else []
            ),
            *([] if gains is None else gains_in_words(gains, report)),
        ],
        figure=None if gains is None else figure_of_gains(report, gains),
        caption="Peak force and safe speed before, with springs, with the posture, with both.",
        tables=[
            TableOfNumbers(
                "What binds, and what more of it buys",
                ("bound", "more of it", "buys N"),
                [(price.bound, price.room, price.newtons) for price in answers.prices],
            )
        ],
    )
    yield Section(
        "Force over time",
        words=[line.strip() for line in reactions_in_words(report)],
        figure=figure_of_forces(report),
        caption="Contact force of the winner and of the worst pose as it is, and the limit.",
    )
    hit = Hit(ORIGIN, study.direction, winner.force / report.limit)
    others = [pose.result.candidate.q for pose in report.poses]
    words = f"The winner, hit at {study.model.tip}; the other poses behind it."
    yield Section(
        "The posture",
        arms=[arm_picture(study.robot, winner.q, {study.model.tip: hit}, words, others)],
        tables=[_angles(study.robot.joint_names, winner.q)],
    )
    yield Section(
        "The springs",
        figure=figure_of_springs(report),
        caption="Joint stiffness of the winner and of what other searches found.",
        tables=[joints(study, winner.springs, answers.indifferent[list(study.groups)])],
    )
    heads, rows = ranking_rows(report)
    yield Section(
        "All poses",
        figure=figure_of_ranking(report),
        caption="Peak force of each pose before and after.",
        words=list(reasons(pose.figures for pose in report.poses)),
        tables=[TableOfNumbers("By rank", heads, rows)],
    )
    check = report.check
    checks: list[tuple[Cell, ...]] = [
        ("the optimiser", check.nlp, None),
        ("linearised, by SUNDIALS", check.linearised, 100 * (check.linearised / check.nlp - 1)),
        ("full, the nonlinear robot", check.full, 100 * (check.full / check.nlp - 1)),
    ]
    yield Section(
        "How far to trust it",
        words=[
            "Each rung of the ladder of models checks the one below it.",
            *band_in_words(report),
        ],
        tables=[TableOfNumbers("The winner by model", ("model", "N", "% away"), checks)],
    )


def _angles(names: tuple[str, ...], q: object) -> TableOfNumbers:
    rows = [(name, float(angle)) for name, angle in zip(names, list(q), strict=True)]  # type: ignore[call-overload]
    return TableOfNumbers("Angles", ("joint", "rad"), rows)


def write_robust_report(
    design: RobustDesign, checks: Sequence[CheckedScenario], path: Path
) -> Path:
    """Write the report of one machine for many scenarios, some of which were simulated."""
    study, scenarios, worst = design.study, design.scenarios, design.worst
    one = scenarios[worst.index]
    words = scenarios.describe(one)
    good = meets_limit(design)
    question = f"Which springs of {study.robot.name} hurt least in {len(scenarios)} scenarios?"
    answer = (
        f"At worst {worst.force:.0f} N, {100 * worst.share:.0f} % of its limit: pose "
        f"{words['pose']}, {words['point']} against the {words['region']}."
    )
    hit = Hit(ORIGIN, scenarios.directions[one.direction], worst.share)
    point = scenarios.points[one.point]
    arm = arm_picture(
        study.robot,
        design.postures[one.pose],
        {point: hit},
        f"The worst scenario: {point} at {words['speed']:g} m/s.",
        list(design.postures),
    )
    simulated = [
        (place_in_words(design, each.index), *vars(each.check).values()) for each in checks
    ]
    models = ("scenario", "optimiser N", "linearised N", "nonlinear N")
    sections = [
        Section(
            "What was found",
            lines=robust_in_words(design),
            figure=figure_of_robust_design(design),
            caption="The objective before and after, and each spring with its indifferent range.",
        ),
        Section("The worst scenario", arms=[arm]),
        Section(
            "The springs",
            tables=[joints(study, design.springs, design.indifferent[list(study.groups)])],
        ),
        Section(
            "How far to trust it",
            words=["The worst scenario, and those nearly as bad, integrated independently."],
            tables=[TableOfNumbers("By model", models, simulated)],
        ),
    ]
    return write_page(study_page(study, question, answer, good, sections), path)
