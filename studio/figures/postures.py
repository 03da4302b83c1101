# SPDX-License-Identifier: BSD-3-Clause
"""The arm's postures as stick figures: in space, from above and from the side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d.axes3d import Axes3D

from softimpact.studio.design.report import DesignReport
from softimpact.symbolic import Loop, Matrix, Robot
from softimpact.symbolic.dynamics.kinematics import motions, poses
from softimpact.symbolic.robot.rigid import Array

from .style import (
    BEFORE,
    BLACK,
    BOTH,
    LIGHT,
    SMALL,
    TEXT,
    VERMILLION,
    legend_below,
    new_figure,
    setting,
    tidy,
    winner_in_words,
)

VIEWS = ((0, 1, "from above"), (1, 2, "from the front (+x)"), (0, 2, "from the side (−y)"))
"""Flat views: axes to the right and up, and their name. The first two are shown; the last takes the
front's place for an arm in a plane that the front sees edge on."""

FLAT = 0.05
"""Share of its size by which an arm may leave a plane to count as in it."""


@dataclass(frozen=True, eq=False)
class Stick:
    """A posture to draw: points 3×k [m] from the base to the tip, and its looks."""

    points: Array
    label: str
    style: dict[str, Any]


@dataclass(frozen=True, eq=False)
class Drawing:
    """What all views show.

    Attributes:
        sticks: the postures, the winner's last.
        start: the winner's tip, where the impact is, length 3 [m].
        end: of the arrow along its direction, length 3 [m].
        limits: of the cube that holds all, 3×2 [m].
    """

    sticks: tuple[Stick, ...]
    start: Array
    end: Array
    limits: Array


def figure_of_postures(report: DesignReport) -> Figure:
    """Draw all candidate postures faintly, the winner's and the worst over them, and the impact."""
    figure = new_figure(13.0, 5.2)
    grid = figure.add_gridspec(1, 3, width_ratios=(1.4, 1.0, 1.0))
    drawing = _drawing(report)
    _draw_in_space(figure.add_subplot(grid[0], projection=Axes3D.name), drawing)
    width = np.ptp(np.hstack([stick.points for stick in drawing.sticks]), axis=1)
    above, front, side = VIEWS
    for column, view in enumerate((above, side if width[1] < FLAT * width.max() else front)):
        _draw_flat(figure.add_subplot(grid[1 + column]), drawing, view)
    one = len(report.poses) == 1
    whose = "Posture as given and as designed" if one else "Postures of all poses"
    title = f"{whose}; contact at {report.study.model.tip}\n{setting(report)}"
    figure.suptitle(title, fontsize=TEXT + 1)
    legend_below(figure, _legend(drawing), columns=5)
    return figure


def stick_points(robot: Robot, tip: str, postures: Sequence[Array]) -> list[Array]:
    """Return the base, the origins of the joints' own frames and the tip, 3×(n+2) [m] a posture.

    The joints' frames are the file's: the dynamics slide theirs along the axes. Loops come first,
    each once around, so that the arms that close a chain are drawn, too.
    """
    q = ca.SX.sym("q", robot.n)
    known = poses(robot, motions(robot, q))

    def way(name: str) -> list[Matrix]:
        frame = robot.frame(name)
        carrier = known[frame.joint]
        end = carrier.position + ca.mtimes(carrier.rotation, frame.placement.translation)
        return [*(known[i].position for i in reversed(robot.ancestors(frame.joint))), end]

    around = [
        point
        for loop in robot.loops
        if isinstance(loop, Loop)
        for point in [*way(loop.second), *reversed(way(loop.first))]
    ]
    points = ca.Function("stick", [q], [ca.horzcat(*around, ca.SX.zeros(3), *way(tip))])
    return [np.array(points(posture)) for posture in postures]


