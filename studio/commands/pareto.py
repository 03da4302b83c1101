# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact pareto``: what accuracy costs in force and speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..typed import options as o
from ..typed.groups import TypedExecution, TypedStudy

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from softimpact.optimize import Study
    from softimpact.optimize.running.workers import Progress

    from ..front.words import FrontWords

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
    study: TypedStudy,
    execution: TypedExecution,
    out: OutOption = None,
    points: PointsOption = None,
    objectives: ObjectivesOption = None,
    page: o.ReportOption = None,
    json: o.JsonOption = False,
) -> None:
    """Find designs that no other beats: in force and accuracy, or in objectives of your choice."""
    from softimpact.optimize.front.trade_off import asks_for_trade_off
    from softimpact.optimize.running.execution import Execution

    from ..front.pareto_record import GENERATOR
    from ..output.printed import failures_as_json, print_json, print_warnings, write_json
    from ..output.progress import optimiser_stages
    from ..output.results_folder import (
        RESULTS,
        replaced_folder,
        require_folder_of,
        require_replaceable_results,
        running,
    )

    named = None if objectives is None else [n for n in map(str.strip, objectives.split(",")) if n]
    problem = study.read(pareto={"points": points, "objectives": named})
    folder = out or Path("results") / f"{problem.source.stem}_pareto"
    require_replaceable_results(folder, GENERATOR)
    require_folder_of(page)
    how = Execution(execution.workers, execution.dask, execution.resume)
    search = _trade_off if asks_for_trade_off(problem) else _of_postures
    with failures_as_json(json), running(how, folder) as pool, optimiser_stages() as advance:
        found = search(problem, pool, advance)
        with replaced_folder(folder, GENERATOR) as fresh:
            write_json(fresh / RESULTS, found.record)
            found.write_table(fresh / found.words.file)
            figures = [figure.name for figure in found.draw(fresh)]
            (fresh / "report.md").write_text(found.words.markdown(figures), encoding="utf-8")
    if page is not None:
        found.write_page(page)
    print_warnings(found.record["warnings"])
    if json:
        print_json({"out": folder, **found.record})
    else:
        found.words.show(folder)


@dataclass(frozen=True)
class _Found:
    """A front, as plain data and in words, and how its files are written."""

    record: dict[str, Any]
    words: FrontWords
    write_table: Callable[[Path], None]
    draw: Callable[[Path], list[Path]]
    write_page: Callable[[Path], Path]


def _trade_off(study: Study, pool: Executor, advance: Progress) -> _Found:
    """Find a front over objectives of a machine for scenarios."""
    from softimpact.optimize.front.trade_off import trade_off_front

    from ..figures.trade_off_hardware import draw_trade_off_figures
    from ..front.trade_off_record import trade_off_record, write_points
    from ..front.trade_off_report import trade_off_report
    from ..front.trade_off_words import front_words
    from ..report.trade_off_pages import write_trade_off_report

    report = trade_off_report(trade_off_front(study, pool, advance), advance)
    return _Found(
        trade_off_record(report),
        front_words(report),
        partial(write_points, report),
        partial(draw_trade_off_figures, report),
        partial(write_trade_off_report, report),
    )


def _of_postures(study: Study, pool: Executor, advance: Progress) -> _Found:
    """Find the fronts of postures for the study's own impact."""
    from softimpact.optimize import pareto_fronts

    from ..figures.pareto import draw_pareto_figures
    from ..front.pareto_record import pareto_record, write_table
    from ..front.pareto_report import pareto_report
    from ..front.pareto_words import front_words
    from ..report.pareto_pages import write_pareto_report

    report = pareto_report(pareto_fronts(study, pool, advance), advance)
    return _Found(
        pareto_record(report),
        front_words(report),
        partial(write_table, report),
        partial(draw_pareto_figures, report),
        partial(write_pareto_report, report),
    )
