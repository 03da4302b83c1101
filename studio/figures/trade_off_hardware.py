# SPDX-License-Identifier: BSD-3-Clause
"""The hardware along a front over objectives, how much of it matters, and both figures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from softimpact.optimize.machine.springs import sprung
from softimpact.studio.front.trade_off_report import TradeOffReport
from softimpact.symbolic import JointKind

from .style import BLACK, BOTH, TEXT, new_figure, save, tidy
from .trade_off import COLOURS, figure_of_front, shades, wide_as_logarithm

PANELS = 4
"""Most panels beside each other."""


def draw_trade_off_figures(report: TradeOffReport, folder: Path) -> list[Path]:
    """Draw a front's figures as PNG files; return their paths."""
    figures = {"front": figure_of_front(report), "hardware": figure_of_hardware(report)}
    return [save(figure, folder / f"{name}.png") for name, figure in figures.items()]


def figure_of_hardware(report: TradeOffReport) -> Figure:
    """Draw each value of the hardware along the front, and what of it costs less than 0.5 %."""
    study = report.study
    x, across = report.view_of(1)
    names, springs = study.range.names, max(study.groups) + 1
    count = min(len(names), PANELS)
    lines = -(-len(names) // count)
    figure = new_figure(3.0 * count + 1.2, 2.6 * lines + 1.2)
    panels = figure.subplots(lines, count, sharex=True, squeeze=False).ravel()
    at = report.shown[:, x]
    colours: list[Any] = [BOTH] * len(at)
    legend = ""
    if len(report.views) > 2:
        z, third = report.view_of(2)
        shown = report.shown[:, z]
        colours = list(colormaps[COLOURS](shades(shown)(shown)))
        ends = f"from {shown.min():.3g} (dark) to {shown.max():.3g} (light)"
        legend = f"\ncolour: {third.title}, {ends}"
    for i, axes in enumerate(panels[: len(names)]):
        own = study.groups.index(i) if i < springs else i - springs
        for point, place, colour in zip(report.points, at, colours, strict=True):
            value = point.springs[own] if i < springs else point.others[own]
            bar = point.indifferent[i]
            line: dict[str, Any] = {"color": colour, "linewidth": 3.0, "alpha": 0.5}
            axes.plot([place, place], bar, solid_capstyle="butt", zorder=2, **line)
            mark: dict[str, Any] = {"color": colour, "markeredgecolor": BLACK, "markersize": 5}
            axes.plot(place, value, "o", zorder=3, **mark)
        wide_as_logarithm(axes, "x", at)
        low, high = study.range.lower[i], study.range.upper[i]
        if high > 3 * low:
            axes.set_yscale("log")
        axes.set_ylim(low / 1.15, high * 1.15)
        axes.set_title(f"{names[i]} [{_unit(report, i)}]", fontsize=TEXT)
        axes.tick_params(labelbottom=True)
        tidy(axes)
        axes.yaxis.set_minor_formatter(NullFormatter())
        if i >= len(names) - count:
            axes.set_xlabel(across.title, fontsize=TEXT)
    for axes in panels[len(names) :]:
        axes.set_visible(False)
    figure.suptitle(
        "Hardware along the front; bars: what costs less than 0.5 %, one value at a time" + legend,
        fontsize=TEXT + 1,
    )
    return figure


def _unit(report: TradeOffReport, i: int) -> str:
    """Return the unit of a value of the hardware; springs of sliding joints have their own."""
    study = report.study
    if i <= max(study.groups):
        joint = study.robot.joints[sprung(study.model)[study.groups.index(i)]]
        return "N/m" if joint.kind is JointKind.SLIDE else study.units[i]
    return study.units[i]
