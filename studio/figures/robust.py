# SPDX-License-Identifier: BSD-3-Clause
"""One machine for many scenarios: what the design buys, and which of its numbers matter."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import NullFormatter

from softimpact.optimize.certificate import Worst
from softimpact.optimize.robust import RobustDesign

from .style import (
    BEFORE,
    BLACK,
    BOTH,
    FAINT,
    LIMIT,
    SMALL,
    SPRINGS,
    TEXT,
    legend_below,
    new_figure,
    tidy,
)


def figure_of_robust_design(design: RobustDesign) -> Figure:
    """Draw the objective before and after, and each spring with what of it is indifferent."""
    study = design.study
    springs = max(study.groups) + 1
    figure = new_figure(6.2 + 0.75 * springs, 4.8)
    left, right = figure.subplots(1, 2, width_ratios=(2.4, max(2.0, 0.6 * springs)))
    limit = _draw_objective(left, design)
    legend_below(figure, [*limit, *_draw_springs(right, design)], columns=3)
    figure.suptitle(f"{_message(design)}\n{study.title}", fontsize=TEXT + 1)
    return figure


def _message(design: RobustDesign) -> str:
    objective, (equal, _) = design.study.objective, design.equal
    change = 100 * (design.worst.value / equal.value - 1)
    name = objective.kind.replace("_", " ")
    than = "than nominal proportions, just accurate"
    if abs(change) < 0.05:
        return f"As much {name} as nominal proportions, just accurate"
    return f"{abs(change):.1f} % {'more' if change > 0 else 'less'} {name} {than}"


def _draw_objective(axes: Any, design: RobustDesign) -> list[Any]:
    """Draw bars, hollow for a machine that breaks a bound; return what explains the limit."""
    objective, (equal, _) = design.study.objective, design.equal
    shown: list[tuple[str, Worst, str]] = [
        ("before", design.before, BEFORE),
        ("just\naccurate", equal, SPRINGS),
        ("design", design.worst, BOTH),
    ]
    top = 1.25 * max(worst.value for _, worst, _ in shown)
    for i, (_, worst, colour) in enumerate(shown):
        look: dict[str, Any] = {"color": colour, "edgecolor": BLACK, "linewidth": 0.6}
        label = f"{worst.value:.3g}"
        if not worst.keeps:
            look = {"color": "white", "edgecolor": colour, "linewidth": 2.0, "hatch": "//"}
            label += "\nbreaks\na bound"
        axes.bar(i, worst.value, width=0.6, **look)
        axes.annotate(
            label,
            (i, worst.value),
            xytext=(0, 4),
            textcoords="offset points",
            ha="center",
            fontsize=SMALL,
        )
    handles = []
    if objective.unit == "of the limit" and top > 1:
        axes.axhline(1.0, color="white", linewidth=4.5)  # sets it off from the bars
        line: dict[str, Any] = {"color": LIMIT, "linewidth": 1.8, "linestyle": "--"}
        handles.append(axes.axhline(1.0, label="limit", **line))
    axes.set_ylim(0.0, top)
    axes.set_xticks(range(len(shown)), [name for name, _, _ in shown])
    better = "more is better" if objective.more_is_better else "less is better"
    name = objective.kind.replace("_", " ")
    axes.set_ylabel(f"{name} [{objective.unit}], {better}", fontsize=TEXT)
    tidy(axes, grid="y")
    return handles


def _draw_springs(axes: Any, design: RobustDesign) -> list[Any]:
    """Draw found, nominal and indifferent stiffness; return what explains them."""
    study = design.study
    springs = max(study.groups) + 1
    names = study.range.names[:springs]
    for i in range(springs):
        low, high = study.range.lower[i], study.range.upper[i]
        first = study.groups.index(i)
        axes.bar(i, high - low, bottom=low, width=0.76, color=FAINT, zorder=1)
        bar: dict[str, Any] = {"color": BOTH, "linewidth": 6.0, "alpha": 0.4}
        axes.plot([i, i], design.indifferent[i], solid_capstyle="butt", zorder=2, **bar)
        nominal = float(study.nominal[first])
        axes.hlines(nominal, i - 0.38, i + 0.38, color=BLACK, linestyle="--", zorder=3)
        look: dict[str, Any] = {"color": BOTH, "markeredgecolor": BLACK, "markersize": 8}
        axes.plot(i, design.springs[first], "D", zorder=4, **look)
    axes.set_yscale("log")
    axes.set_ylim(0.8 * study.range.lower[:springs].min(), 1.25 * study.range.upper[:springs].max())
    short = [name.replace(", ", ",\n") for name in names]
    turned = max(len(name) for name in names) > 7 and springs > 3
    axes.set_xticks(range(springs), short, rotation=60 if turned else 0)
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_ylabel("joint stiffness $k_s$ [N·m/rad]", fontsize=TEXT)
    axes.set_title("The springs", fontsize=TEXT)
    tidy(axes, grid="y")
    return [
        Line2D([], [], linestyle="none", marker="D", label="found", color=BOTH),
        Line2D([], [], color=BLACK, linestyle="--", label="nominal"),
        Patch(color=FAINT, label="allowed"),
        Patch(color=BOTH, alpha=0.4, label="costs less than 0.5 %, one at a time"),
    ]
