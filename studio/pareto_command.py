# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact pareto``: what accuracy costs in force and speed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from . import options as o

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from softimpact.optimize import Study
    from softimpact.optimize.running.execution import Execution

    from .pareto_report import ParetoReport

OutOption = Annotated[
    Path | None,
    typer.Option("--out", metavar="DIR", help="Folder of results; default results/STUDY_pareto."),
]
PointsOption = Annotated[
    int | None,
    typer.Option(
        metavar="N", help="Number of levels of each instead of the study's.", min=2, max=100
    ),
]
ObjectivesOption = Annotated[
    str | None,
    typer.Option(
        metavar="LIST",
        help="Two or three of force, accuracy, speed, mass, or names of objectives and bounds.",
    ),
]


def pareto(
    study: o.StudyFileArgument,
    out: OutOption = None,
    points: PointsOption = None,
    objectives: ObjectivesOption = None,
    region: o.RegionOption = None,
    speed: o.SpeedOption = None,
    page: o.ReportOption = None,
    workers: o.WorkersOption = None,
    dask: o.DaskOption = None,
    resume: o.ResumeOption = False,
    json: o.JsonOption = False,
) -> None:
    """Find designs that no other beats: in force and accuracy, or in objectives of your choice."""
    from softimpact.optimize import load_study
    from softimpact.optimize.front.trade_off import asks_for_trade_off
    from softimpact.optimize.running.execution import Execution

    from .output import failures_as_json, print_json, print_warnings
    from .pareto_record import GENERATOR, pareto_record
    from .results_folder import (
        replaced_folder,
        require_folder_of,
        require_replaceable_results,
        running,
    )
    from .values import given

    named = None if objectives is None else [n for n in map(str.strip, objectives.split(",")) if n]
    changed = {
        "impact": given(region=region, speed=speed),
        "pareto": given(points=points, objectives=named),
    }
    overrides = {name: part for name, part in changed.items() if part}
    problem = load_study(study, overrides)
    folder = out or Path("results") / f"{problem.source.stem}_pareto"
    require_replaceable_results(folder, GENERATOR)
    require_folder_of(page)
    how = Execution(workers, dask, resume)
    if asks_for_trade_off(problem):
        _trade_off(problem, folder, page, how, json)
        return
    with failures_as_json(json), running(how, folder) as pool:
        report = _search(problem, pool)
        record = pareto_record(report)
        with replaced_folder(folder, GENERATOR) as fresh:
            _write(report, record, fresh)
    if page is not None:
        from .report.pareto_pages import write_pareto_report

        write_pareto_report(report, page)
    print_warnings(record["warnings"])
    if json:
        print_json({"out": folder, **record})
    else:
        _print(report, folder)


def _trade_off(study: Study, folder: Path, page: Path | None, how: Execution, json: bool) -> None:
    """Find and write a front over objectives of a machine for scenarios."""
    from softimpact.optimize.front.trade_off import trade_off_front

    from .figures.trade_off import draw_trade_off_figures
    from .output import (
        failures_as_json,
        print_json,
        print_table,
        print_warnings,
        say,
        write_json,
    )
    from .pareto_record import GENERATOR
    from .progress import optimiser_bar
    from .results_folder import RESULTS, replaced_folder, running
    from .trade_off_record import trade_off_record, write_points
    from .trade_off_report import trade_off_report
    from .trade_off_words import columns, heading, in_words, markdown, rows

    with failures_as_json(json), running(how, folder) as pool, optimiser_bar() as progress:
        task = progress.add_task("compile", total=None)

        def advance(what: str, done: int, total: int) -> None:
            progress.update(task, description=what, completed=done, total=total)

        report = trade_off_report(trade_off_front(study, pool, advance), advance)
        record = trade_off_record(report)
        with replaced_folder(folder, GENERATOR) as fresh:
            write_json(fresh / RESULTS, record)
            write_points(report, fresh / "front.csv")
            figures = draw_trade_off_figures(report, fresh)
            words = markdown(report, [figure.name for figure in figures])
            (fresh / "report.md").write_text(words, encoding="utf-8")
    if page is not None:
        from .report.trade_off_pages import write_trade_off_report

        write_trade_off_report(report, page)
    print_warnings(record["warnings"])
    if json:
        print_json({"out": folder, **record})
        return
    print_table(heading(report), columns(report), rows(report))
    for line in in_words(report):
        say(line)
    say(f"\nResults, table, report and figures: {folder}")


def _search(study: Study, pool: Executor) -> ParetoReport:
    """Find the fronts and check them, with a progress bar on stderr."""
    from softimpact.optimize import pareto_fronts

    from .pareto_report import pareto_report
    from .progress import optimiser_bar

    with optimiser_bar() as progress:
        task = progress.add_task("compile", total=None)

        def advance(what: str, done: int, total: int) -> None:
            progress.update(task, description=what, completed=done, total=total)

        return pareto_report(pareto_fronts(study, pool, advance), advance)


def _write(report: ParetoReport, record: dict[str, Any], folder: Path) -> None:
    from .figures.pareto import draw_pareto_figures
    from .output import write_json
    from .pareto_record import write_table
    from .pareto_words import markdown
    from .results_folder import RESULTS

    write_json(folder / RESULTS, record)
    write_table(report, folder / "fronts.csv")
    figures = draw_pareto_figures(report, folder)
    words = markdown(report, [figure.name for figure in figures])
    (folder / "report.md").write_text(words, encoding="utf-8")


def _print(report: ParetoReport, folder: Path) -> None:
    from .output import print_table, say
    from .pareto_words import columns, heading, in_words, rows

    print_table(heading(report), columns(report), rows(report))
    for line in in_words(report):
        say(line)
    say(f"\nResults, table, report and figures: {folder}")
