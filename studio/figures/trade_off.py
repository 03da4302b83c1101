# SPDX-License-Identifier: BSD-3-Clause
"""Fronts over two or three objectives: the third is a colour."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from softimpact.optimize.units import ratio_in_words
from softimpact.studio.front.trade_off_report import TradeOffReport, View, broken_before
from softimpact.studio.front.trade_off_words import best_and_loosest

from .style import BEFORE, BLACK, BOTH, LIMIT, SMALL, TEXT, legend_below, new_figure, tidy

COLOURS = "cividis"
"""A map that the colour-blind read as others do; dark is low."""

WIDE = 3.0
"""Ratio of an axis' ends from which it is logarithmic."""


def figure_of_front(report: TradeOffReport) -> Figure:
    """Draw the objective that was sought over the first that was held; a third one as colour."""
    figure = new_figure(8.0, 6.0)
    axes = figure.add_subplot()
    values = report.shown
    (y, sought), (x, across) = report.view_of(0), report.view_of(1)
    handles: list[Any] = []
    star: dict[str, Any] = {"marker": "*", "markersize": 20, "linestyle": "none", "zorder": 5}
    star |= {"color": "white", "markeredgecolor": BLACK}
    knee = report.found.knee
    if len(report.views) > 2:
        z, third = report.view_of(2)
        _lines(axes, values[:, [x, y, z]])
        look: dict[str, Any] = {"cmap": COLOURS, "norm": shades(values[:, z]), "edgecolors": BLACK}
        marks = axes.scatter(values[:, x], values[:, y], c=values[:, z], s=55, zorder=3, **look)
        _colour_bar(figure, marks, third, values[:, z])
        if knee is not None:
            star["color"] = colormaps[COLOURS](look["norm"](values[knee, z]))
    else:
        handles += axes.plot(
            values[:, x], values[:, y], "o-", color=BOTH, markersize=6, label="designs"
        )
    if knee is not None:
        at = values[knee]
        handles += axes.plot(at[x], at[y], label="knee", **star)
    handles += _before(axes, report, x, y)
    _limit(axes, sought, handles)
    for name, view, column in (("x", across, x), ("y", sought, y)):
        wide_as_logarithm(axes, name, values[:, column])
        way = "→" if name == "x" else "↑"
        arrow = f"{'better' if view.more_is_better else 'worse'} {way}"
        getattr(axes, f"set_{name}label")(f"{view.title} ({arrow})", fontsize=TEXT)
    axes.set_title(f"{_message(report)}\n{report.study.title}", fontsize=TEXT + 1)
    tidy(axes)
    legend_below(figure, handles, columns=2)
    return figure


def _message(report: TradeOffReport) -> str:
    """Return what the first objective that was held costs."""
    (y, sought), (x, across) = report.view_of(0), report.view_of(1)
    ends = best_and_loosest(report, x)
    if ends is None:
        return f"{across.label.capitalize()} and {sought.label}: nothing to trade"
    best, loose = (report.points[i].values for i in ends)
    return (
        f"From {across.words(loose[x])} to {across.words(best[x])} of {across.label}: "
        f"{ratio_in_words(best[y] / loose[y], sought.label)}"
    )


def _lines(axes: Any, values: Any) -> None:
    """Join the points that have the third objective alike."""
    colour, norm = colormaps[COLOURS], shades(values[:, 2])
    levels = np.round(np.array(norm(values[:, 2]), dtype=float), 3)
    for level in np.unique(levels):
        alike = values[levels == level]
        along = alike[np.argsort(alike[:, 0])]
        shade = colour(norm(along[0, 2]))
        axes.plot(along[:, 0], along[:, 1], color=shade, linewidth=1.2, zorder=2)


def shades(values: Any) -> Any:
    """Return how values become colours: by their logarithms, where they have some."""
    low, high = float(values.min()), float(values.max())
    if low <= 0:
        return Normalize(low, high)
    return LogNorm(low, high if high > low else 1.01 * low)


def _colour_bar(figure: Figure, marks: Any, view: View, values: Any) -> None:
    bar = figure.colorbar(marks, pad=0.02)
    way = "better" if view.more_is_better else "worse"
    bar.set_label(f"{view.title} (light is {way})", fontsize=TEXT)
    ticks = np.geomspace(values.min(), values.max(), 5) if np.ptp(values) else values[:1]
    bar.set_ticks(ticks.tolist(), labels=[f"{tick:.3g}" for tick in ticks])
    bar.ax.minorticks_off()
    bar.ax.tick_params(labelsize=SMALL)


def _before(axes: Any, report: TradeOffReport, x: int, y: int) -> list[Any]:
    """Draw the machine as it is; hollow and crossed where it breaks bounds."""
    values = np.array(report.found.before_values) * [view.scale for view in report.views]
    broken = broken_before(report.found)
    label = "before: nominal springs"
    look: dict[str, Any] = {"markersize": 10, "linestyle": "none", "zorder": 4}
    if broken:
        label += f", which break {', '.join(broken)}"
        look |= {"marker": "X", "color": "white", "markeredgecolor": LIMIT}
    else:
        look |= {"marker": "D", "color": BEFORE, "markeredgecolor": BLACK}
    if len(report.views) > 2:
        z, third = report.view_of(2)
        label += f" ({third.label} {third.words(report.found.before_values[z])})"
    return list(axes.plot(values[x], values[y], label=label, **look))


def _limit(axes: Any, sought: View, handles: list[Any]) -> None:
    """Draw the limit of forces where it is near."""
    if sought.kind not in ("worst_force", "mean_force"):
        return
    limit = sought.scale if sought.unit == "N" else 1.0
    low, high = axes.get_ylim()
    if low - 0.5 * (high - low) <= limit <= high + 0.5 * (high - low):
        label = f"limit, {limit:g} N" if sought.unit == "N" else "limit"
        style: dict[str, Any] = {"color": LIMIT, "linewidth": 1.5, "linestyle": "--"}
        handles.append(axes.axhline(limit, label=label, **style))


def wide_as_logarithm(axes: Any, name: str, values: Any) -> None:
    """Make an axis of a wide range logarithmic, with plain numbers."""
    if values.min() <= 0 or values.max() < WIDE * values.min():
        return
    getattr(axes, f"set_{name}scale")("log")
    axis = getattr(axes, f"{name}axis")
    fine = values.max() < 10 * values.min()
    axis.set_major_locator(LogLocator(subs=(1.0, 1.5, 2.0, 3.0, 5.0, 7.0) if fine else (1, 2, 5)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())
