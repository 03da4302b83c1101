# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact reproduce``: the papers' tables, figures and statements, recomputed."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Annotated, Any

import typer

from softimpact.studio.typed import options as o

if TYPE_CHECKING:
    from .msm.compute import Results

GENERATOR = "softimpact reproduce"
"""Marks a folder of results as one that may be replaced."""

GIAF_FOLDER = "giaf"
"""Where in the results the second paper's page and figures are."""


WIDE = 40
"""Columns of a quantity's name, so that 80 hold the table."""


class Paper(StrEnum):
    """What can be recomputed."""

    MSM = "msm"
    GIAF = "giaf"


PapersOption = Annotated[
    list[Paper] | None,
    typer.Option(
        "--paper", help="msm (reduced models) or giaf (impact factors), repeatable; default both."
    ),
]
ScenariosOption = Annotated[
    str | None,
    typer.Option(metavar="NAMES", help="Scenarios of MSM, e.g. abc; default all six."),
]


def reproduce(
    out: o.OutOption,
    paper: PapersOption = None,
    scenarios: ScenariosOption = None,
    json: o.JsonOption = False,
) -> None:
    """Recompute both papers (MSM, GIAF) and hold what they print and say against our numbers."""
    from softimpact.studio.design.report import versions
    from softimpact.studio.output.printed import print_json, write_json
    from softimpact.studio.output.results_folder import (
        RESULTS,
        replaced_folder,
        require_replaceable_results,
    )

    names = _names(scenarios)
    papers = tuple(paper or Paper)
    require_replaceable_results(out, GENERATOR)
    with replaced_folder(out, GENERATOR) as fresh:
        record: dict[str, Any] = {"generator": GENERATOR, "versions": versions()}
        if Paper.MSM in papers:
            record |= _reduced_models(names, fresh)
        if Paper.GIAF in papers:
            record["giaf"] = _impact_factors(fresh / GIAF_FOLDER)
        write_json(fresh / RESULTS, record)
    if json:
        short = ("verdicts", "comparisons", "giaf")
        print_json({"out": out, **{k: record[k] for k in short if k in record}})
    else:
        _print(record, out)


def _names(typed: str | None) -> tuple[str, ...]:
    from softimpact.symbolic import UnknownName

    from .msm.scenarios import SCENARIOS

    for name in typed or "":
        if name not in SCENARIOS:
            raise UnknownName("scenario", name, SCENARIOS)
    return tuple(name for name in SCENARIOS if not typed or name in typed)


def _reduced_models(names: tuple[str, ...], folder: Path) -> dict[str, Any]:
    """Recompute MSM, write its page and figures, and return what was found."""
    from .msm.compare import compared
    from .msm.figures import draw
    from .msm.page import msm_page

    results = _computed(names)
    comparisons = compared(results)
    captions = draw(results, folder)
    (folder / "report.md").write_text(msm_page(results, comparisons, captions), encoding="utf-8")
    return _record(results, comparisons)


def _impact_factors(folder: Path) -> dict[str, Any]:
    """Recompute GIAF, write its page and figures, and return what was found."""
    from collections import Counter

    from softimpact.optimize import load_study
    from softimpact.robots import FOLDER
    from softimpact.studio.output.printed import say_beside

    from .factor_figures import draw_factor_figures
    from .factor_study import factor_study
    from .giaf.page import giaf_page
    from .giaf.statements import STUDY, TIPS, statements

    study = load_study(FOLDER / STUDY)
    found = factor_study(study, TIPS, say_beside)
    lines = statements(found)
    folder.mkdir()
    figures = [path.name for path in draw_factor_figures(found, folder)]
    (folder / "report.md").write_text(giaf_page(found, lines, figures), encoding="utf-8")
    return {"verdicts": Counter(line.verdict for line in lines), "statements": lines}


def _computed(names: tuple[str, ...]) -> Results:
    """Compute with a progress bar on stderr."""
    from softimpact.studio.output.progress import progress_bar

    from .msm.compute import compute, work_of

    with progress_bar() as progress:
        task = progress.add_task("impacts", total=len(work_of(names)))
        return compute(names, on_done=lambda _: progress.advance(task))


def _record(results: Results, comparisons: Any) -> dict[str, Any]:
    from collections import Counter

    from .msm.ladder import LADDER
    from .msm.page import titles

    return {
        "scenarios": titles(),
        "models": {name: rung.title for name, rung in LADDER.items()},
        "verdicts": Counter(line.verdict for line in comparisons),
        "comparisons": comparisons,
        "sweeps": results.sweeps,
        "nominal": results.nominal,
        "speeds": results.speeds,
        "decoupling": results.decoupling,
        "motor_rates": results.motor_rates,
        "seconds": results.seconds,
    }


def _print(record: dict[str, Any], out: Path) -> None:
    from softimpact.studio.output.printed import print_table, say

    if "comparisons" in record:
        _print_verdicts("Printed numbers of MSM", record["verdicts"])
        others = [x for x in record["comparisons"] if x.verdict not in ("agrees", "input")]
        for verdict in dict.fromkeys(x.verdict for x in others):
            print_table(
                f"Where they differ: {verdict}",
                ("quantity", "scenario", "unit", "printed", "ours"),
                [
                    (fill(x.what, WIDE), x.scenario, x.unit, x.printed, x.ours)
                    for x in others
                    if x.verdict == verdict
                ],
            )
    if "giaf" in record:
        _print_verdicts("Statements of GIAF", record["giaf"]["verdicts"])
        others = [line for line in record["giaf"]["statements"] if line.verdict != "holds"]
        for said in dict.fromkeys((x.source, x.claim, x.verdict) for x in others):
            print_table(
                f"{said[0]}: {said[1]}: {said[2]}",
                ("tip", "rotors", "ours"),
                [
                    (x.tip, x.rotors, x.ours)
                    for x in others
                    if (x.source, x.claim, x.verdict) == said
                ],
            )
    say(f"\nReports, figures and numbers: {out}")


def _print_verdicts(title: str, verdicts: dict[str, int]) -> None:
    from softimpact.studio.output.printed import print_table

    rows = [(str(verdict), float(count)) for verdict, count in verdicts.items()]
    print_table(title, ("verdict", "count"), rows)
