# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact design``: the joint stiffness and the posture that hurt least."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..typed import options as o
from ..typed.groups import TypedExecution, TypedStudy

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from softimpact.optimize import Design, Study
    from softimpact.optimize.running.execution import Execution
    from softimpact.optimize.search.solve import Mode
    from softimpact.symbolic import ImpactModel

    from ..design.report import DesignReport

OutOption = Annotated[
    Path | None,
    typer.Option("--out", metavar="DIR", help="Folder of results; default results/STUDY."),
]
ModeNameOption = Annotated[
    str,
    typer.Option(
        "--mode", help="table (springs for each pose), free (springs and posture) or both."
    ),
]


def design(
    study: TypedStudy,
    execution: TypedExecution,
    out: OutOption = None,
    mode: ModeNameOption = "both",
    page: o.ReportOption = None,
    json: o.JsonOption = False,
) -> None:
    """Find the joint stiffness and the posture of least peak force with Ipopt."""
    from softimpact.optimize.running.execution import Execution
    from softimpact.symbolic import InvalidValue

    from ..design.report import GENERATOR, design_record, design_report
    from ..design.tables import print_design
    from ..output.printed import failures_as_json, print_json, print_warnings, say
    from ..output.results_folder import (
        replaced_folder,
        require_folder_of,
        require_replaceable_results,
        running,
    )

    problem = study.read()
    folder = out or Path("results") / problem.source.stem
    require_replaceable_results(folder, GENERATOR)
    require_folder_of(page)
    how = Execution(execution.workers, execution.dask, execution.resume)
    if problem.scenarios is not None:
        if mode != "both":
            raise InvalidValue(
                "mode",
                "is for poses by themselves; with [scenarios] the study's scenarios.posture says "
                'whether postures are "given" or "free"',
            )
        _robust(problem, folder, page, how, json)
        return
    modes = _modes(mode, problem)
    with failures_as_json(json), running(how, folder) as pool:
        found = _search(problem, modes, pool)
        made = problem.with_springs(found.winner.springs)
        with replaced_folder(folder, GENERATOR) as fresh, _package_beside(made, fresh):
            report = design_report(found, pool)
            record = design_record(report)
            print_warnings(record["warnings"])
            if not json:  # figures and the package take as long again
                print_design(report)
            _write(report, record, fresh)
    if page is not None:
        from ..report.design_pages import write_design_report

        write_design_report(report, page)
    if json:
        print_json({"out": folder, **record})
    else:
        say(f"\n{_written('figures', folder)}: {folder}")


def _robust(study: Study, folder: Path, page: Path | None, how: Execution, json: bool) -> None:
    """Design one machine for all scenarios."""
    from softimpact.optimize.robust.robust import robust_design
    from softimpact.optimize.study.study_file import ScenariosSection
    from softimpact.optimize.study.study_scenarios import scenarios_of

    from ..design.report import GENERATOR
    from ..design.robust import robust_in_words, robust_record
    from ..design.scenario_checks import checked_scenarios, designed_model
    from ..figures.robust import figure_of_robust_design
    from ..figures.style import save
    from ..output.printed import failures_as_json, print_json, print_warnings, say, write_json
    from ..output.progress import optimiser_stages
    from ..output.results_folder import RESULTS, replaced_folder, running

    asked, scenarios = study.scenarios, scenarios_of(study)
    free = isinstance(asked, ScenariosSection) and asked.posture == "free"
    with failures_as_json(json), running(how, folder) as pool, optimiser_stages() as advance:
        found = robust_design(study, scenarios, pool, advance, free=free)
        made = designed_model(found)
        with replaced_folder(folder, GENERATOR) as fresh, _package_beside(made, fresh):
            checks = checked_scenarios(found)
            record = robust_record(found, checks)
            write_json(fresh / RESULTS, record)
            save(figure_of_robust_design(found), fresh / "design.png")
    if page is not None:
        from ..report.design_pages import write_robust_report

        write_robust_report(found, checks, page)
    print_warnings(record["warnings"])
    if json:
        print_json({"out": folder, **record})
        return
    for line in robust_in_words(found):
        say(line)
    say(f"{_written('figure', folder)}: {folder}")


def _modes(name: str, study: Study) -> tuple[Mode, ...]:
    from typing import Literal

    from softimpact.optimize.co_design import MODES, applicable

    from ..typed.values import one_of

    chosen: Literal["table", "free", "both"] = one_of(
        "mode", name, Literal["table", "free", "both"]
    )
    return applicable(study, MODES if chosen == "both" else (chosen,))


def _search(study: Study, modes: tuple[Mode, ...], pool: Executor) -> Design:
    """Run the design with a progress bar on stderr."""
    from softimpact.optimize import Outcome
    from softimpact.optimize import design as search

    from ..output.progress import optimiser_bar

    with optimiser_bar() as progress:
        task = progress.add_task("compile", total=len(modes) * len(study.poses))

        def advance(outcome: Outcome) -> None:
            best = f"{outcome.name} {outcome.mode}: {outcome.force:.1f} N"
            progress.update(task, advance=1, description=best)

        return search(study, modes, pool, advance)


def _write(report: DesignReport, record: dict[str, Any], folder: Path) -> None:
    from ..figures import draw_figures
    from ..output.printed import write_json
    from ..output.results_folder import RESULTS

    write_json(folder / RESULTS, record)
    draw_figures(report, folder)


@contextmanager
def _package_beside(model: ImpactModel, folder: Path) -> Iterator[None]:
    """Write the C of what was designed in a process of its own, while the caller does the rest."""
    from softimpact.optimize.running.workers import as_completed, workers

    with workers(1) as process:
        package = process.submit(_write_package, model, folder)
        yield
        for job in as_completed([package]):
            job.result()


def _write_package(model: ImpactModel, folder: Path) -> None:
    """Write the C of a model, where it has all of it; ``design_warnings`` says where not.

    That of a floating robot has its base held, and heavier.
    """
    from softimpact.codegen import generate_package
    from softimpact.symbolic.impact.floating import is_floating

    from ..output.cautions import in_c

    held = in_c(model)
    if held is not None:
        floating = is_floating(model.robot)
        generate_package(held.robot, folder / "c", drives=held.drives, floating=floating)


def _written(figures: str, folder: Path) -> str:
    package = (folder / "c").exists()
    return f"Results, {figures} and the C package" if package else f"Results and {figures}"
