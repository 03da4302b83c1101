# SPDX-License-Identifier: BSD-3-Clause
"""Data of this folder: tables with their sources in comment lines."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from importlib.resources import files

DATA = files(__package__) / "data"
"""Where the tables are."""


def table_rows(name: str) -> Iterator[dict[str, str]]:
    """Yield the rows of ``data/NAME`` by column."""
    text = (DATA / name).read_text(encoding="utf-8")
    yield from csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))


def number(entry: str, unit: float = 1.0) -> float | None:
    """Return an entry in SI units, None where it is empty."""
    return float(entry) * unit if entry else None
