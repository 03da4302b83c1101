# SPDX-License-Identifier: BSD-3-Clause
"""How the models of the ladder differ: peaks over stiffness, mean errors."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter

from .compare import mean_error
from .compute import Results
from .ladder import LADDER, REGIONS

COLOURS = {name: f"C{i}" for i, name in enumerate("abcdef")}

RUNGS = {
    "one_mass": "0.55",
    "two_mass": "C3",
    "chain": "C5",
    "linearised": "C1",
    "chain_controlled": "C2",
    "linearised_controlled": "C0",
    "full_uncontrolled": "C6",
    "full_held": "C4",
    "full": "C0",
}
"""Colour of each model; two that lie on each other share one and are not drawn together."""

LINES = {
    "one_mass": ":",
    "two_mass": "--",
    "linearised": "-.",
    "chain_controlled": "--",
    "full_held": "-",
    "full": "-",
}
"""Line of the models that can be told apart; the others lie on these."""

BARS = {rung: colour for rung, colour in RUNGS.items() if rung != "full"}
"""Colour of the models that have an error: the last is what they are held against."""


def ladder_figure(results: Results, region: str = "head") -> Figure:
    """Draw the largest force of the first contact over k_s, a panel a scenario."""
    names = list(results.sweeps)
    columns = min(3, len(names))
    rows = -(-len(names) // columns)
    width = 3.1 * max(columns, 2)  # the legend's
    figure = Figure(figsize=(width, 2.6 * rows + 0.6), layout="constrained")
    for i, name in enumerate(names):
        axes = figure.add_subplot(rows, columns, i + 1)
        points = results.sweeps[name]
        for rung, line in LINES.items():
            forces = [p.peaks[region][rung]["first_contact"] for p in points]
            axes.semilogx([p.stiffness for p in points], forces, line, color=RUNGS[rung])
        axes.set_title(f"({name})", fontsize=9)
        axes.set_ylim(bottom=0)
    for drawn, rung in zip(figure.axes[0].lines, LINES, strict=True):
        drawn.set_label(LADDER[rung].title)
    for axes in figure.axes[-columns:]:  # one label of the figure would lie under its legend
        axes.set_xlabel("joint stiffness $k_s$ [N·m/rad]")
    figure.supylabel(f"largest force of the first contact, {region} [N]", fontsize=9)
    figure.legend(
        handles=figure.axes[0].lines, loc="outside lower center", ncols=min(columns + 1, 3)
    )
    return figure


def error_figure(results: Results) -> Figure:
    """Draw the mean error of each model on a logarithmic scale, a group a scenario."""
    figure = Figure(figsize=(7.6, 5.0), layout="constrained")
    names = list(results.sweeps)
    for row, region in enumerate(REGIONS):
        axes = figure.add_subplot(2, 1, row + 1)
        width = 0.85 / len(BARS)
        for k, (rung, colour) in enumerate(BARS.items()):
            errors = [mean_error(results.sweeps[s], region, rung, "first_contact") for s in names]
            places = np.arange(len(names)) + (k - (len(BARS) - 1) / 2) * width
            axes.bar(places, np.maximum(errors, 1e-2), width, color=colour)
        axes.set_yscale("log")
        axes.set_ylim(1e-2, 100)
        axes.yaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        axes.set_xticks(range(len(names)), [f"({s})" for s in names])
        axes.grid(False, axis="x")
        axes.set_ylabel(f"mean error, {region} [%]")
    handles = [Patch(color=colour, label=LADDER[rung].title) for rung, colour in BARS.items()]
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure
