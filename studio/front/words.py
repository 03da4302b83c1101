# SPDX-License-Identifier: BSD-3-Clause
"""What any front says: a table and sentences, on a terminal or as a page of Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ..output.printed import Cell, print_table, say, shown


@dataclass(frozen=True)
class FrontWords:
    """What a front says.

    Attributes:
        heading: what it is about, and the setting, a line each.
        columns: heads of its table, the units in their last lines.
        rows: of the table.
        lines: what it says, a sentence each.
        file: that holds the table with all digits.
        legend: of the table; empty if it needs none.
    """

    heading: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    lines: Sequence[str]
    file: str
    legend: str = ""

    def show(self, folder: Path) -> None:
        """Print it, and where everything was written."""
        print_table(self.heading, self.columns, self.rows)
        for line in self.lines:
            say(line)
        say(f"\nResults, table, report and figures: {folder}")

    def markdown(self, figures: Sequence[str]) -> str:
        """Return a page of it, with links to figures beside it."""
        titles = [_as_one_line(head) for head in self.columns]
        rows = [[shown(cell) for cell in row] for row in self.rows]
        title, setting = self.heading.split("\n")
        blocks = [
            f"# {title}",
            f"{setting}.",
            "\n".join(f"| {' | '.join(row)} |" for row in (titles, ["---"] * len(titles), *rows)),
            *([self.legend] if self.legend else []),
            "\n".join(f"- {line}" for line in self.lines),
            *(f"![{name.removesuffix('.png').replace('_', ' ')}]({name})" for name in figures),
            f"Every number is in `results.json`; the table is also in `{self.file}`.",
        ]
        return "\n\n".join(blocks) + "\n"


def _as_one_line(head: str) -> str:
    """Return a head with its last line, the unit, in brackets."""
    name, _, unit = head.rpartition("\n")
    return f"{' '.join(name.split())} [{unit}]" if name else unit
