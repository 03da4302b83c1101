# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact reproduce``: the paper's tables and figures, recomputed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from . import options as o

if TYPE_CHECKING:
    from .reproduce.compute import Results

GENERATOR = "softimpact reproduce"
"""Marks a folder of results as one that may be replaced."""

Scenarios = Annotated[
    str | None,
    typer.Option(metavar="NAMES", help="Scenarios of the paper, e.g. abc; default all six."),
]


def reproduce(out: o.Out, scenarios: Scenarios = None, json: o.Json = False) -> None:
    """Recompute the paper on reduced models (MSM) and hold each printed number against ours."""
    from .output import plain, print_json
    from .reproduce.compare import compared
    from .results_folder import RESULTS, replaced_folder, require_replaceable

    names = _names(scenarios)
    require_replaceable(out, GENERATOR)
    results = _computed(names)
    comparisons = compared(results)
    record = _record(results, comparisons)
    with replaced_folder(out, GENERATOR) as fresh:
        from json import dumps

        from .reproduce.figures import draw
        from .reproduce.page import page

        captions = draw(results, fresh)
        text = dumps(plain(record), indent=1, allow_nan=False)
        (fresh / RESULTS).write_text(text + "\n", encoding="utf-8")
        (fresh / "report.md").write_text(page(results, comparisons, captions), encoding="utf-8")
    if json:
        print_json({"out": out, **{k: record[k] for k in ("verdicts", "comparisons")}})
    else:
        _print(record, out)


def _names(typed: str | None) -> tuple[str, ...]:
    from softimpact.symbolic import UnknownName

    from .reproduce.scenarios import SCENARIOS

    for name in typed or "":
        if name not in SCENARIOS:
            raise UnknownName("scenario", name, SCENARIOS)
    return tuple(name for name in SCENARIOS if not typed or name in typed)


def _computed(names: tuple[str, ...]) -> Results:
    """Compute with a progress bar on stderr."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeElapsedColumn

    from .reproduce.compute import compute, work_of

    columns = ("{task.description}", BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True)) as progress:
        task = progress.add_task("impacts", total=len(work_of(names)))
        return compute(names, on_done=lambda _: progress.advance(task))


def _record(results: Results, comparisons: Any) -> dict[str, Any]:
    from collections import Counter

    from .design_report import versions
    from .reproduce.ladder import LADDER
    from .reproduce.page import titles

    return {
        "generator": GENERATOR,
        "versions": versions(),
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


def _print(record: dict[str, Any], out: Any) -> None:
    from rich.console import Console

    from .output import print_table

    rows = [(str(verdict), float(count)) for verdict, count in record["verdicts"].items()]
    print_table("Printed numbers", ("verdict", "count"), rows)
    others = [line for line in record["comparisons"] if line.verdict != "agrees"]
    print_table(
        "Where they differ",
        ("quantity", "scenario", "unit", "printed", "ours", "verdict"),
        [(x.what, x.scenario, x.unit, x.printed, x.ours, x.verdict) for x in others],
    )
    Console(soft_wrap=True).print(f"\nReport, figures and numbers: {out}")
