# SPDX-License-Identifier: BSD-3-Clause
"""The poses by rank: peak force before and after the design."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from softimpact.optimize import Outcome
from softimpact.studio.design.report import DesignReport, RankedPose

from .style import (
    BEFORE,
    BLACK,
    LIGHT,
    LIMIT,
    MODE_COLOURS,
    MODE_WORDS,
    TEXT,
    legend_below,
    limit_in_words,
    new_figure,
    setting,
    tidy,
)

RECOVERED, TURNED = "*", "~"
MARKERS = {"table": ("s", 8.0), "free": ("o", 6.0)}
"""Shape and size by mode; the free one is smaller and on top, so that equal forces show both."""


def figure_of_ranking(report: DesignReport) -> Figure:
    """Draw each pose's force before, with springs, and with springs and posture designed.

    The axis is zoomed to the forces, and says so: what the design gains is small against them.
    """
    poses = report.poses
    figure = new_figure(8.0, 2.2 + 0.2 * len(poses))
    axes = figure.add_subplot()
    low, high = _range(report)
    axes.set_xlim(low, high)
    _draw_spans(axes, poses)
    handles = [*_draw_before(axes, poses), *_draw_modes(axes, report)]
    handles += [*_draw_limit(axes, report), *_explanations(poses)]
    axes.set_ylim(len(poses) + 0.5, 0.5)
    axes.set_yticks([pose.rank for pose in poses], [_row_label(pose) for pose in poses])
    axes.set_xlabel(_label(report, low, high), fontsize=TEXT)
    axes.set_ylabel("rank and pose", fontsize=TEXT)
    axes.set_title(
        f"{_message(report)}\n{setting(report)}",
        fontsize=TEXT + 1,
    )
    tidy(axes, grid="x")
    legend_below(figure, handles, columns=2)
    return figure


def _message(report: DesignReport) -> str:
    """Return where the poses' forces lie before and after."""

    def ends(forces: list[float]) -> str:
        digits = 1 if len(forces) == 1 else 0
        low, high = f"{min(forces):.{digits}f}", f"{max(forces):.{digits}f}"
        return low if low == high else f"{low} to {high}"

    before = ends([pose.result.force_before for pose in report.poses])
    after = ends([pose.best.force for pose in report.poses])
    poses = report.poses
    whose = poses[0].result.candidate.pose.name if len(poses) == 1 else f"{len(poses)} poses"
    return f"Peak force of {whose}: {before} N before, {after} N after the design"


def _range(report: DesignReport) -> tuple[float, float]:
    """Range of the axis: all forces that count, and the limit unless it is far from them."""
    forces = [pose.result.force_before for pose in report.poses]
    forces += [o.force for mode in MARKERS for o in _outcomes(report, mode) if o and o.solved]
    low, high = min(forces), max(forces)
    span = max(high - low, (0.01 if len(report.poses) > 1 else 0.5) * high)
    if low - span <= report.limit <= high + span:
        low, high = min(low, report.limit), max(high, report.limit)
    return low - 0.06 * span, high + 0.06 * span


def _outcomes(report: DesignReport, mode: str) -> list[Outcome | None]:
    return [getattr(pose.result, mode) for pose in report.poses]


def _draw_spans(axes: Any, poses: Sequence[RankedPose]) -> None:
    """Join each pose's forces by a line."""
    for pose in poses:
        after = (pose.result.table, pose.result.free)
        forces = [o.force for o in after if o is not None and o.solved]
        ends = [*forces, pose.result.force_before]
        axes.hlines(pose.rank, min(ends), max(ends), color=LIGHT, linewidth=2.0, zorder=1)


def _draw_before(axes: Any, poses: Sequence[RankedPose]) -> list[Any]:
    handles = []
    for keeps, colour, edge, label in (
        (True, BEFORE, BLACK, "before: the pose with nominal springs"),
        (False, "white", BEFORE, "before, but nominal springs break a bound there"),
    ):
        shown = [pose for pose in poses if pose.result.keeps_before == keeps]
        if shown:
            look: dict[str, Any] = {"color": colour, "markeredgecolor": edge, "label": label}
            look |= {"markersize": 6, "markeredgewidth": 0.6 if keeps else 1.6}
            forces = [pose.result.force_before for pose in shown]
            handles += axes.plot(forces, [pose.rank for pose in shown], "D", **look)
    return handles


def _draw_modes(axes: Any, report: DesignReport) -> list[Any]:
    """Mark what the modes found; a cross, at the axis' end at most, is what Ipopt did not solve."""
    handles = []
    unsolved: list[tuple[float, int]] = []
    for mode, (marker, size) in MARKERS.items():
        found = [(o, i + 1) for i, o in enumerate(_outcomes(report, mode)) if o is not None]
        if not found:
            continue
        solved = [(o.force, rank) for o, rank in found if o.solved]
        unsolved += [(o.force, rank) for o, rank in found if not o.solved]
        (points,) = axes.plot(
            *_columns(solved),
            marker,
            color=MODE_COLOURS[mode],
            markersize=size,
            markeredgecolor="white",
            markeredgewidth=0.6,
            label=f"after: {MODE_WORDS[mode]} ({mode})",
        )
        handles.append(points)
    if unsolved:
        forces, ranks = _columns(unsolved)
        inside = np.clip(np.nan_to_num(forces, nan=np.inf), *axes.get_xlim())
        style: dict[str, Any] = {"color": BLACK, "markersize": 9, "markeredgewidth": 2.5}
        label = "not solved (at the axis' end if beyond it)"
        handles += axes.plot(inside, ranks, "x", **style, clip_on=False, label=label)
    return handles


def _columns(pairs: Sequence[tuple[float, int]]) -> tuple[list[float], list[int]]:
    return [force for force, _ in pairs], [rank for _, rank in pairs]


def _draw_limit(axes: Any, report: DesignReport) -> list[Any]:
    low, high = axes.get_xlim()
    if not low <= report.limit <= high:
        return []
    label = limit_in_words(report)
    return [axes.axvline(report.limit, color=LIMIT, linewidth=1.5, linestyle="--", label=label)]


def _label(report: DesignReport, low: float, high: float) -> str:
    label = "peak force [N]; the axis does not start at zero"
    if low <= report.limit <= high:
        return label
    side = "left" if report.limit < low else "right"
    return f"{label}\n{limit_in_words(report)}: beyond the axis to the {side}"


def _row_label(pose: RankedPose) -> str:
    candidate = pose.result.candidate
    marks = (RECOVERED if candidate.pose.recovered else "") + (TURNED if candidate.turned else "")
    return f"{pose.rank}.  {candidate.pose.name}{marks}"


def _explanations(poses: Sequence[RankedPose]) -> list[Line2D]:
    """Explain the marks in the labels of the rows, those that occur."""
    candidates = [pose.result.candidate for pose in poses]
    marks = []
    if any(candidate.pose.recovered for candidate in candidates):
        marks.append(("$*$", "not in the source, recovered between neighbours"))
    if any(candidate.turned for candidate in candidates):
        marks.append((r"$\sim$", "given turned about the base, turned back"))
    return [
        Line2D([], [], linestyle="none", marker=mark, color=BLACK, markersize=7, label=label)
        for mark, label in marks
    ]
