# SPDX-License-Identifier: BSD-3-Clause
"""The designs along a Pareto front: joint stiffness and posture over the deflection."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from softimpact.optimize.machine.springs import sprung
from softimpact.studio.front.pareto_report import ParetoReport
from softimpact.symbolic import JointKind

from .style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    TEXT,
    VERMILLION,
    legend_below,
    new_figure,
    plain_log_ticks,
    setting,
    tidy,
)

COLOURS = (BLACK, BLUE, ORANGE, GREEN, VERMILLION, SKY, PURPLE)
MARKERS = "osD^v<>"
"""Seven of each; they repeat together, with dashes."""


def figure_of_designs(report: ParetoReport) -> Figure:
    """Draw each joint's stiffness and angle along the front with a free posture."""
    figure = new_figure(11.0, 5.4)
    stiffness, angles = figure.subplots(1, 2)
    points = [checked.point for checked in report.fronts["free"]]
    deflection = [1e3 * point.deflection for point in points]
    springs = np.array([point.outcome.springs for point in points])
    robot = report.study.robot
    handles, places = [], sprung(report.study.model)
    for i, joint in enumerate(robot.joints):
        style = _style(i)
        if i in places:
            found = springs[:, places.index(i)]
            stiffness.plot(deflection, found, label=joint.name, **style)
        scale = 180 / np.pi if joint.kind is JointKind.HINGE else 1e3
        change = [scale * (p.outcome.q[i] - report.pareto.reference.q[i]) for p in points]
        handles += angles.plot(deflection, change, label=joint.name, **style)
    for axes in (stiffness, angles):
        axes.set_xscale("log")
        plain_log_ticks(axes)
        axes.set_xlabel("largest deflection of the tip [mm] (softer →)", fontsize=TEXT)
        tidy(axes)
    _finish(stiffness, angles, report)
    figure.suptitle(
        f"Designs along the front, springs and posture free\n{setting(report)}", fontsize=TEXT + 1
    )
    legend_below(figure, handles, columns=min(len(handles), 7))
    return figure


def _finish(stiffness: Any, angles: Any, report: ParetoReport) -> None:
    study = report.study
    joints = study.robot.joints
    units = {JointKind.HINGE: ("N·m/rad", "deg"), JointKind.SLIDE: ("N/m", "mm")}
    kinds = {joint.kind for joint in joints}, {joints[i].kind for i in sprung(study.model)}
    of_joints, of_springs = (
        ", ".join(units[kind][which] for kind in units if kind in some)
        for which, some in zip((1, 0), kinds, strict=True)
    )
    stiffness.set_yscale("log")
    stiffness.set_ylim(study.lower.min() / 1.3, study.upper.max() * 1.3)
    stiffness.set_ylabel(f"joint stiffness $k_s$ [{of_springs}]", fontsize=TEXT)
    angles.set_ylabel(f"posture, from {study.task_pose.name}'s [{of_joints}]", fontsize=TEXT)


def _style(i: int) -> dict[str, Any]:
    place, again = i % len(COLOURS), i >= len(COLOURS)
    return {
        "color": COLOURS[place],
        "marker": MARKERS[place],
        "linestyle": "--" if again else "-",
        "markersize": 5,
        "linewidth": 1.5,
    }
