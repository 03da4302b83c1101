# SPDX-License-Identifier: BSD-3-Clause
"""Pareto fronts: force and safe speed over the deflection that is allowed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from softimpact.studio.front.pareto_report import CheckedFrontPoint, ParetoReport

from .pareto_designs import figure_of_designs
from .style import (
    BEFORE,
    BLACK,
    BOTH,
    LIGHT,
    LIMIT,
    SKY,
    SPRINGS,
    TEXT,
    legend_below,
    limit_in_words,
    new_figure,
    plain_log_ticks,
    save,
    setting,
    tidy,
)

MM = 1e3

LOOKS: dict[str, dict[str, Any]] = {
    "task": {"color": SPRINGS, "marker": "s", "markersize": 6, "linewidth": 1.8, "zorder": 3},
    "given": {"color": SKY, "marker": "D", "markersize": 8, "linewidth": 4.0, "zorder": 2.5},
    "free": {"color": BOTH, "marker": "o", "markersize": 5, "linewidth": 1.8, "zorder": 4},
}
"""Of the fronts, as they are drawn; the given poses' is wide, for the free one may cover it."""


def draw_pareto_figures(report: ParetoReport, folder: Path) -> list[Path]:
    """Draw the fronts' figures as PNG files; return their paths.

    Args:
        report: of fronts.
        folder: an existing one; files of the same name are replaced.
    """
    figures = {
        "fronts": figure_of_fronts(report),
        "safe_speed": figure_of_speeds(report),
        "designs": figure_of_designs(report),
    }
    return [save(figure, folder / f"{name}.png") for name, figure in figures.items()]


def figure_of_fronts(report: ParetoReport) -> Figure:
    """Draw the peak force over the deflection, the posture free and held, and the reference."""
    figure = new_figure(8.0, 6.0)
    axes = figure.add_subplot()
    reference = report.pareto.reference
    handles = [*_draw_held(axes, report)]
    handles += _draw_fronts(axes, report, lambda checked: checked.point.force)
    handles += _draw_reference(axes, report, reference.force)
    bend = report.knee("free")
    if bend is not None:
        point = report.fronts["free"][bend].point
        at = [MM * point.deflection], [point.force]
        look: dict[str, Any] = {"marker": "*", "markersize": 17, "linestyle": "none", "zorder": 5}
        handles += axes.plot(*at, color=BLACK, label="knee of the free front", **look)
    low, high = axes.get_ylim()
    near = low - 0.5 * (high - low) <= report.limit <= high + 0.5 * (high - low)
    if near:
        handles.append(_draw_limit(axes, report))
    axes.set_ylabel("least peak force [N]", fontsize=TEXT)
    below = "" if near else f"\n{limit_in_words(report)}: beyond the axis"
    _finish(figure, report, handles, _of_force(report), below)
    return figure


def figure_of_speeds(report: ParetoReport) -> Figure:
    """Draw the speed that meets the region's limit over the deflection."""
    figure = new_figure(8.0, 5.6)
    axes = figure.add_subplot()
    handles = _draw_fronts(axes, report, lambda checked: checked.safe_speed)
    handles += _draw_reference(axes, report, report.reference_speed)
    axes.set_ylabel("speed at first touch that meets the limit [m/s]", fontsize=TEXT)
    slow, fast = (report.fronts["free"][i].safe_speed for i in (0, -1))
    title = (
        f"The soft end may run at {fast:.2g} m/s, the accurate one at {slow:.2g} m/s\n"
        f"{limit_in_words(report)}"
    )
    _finish(figure, report, handles, title, "")
    return figure


def _of_force(report: ParetoReport) -> str:
    """Return what the softest design saves over the most accurate one."""
    first, last = (report.fronts["free"][i].point for i in (0, -1))
    if first is last:
        return "Least peak force by accuracy"
    return (
        f"Giving way by {MM * last.deflection:.2g} instead of {MM * first.deflection:.2g} mm saves "
        f"{1 - last.force / first.force:.0%} of the force"
    )


def _finish(
    figure: Figure, report: ParetoReport, handles: list[Any], title: str, below: str
) -> None:
    (axes,) = figure.axes
    bound = MM * report.study.max_deflection
    low, high = axes.get_xlim()
    if low < bound < high:
        label = f"the study's bound, {bound:g} mm"
        handles.append(axes.axvline(bound, color=BLACK, linestyle=":", linewidth=1.2, label=label))
    newton = ", ".join(f"{force:.3g}" for force in _magnitudes(report))
    axes.set_xlabel(
        f"largest deflection of the tip under {newton} N [mm] (softer →); the vertical axis does "
        f"not start at zero{below}",
        fontsize=TEXT,
    )
    axes.set_title(f"{title}\n{setting(report)}", fontsize=TEXT + 1)
    plain_log_ticks(axes)
    tidy(axes)
    legend_below(figure, handles, columns=2)


def _magnitudes(report: ParetoReport) -> list[float]:
    """Magnitudes of the study's forces, each once [N]."""
    found = (float((force @ force) ** 0.5) for force in report.study.forces)
    return list(dict.fromkeys(round(force, 6) for force in found))


def _draw_held(axes: Any, report: ParetoReport) -> list[Any]:
    """Draw the fronts of all given poses faintly."""
    lines: list[Any] = []
    for front in report.pareto.held.values():
        deflections = [MM * point.deflection for point in front.points]
        forces = [point.force for point in front.points]
        lines += axes.plot(deflections, forces, color=LIGHT, linewidth=1.0, zorder=1)
    if len(lines) < 2:
        return []
    lines[0].set_label("each given pose, springs designed")
    return lines[:1]


def _draw_fronts(axes: Any, report: ParetoReport, height: Any) -> list[Any]:
    axes.set_xscale("log")
    poses = len(report.study.poses)
    labels = {
        "task": f"springs designed, {report.study.task_pose.name} held",
        "given": f"springs designed, best of the {poses} given poses",
        "free": "springs and posture designed",
    }
    handles = []
    for name, looks in LOOKS.items():
        points: Sequence[CheckedFrontPoint] = report.fronts[name]
        if not points or (name == "given" and poses == 1):
            continue
        deflections = [MM * checked.point.deflection for checked in points]
        style = {"markeredgecolor": "white", "markeredgewidth": 0.6, **looks}
        heights = [height(checked) for checked in points]
        handles += axes.plot(deflections, heights, label=labels[name], **style)
    return handles[::-1]


def _draw_reference(axes: Any, report: ParetoReport, height: float) -> list[Any]:
    label = f"before: {report.study.task_pose.name} with nominal springs"
    style: dict[str, Any] = {"color": BEFORE, "markersize": 10, "markeredgecolor": BLACK}
    deflection = MM * report.pareto.reference.deflection
    handles = axes.plot(deflection, height, "D", zorder=5, linestyle="none", label=label, **style)
    return list(handles)


def _draw_limit(axes: Any, report: ParetoReport) -> Any:
    label = limit_in_words(report)
    return axes.axhline(report.limit, color=LIMIT, linewidth=1.5, linestyle="--", label=label)
