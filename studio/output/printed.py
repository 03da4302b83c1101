# SPDX-License-Identifier: BSD-3-Clause
"""Results as one JSON object for machines, or as tables for people."""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from softimpact.symbolic.record import plain

Cell = float | str | None

ENDLESS = 1000
"""Columns of a line that nobody folds."""

AS_CSV = ContextVar("AS_CSV", default=False)
"""Whether tables are for machines."""


@contextmanager
def tables_as_csv(wanted: bool) -> Iterator[None]:
    """Print tables as CSV to stdout, and what else is said to stderr, if that is wanted."""
    token = AS_CSV.set(wanted)
    try:
        yield
    finally:
        AS_CSV.reset(token)


def tables_are_csv() -> bool:
    """Return whether tables are for machines, which hold any number of columns."""
    return AS_CSV.get()


def say(line: str) -> None:
    """Print a line for people to stdout; to stderr where stdout is for a machine."""
    print(line, file=sys.stderr if tables_are_csv() else sys.stdout)


def say_beside(line: str) -> None:
    """Print a line to stderr, where it is in no machine's way."""
    print(line, file=sys.stderr)


def print_json(result: Mapping[str, Any]) -> None:
    """Print one JSON object to stdout."""
    print(json.dumps(plain(result), allow_nan=False))


def print_warnings(lines: Iterable[str]) -> None:
    """Print what was ignored or assumed to stderr, one line each."""
    for line in lines:
        say_beside(f"warning: {' '.join(line.split())}")


@contextmanager
def failures_as_json(wanted: bool) -> Iterator[None]:
    """Print what a failed solver found best as one JSON object, too, if that is wanted."""
    from softimpact.optimize import Infeasible, SolverFailure

    try:
        yield
    except Infeasible as failure:
        if wanted:
            least = vars(failure.least)
            print_json({"error": str(failure), "conflicts": failure.conflicts, "least": least})
        raise
    except SolverFailure as failure:
        if wanted:
            best = {**vars(failure.best), "feasible": failure.feasible}
            print_json({"error": str(failure), "status": failure.statuses, "best": best})
        raise


def write_json(path: Path, result: Any) -> None:
    """Write a result as a JSON file that people can read."""
    text = json.dumps(plain(result), indent=1, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")


def print_table(title: str, columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> None:
    """Print a table to stdout; numbers to four digits, what does not apply as a dash.

    As CSV, numbers are in full, what does not apply is empty, and each table has its title as a
    comment (``#``) above it and an empty line after it.
    """
    if tables_are_csv():
        _print_csv(title, columns, rows)
        return
    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    for column in columns:
        table.add_column(Text(column), overflow="fold")
    for row in rows:
        table.add_row(*(Text(shown(cell)) for cell in row))
    console = Console()
    if not console.is_terminal:  # a file or a pipe has no width to fold into
        unbounded = console.options.update(max_width=ENDLESS)
        console.width = max(console.width, console.measure(table, options=unbounded).maximum)
    console.print(Text(title, style="table.title"), soft_wrap=True)
    console.print(table)


def folded(cell: Cell) -> Cell:
    """Return a cell with its words, and a point behind its body, in lines of their own.

    So 80 columns hold tables of many words. CSV keeps cells as they are: ``BODY@x,y,z`` is typed.
    """
    if tables_are_csv() or not isinstance(cell, str):
        return cell
    return cell.replace(" ", "\n").replace("@", "\n@")


def _print_csv(title: str, columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> None:
    writer = csv.writer(sys.stdout, lineterminator="\n")
    print(f"# {' '.join(title.split())}")
    writer.writerow(" ".join(column.split()) for column in columns)
    writer.writerows([_csv_cell(cell) for cell in row] for row in rows)
    print()


def _csv_cell(cell: Cell) -> Any:
    if cell is None:
        return ""
    return " ".join(cell.split()) if isinstance(cell, str) else plain(cell)


def shown(cell: Cell) -> str:
    """Return a cell as people read it."""
    if cell is None:
        return "–"
    if isinstance(cell, str):
        return cell
    return f"{cell:,.0f}" if abs(cell) >= 1e4 else f"{cell:.4g}"
