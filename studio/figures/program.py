# SPDX-License-Identifier: BSD-3-Clause
"""How far a program must slow down, over time, and what binds."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from softimpact.studio.program.table import NOTHING, ProgramTable
from softimpact.symbolic.robot.rigid import Array

from .style import (
    BLACK,
    BLUE,
    GREEN,
    LIGHT,
    ORANGE,
    PURPLE,
    SKY,
    SMALL,
    TEXT,
    VERMILLION,
    new_figure,
    tidy,
)

COLOURS = (BLUE, ORANGE, GREEN, VERMILLION, PURPLE, SKY)
MARKS = ("o", "s", "^", "D", "v", "P")

DRAWN = 1500
"""Most spans of a program; of each the lowest factor is drawn."""


def program_figure(table: ProgramTable, robot: str) -> Figure:
    """Draw the speed factor over time, marked by the point and region that bind.

    Args:
        table: the program slowed down.
        robot: its name.
    """
    rows, formula = _lowest(table)
    binds = np.where(table.factor[rows] < 1, table.point[rows], NOTHING)
    pairs = [(int(p), int(b)) for p, b in zip(binds, table.body[rows], strict=True) if p >= 0]
    order = sorted(dict.fromkeys(pairs), key=lambda pair: -pairs.count(pair))
    time, factor = table.time[rows], table.factor[rows]
    figure = new_figure(9, 4)
    axes = figure.subplots()
    dotted: dict[str, Any] = {"color": BLACK, "linewidth": 1.1, "linestyle": (0, (1, 2))}
    axes.plot(time, formula, **dotted)
    axes.plot(time, factor, color=LIGHT, linewidth=1.6)
    for i, (point, body) in enumerate(order[: len(COLOURS)]):
        own = (binds == point) & (table.body[rows] == body)
        axes.plot(
            time[own],
            factor[own],
            MARKS[i],
            color=COLOURS[i],
            markersize=4,
            label=f"{table.names.points[point]} on {table.names.regions[body]}",
        )
    axes.plot([], [], **dotted, label="two-body formula")
    axes.set_ylim(0, 1.05)
    axes.set_xlim(table.time[0], table.time[-1])
    axes.set_xlabel("time in the program [s]", fontsize=SMALL)
    axes.set_ylabel("speed that keeps all limits,\nas a factor on the program's", fontsize=SMALL)
    figure.legend(fontsize=SMALL, frameon=False, loc="outside lower center", ncols=4)
    tidy(axes)
    figure.suptitle(_message(table, robot), fontsize=TEXT + 1)
    return figure


def _lowest(table: ProgramTable) -> tuple[Array, Array]:
    """Return the row with the lowest factor of each span, and the formula's lowest there."""
    edges = np.unique(np.linspace(0, len(table), min(len(table), DRAWN) + 1).astype(int))
    spans = [slice(a, b) for a, b in pairwise(edges)]
    rows = [span.start + int(np.argmin(table.factor[span])) for span in spans]
    formula = table.iso_factor
    return np.array(rows), np.array([formula[span].min() for span in spans])


def _message(table: ProgramTable, robot: str) -> str:
    before = table.time_before
    if not (table.factor < 1).any():
        return f"{robot}: the program keeps all limits at its own speed, {before:.3g} s"
    return (
        f"{robot}: {before:.3g} s become {table.time_after:.3g} s, "
        f"as it must slow down to {table.factor.min():.0%} at worst"
    )
