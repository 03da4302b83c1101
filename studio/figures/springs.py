# SPDX-License-Identifier: BSD-3-Clause
"""The joint stiffness of the winner and of the other outcomes, between its bounds."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from softimpact.optimize import Outcome
from softimpact.optimize.machine.springs import sprung
from softimpact.studio.design.report import DesignReport
from softimpact.symbolic import JointKind

from .style import (
    BLACK,
    BOTH,
    FAINT,
    SKY,
    SMALL,
    TEXT,
    legend_below,
    new_figure,
    setting,
    tidy,
    winner_in_words,
)

HALF_WIDTH = 0.32
"""Half the width of a joint's column, in units of the distance between joints."""


def figure_of_springs(report: DesignReport) -> Figure:
    """Draw the stiffness of each joint on a logarithmic scale, a column a joint.

    The other outcomes stand side by side in the order of their rank, so that agreement shows as a
    row and a joint whose stiffness hardly matters as scatter.
    """
    study, winner = report.study, report.design.winner
    figure = new_figure(8.0, 5.0)
    axes = figure.add_subplot()
    axes.set_yscale("log")
    columns = np.arange(len(study.spring_names))
    axes.bar(
        columns, study.upper - study.lower, 2.4 * HALF_WIDTH, study.lower, color=FAINT, zorder=1
    )
    handles: list[Any] = [Patch(color=FAINT, label="bounds")]
    handles.append(_draw_nominal(axes, report))
    handles.extend(_draw_others(axes, report))
    handles += axes.plot(
        columns,
        winner.springs,
        "D",
        color=BOTH,
        markersize=9,
        markeredgecolor=BLACK,
        label=f"{winner_in_words(report)} ({winner.mode})",
        zorder=4,
    )
    axes.set_ylim(study.lower.min() / 1.5, study.upper.max() * 1.5)
    _name_joints(axes, report)
    axes.set_ylabel(f"joint stiffness $k_s$ [{_unit(report)}]", fontsize=TEXT)
    axes.set_title(f"{_message(report)}\n{setting(report)}", fontsize=TEXT + 1)
    tidy(axes, grid="y")
    legend_below(figure, handles, columns=2)
    return figure


def _message(report: DesignReport) -> str:
    """Return which joints' stiffness matters, and which does not."""
    study, ranges = report.study, report.design.answers.indifferent[list(report.study.groups)]
    names = study.spring_names
    loose = [name for name, (low, high) in zip(names, ranges, strict=True) if high > LOOSE * low]
    if not loose:
        return "Joint stiffness of least peak force: every joint matters"
    matter = "matters" if len(loose) == 1 else "matter"
    return f"Joint stiffness of least peak force: {len(loose)} of {len(names)} hardly {matter}"


LOOSE = 10.0
"""Ratio of the ends of a range that costs less than 0.5 % from which on a joint hardly matters."""


def other_outcomes(report: DesignReport) -> list[Outcome]:
    """Return the solved outcomes by rank, without the winner: of free mode, or of table alone."""
    results = [pose.result for pose in report.poses]
    found = [result.free for result in results if result.free is not None]
    found = found or [result.table for result in results if result.table is not None]
    return [outcome for outcome in found if outcome.solved and outcome is not report.design.winner]


def _draw_nominal(axes: Any, report: DesignReport) -> Any:
    nominal = report.study.nominal
    columns = np.arange(nominal.size)
    ends = columns - 1.2 * HALF_WIDTH, columns + 1.2 * HALF_WIDTH
    label = "nominal"
    return axes.hlines(nominal, *ends, color=BLACK, linestyle="--", label=label, zorder=2)


def _draw_others(axes: Any, report: DesignReport) -> list[Any]:
    others = other_outcomes(report)
    if not others:
        return []
    shifts = np.linspace(-HALF_WIDTH, HALF_WIDTH, len(others)) if len(others) > 1 else np.zeros(1)
    places = shifts[:, None] + np.arange(len(report.study.spring_names))
    stiffness = np.array([outcome.springs for outcome in others])
    style: dict[str, Any] = {"color": SKY, "markersize": 4, "zorder": 3}
    label = f"other outcomes ({others[0].mode}), by rank from left to right"
    return list(axes.plot(places.ravel(), stiffness.ravel(), "o", label=label, **style))


def _name_joints(axes: Any, report: DesignReport) -> None:
    names = report.study.spring_names
    crowded = sum(map(len, names)) > 70
    turn: dict[str, Any] = {"rotation": 25, "ha": "right"} if crowded else {}
    axes.set_xticks(range(len(names)), names, fontsize=SMALL, **turn)


def _unit(report: DesignReport) -> str:
    units = {JointKind.HINGE: "N·m/rad", JointKind.SLIDE: "N/m"}
    joints = [report.study.robot.joints[i] for i in sprung(report.study.model)]
    return ", ".join(dict.fromkeys(units[joint.kind] for joint in joints))
