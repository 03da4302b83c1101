# SPDX-License-Identifier: BSD-3-Clause
"""What springs, posture and both buy, and the speed that meets the limit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure

from softimpact.optimize import Gains
from softimpact.studio.design.report import DesignReport, has_other_postures, task_result

from .style import (
    BEFORE,
    BLACK,
    BOTH,
    LIMIT,
    SKY,
    SMALL,
    SPRINGS,
    TEXT,
    legend_below,
    limit_in_words,
    new_figure,
    setting,
    tidy,
)


def figure_of_gains(report: DesignReport, gains: Gains) -> Figure:
    """Draw the peak force before and after each part of the design, and the speeds."""
    figure = new_figure(10.0, 4.8)
    forces, speeds = figure.subplots(1, 2, width_ratios=(2, 1.2))
    limit = _draw_forces(forces, report, gains)
    asked = _draw_speeds(speeds, report)
    unfair = "" if task_result(report.design).keeps_before else f"\n{_unfair(report)}"
    figure.suptitle(f"{_message(report, gains)}\n{setting(report)}{unfair}", fontsize=TEXT + 1)
    legend_below(figure, [limit, asked], columns=2)
    return figure


def _unfair(report: DesignReport) -> str:
    """Return why before is not the nominal springs."""
    return (
        f"nominal springs break a bound ({task_result(report.design).force_before:.1f} N); before: "
        "their proportions, just stiff enough"
    )


def _message(report: DesignReport, gains: Gains) -> str:
    """Return what the design saves, and what of it the springs alone do."""
    saved = 1 - gains.both / gains.before
    if not saved > 0:
        return "The design saves no force"
    alone = [
        f"{name} alone {1 - force / gains.before:.1%}"
        for name, force in parts_of(report, gains).items()
        if name in ("springs", "posture")
    ]
    if not has_other_postures(report):
        return f"The design saves {saved:.1%} of the force, all of it by springs"
    return f"The design saves {saved:.1%} of the force; {', '.join(alone)}"


def parts_of(report: DesignReport, gains: Gains) -> dict[str, float]:
    """Return forces by what of the design they are of [N]; posture only where there are others."""
    parts = {"before": gains.before, "springs": gains.springs}
    if len(report.poses) > 1:
        parts["posture"] = gains.posture
    if has_other_postures(report):
        parts["both"] = gains.both
    return parts


COLOUR = {"before": BEFORE, "springs": SPRINGS, "posture": SKY, "both": BOTH}


def _draw_forces(axes: Any, report: DesignReport, gains: Gains) -> Any:
    parts = parts_of(report, gains)
    names, heights = list(parts), list(parts.values())
    shares = [force / gains.before - 1 for force in heights]
    labels = [f"{heights[0]:.1f} N"] + [
        f"{force:.1f} N\n{_percent(share)}"
        for force, share in zip(heights[1:], shares[1:], strict=True)
    ]
    _bars(axes, names, heights, [COLOUR[name] for name in names], labels)
    axes.axhline(report.limit, color="white", linewidth=4.5)  # sets it off from the bars
    label = limit_in_words(report)
    line = axes.axhline(report.limit, color=LIMIT, linewidth=1.8, linestyle="--", label=label)
    axes.set_ylim(0.0, 1.18 * max(*heights, report.limit))
    axes.set_ylabel("peak force [N]", fontsize=TEXT)
    axes.set_title("Force at the study's speed", fontsize=TEXT)
    return line


def _percent(share: float) -> str:
    rounded = round(100 * share, 1)
    return f"{rounded:+.1f} %".replace("-", "−") if rounded else "no change"


def _draw_speeds(axes: Any, report: DesignReport) -> Any:
    heights = [report.speed_before, report.speed_after]
    speed = report.study.speed
    after = "both" if has_other_postures(report) else "springs"
    colours = [BEFORE, COLOUR[after]]
    _bars(axes, ["before", after], heights, colours, [f"{v:.3f} m/s" for v in heights])
    label = f"speed of the study {speed:g} m/s"
    line = axes.axhline(speed, color=BLACK, linewidth=1.5, linestyle=":", label=label)
    axes.set_ylim(0.0, 1.18 * max(*heights, speed))
    axes.set_ylabel("speed at first touch [m/s]", fontsize=TEXT)
    axes.set_title("Speed that meets the limit", fontsize=TEXT)
    return line


def _bars(
    axes: Any,
    names: Sequence[str],
    heights: Sequence[float],
    colours: Sequence[str],
    labels: Sequence[str],
) -> None:
    bars = axes.bar(names, heights, width=0.6, color=colours, edgecolor=BLACK, linewidth=0.6)
    backing = {"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none"}
    axes.bar_label(bars, labels, padding=4, fontsize=SMALL, bbox=backing)
    tidy(axes, grid="y")
    axes.tick_params(axis="x", labelsize=TEXT)