def _drawing(report: DesignReport) -> Drawing:
    sticks = _sticks(report)
    points = np.hstack([stick.points for stick in sticks])
    size = float(np.ptp(points, axis=1).max())
    start = sticks[-1].points[:, -1]
    end = start + 0.2 * size * report.study.direction
    shown = np.column_stack([points, end])
    center = (shown.min(axis=1) + shown.max(axis=1)) / 2
    half = 0.55 * float(np.ptp(shown, axis=1).max())
    return Drawing(sticks, start, end, np.column_stack([center - half, center + half]))


def _sticks(report: DesignReport) -> tuple[Stick, ...]:
    study, winner, worst = report.study, report.design.winner, report.worst.candidate
    given = [pose.result.candidate.q for pose in report.poses]
    *others, last, first = stick_points(study.robot, study.model.tip, [*given, worst.q, winner.q])
    faint = {"color": LIGHT, "linewidth": 1.0, "markersize": 2.5, "zorder": 1}
    # the worst one is wider, so that it shows where both are the same
    wide = {"linewidth": 5.0, "markersize": 9.0, "color": BEFORE, "zorder": 3}
    strong = {"linewidth": 2.5, "markersize": 6.0, "color": BOTH, "zorder": 4}
    name = f"{winner_in_words(report)} ({winner.mode})"
    alone = len(given) == 1
    before = f"as given: {worst.pose.name}" if alone else f"worst: {worst.pose.name}"
    return (
        *(Stick(points, f"all {len(given)} poses", faint) for points in others if not alone),
        Stick(last, before, {**wide, "markeredgecolor": BLACK}),
        Stick(first, name, {**strong, "markeredgecolor": BLACK}),
    )


def _draw_in_space(axes: Any, drawing: Drawing) -> None:
    for stick in drawing.sticks:
        axes.plot(*stick.points, marker="o", **stick.style)
    axes.plot(0, 0, 0, "s", color=BLACK, markersize=10, zorder=5)
    along = drawing.end - drawing.start
    axes.quiver(*drawing.start, *along, color=VERMILLION, linewidth=2.5, arrow_length_ratio=0.35)
    axes.set(**{f"{name}lim": limits for name, limits in zip("xyz", drawing.limits, strict=True)})
    axes.set_box_aspect((1, 1, 1), zoom=0.93)
    axes.view_init(elev=22, azim=-60)
    axes.locator_params(nbins=5)
    axes.tick_params(labelsize=SMALL)
    axes.set_xlabel("x [m]", fontsize=TEXT)
    axes.set_ylabel("y [m]", fontsize=TEXT)
    axes.set_zlabel("z [m]", fontsize=TEXT)


def _draw_flat(axes: Any, drawing: Drawing, view: tuple[int, int, str]) -> None:
    right, up, name = view
    for stick in drawing.sticks:
        axes.plot(stick.points[right], stick.points[up], marker="o", **stick.style)
    axes.plot(0, 0, "s", color=BLACK, markersize=10, zorder=5)
    axes.annotate(
        "",
        xy=drawing.end[[right, up]],
        xytext=drawing.start[[right, up]],
        arrowprops={"arrowstyle": "-|>", "color": VERMILLION, "linewidth": 2.5, "shrinkA": 0},
        zorder=6,
    )
    axes.set(xlim=drawing.limits[right], ylim=drawing.limits[up], aspect="equal")
    axes.locator_params(nbins=6)
    axes.set_xlabel(f"{'xyz'[right]} [m]", fontsize=TEXT)
    axes.set_ylabel(f"{'xyz'[up]} [m]", fontsize=TEXT)
    axes.set_title(name, fontsize=TEXT)
    tidy(axes)


def _legend(drawing: Drawing) -> list[Line2D]:
    looks = {stick.label: stick.style for stick in drawing.sticks}
    lines = [Line2D([], [], marker="o", label=label, **style) for label, style in looks.items()]
    single: dict[str, Any] = {"linestyle": "none", "markersize": 9}
    base = Line2D([], [], marker="s", color=BLACK, label="base", **single)
    arrow: dict[str, Any] = {**single, "markersize": 20, "color": VERMILLION}
    impact = Line2D([], [], marker=r"$\rightarrow$", label="direction of impact", **arrow)
    return [*lines, base, impact]
