# SPDX-License-Identifier: BSD-3-Clause
"""Contact force over time: the winner against the worst pose."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from softimpact.simulate import ImpactHistory
from softimpact.studio.design.report import DesignReport
from softimpact.symbolic.robot.rigid import Array

from .style import (
    BEFORE,
    BLACK,
    BOTH,
    LIMIT,
    MODE_WORDS,
    TEXT,
    legend_below,
    limit_in_words,
    new_figure,
    setting,
    tidy,
    winner_in_words,
)

MILLISECONDS = 1e3


def figure_of_forces(report: DesignReport) -> Figure:
    """Draw the contacts of the winner and of the worst pose, their peaks and the limit."""
    figure = new_figure(8.0, 4.8)
    axes = figure.add_subplot()
    winner, worst = report.design.winner, report.worst.candidate.pose.name
    lines = [
        _draw(axes, report.worst_history, BEFORE, _before_in_words(report, worst)),
        _draw(
            axes,
            report.winner_history,
            BOTH,
            f"{winner_in_words(report)}, {MODE_WORDS[winner.mode]}",
        ),
        axes.axhline(
            report.limit, color=LIMIT, linewidth=1.5, linestyle="--", label=limit_in_words(report)
        ),
    ]
    histories = (report.worst_history, report.winner_history)
    axes.set_xlim(0.0, max(until_apart(history)[0][-1] for history in histories))
    _mark_peaks(axes, *histories)
    axes.set_ylim(0.0, 1.15 * max(report.limit, *(history.peak for history in histories)))
    axes.set_xlabel("time since first touch [ms]", fontsize=TEXT)
    axes.set_ylabel("contact force [N]", fontsize=TEXT)
    axes.set_title(f"{_message(report)}\n{setting(report)}", fontsize=TEXT + 1)
    tidy(axes)
    legend_below(figure, lines, columns=1)
    return figure


def _message(report: DesignReport) -> str:
    force, limit = report.winner_history.peak, report.limit
    times = "keeps the limit" if force <= limit else f"is {force / limit:.2g} times the limit"
    return (
        f"The winner's {force:.0f} N {times}; the worst pose has {report.worst_history.peak:.0f} N"
    )


def _before_in_words(report: DesignReport, worst: str) -> str:
    first = "before" if len(report.poses) == 1 else "worst"
    breaks = "" if report.worst.keeps_before else ", which break a bound there"
    return f"{first}: {worst}, nominal springs{breaks}"


def until_apart(history: ImpactHistory) -> tuple[Array, Array]:
    """Return time [ms] and force [N] until the contact of the largest force ends."""
    over = (history.time > history.time_of_peak) & (history.force <= 0)
    end = int(np.argmax(over)) + 1 if over.any() else history.time.size
    return MILLISECONDS * history.time[:end], np.maximum(history.force[:end], 0.0)


def _draw(axes: Any, history: ImpactHistory, colour: str, label: str) -> Any:
    (line,) = axes.plot(*until_apart(history), color=colour, linewidth=2.0, label=label)
    return line


def _mark_peaks(axes: Any, worst: ImpactHistory, winner: ImpactHistory) -> None:
    """Mark both peaks; each is named where its level meets the end of the axis that is farther.

    There the curves are low. The higher peak is named above its level, the lower one below.
    """
    peaks = [("worst", worst, BEFORE), ("winner", winner, BOTH)]
    peaks.sort(key=lambda peak: peak[1].peak)
    longest = axes.get_xlim()[1]
    late = MILLISECONDS * peaks[-1][1].time_of_peak > 0.6 * longest
    end = 0.0 if late else longest
    for (name, history, colour), place in zip(peaks, ("top", "bottom"), strict=True):
        time, force = MILLISECONDS * history.time_of_peak, history.peak
        axes.hlines(force, time, end, color=colour, linewidth=1.0, linestyle=":")
        axes.plot(time, force, "o", color=colour, markersize=7, markeredgecolor=BLACK, zorder=4)
        axes.annotate(
            f"{name}: {force:.1f} N at {time:.1f} ms",
            (end, force),
            xytext=(-2 if end else 2, 3 if place == "bottom" else -3),
            textcoords="offset points",
            ha="right" if end else "left",
            va=place,
            fontsize=TEXT,
            bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none"},
        )
