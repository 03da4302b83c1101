# SPDX-License-Identifier: BSD-3-Clause
"""Figures of results, each drawn into Matplotlib axes of yours or of their own.

    axes = assess_impact(model, approach, contact).plot()
    axes.figure.savefig("impact.png")

``plot`` draws any result; the functions below it draw one kind each. They open no window and need
no display.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import singledispatch
from typing import Any

import numpy as np

from softimpact.optimize import Design, Pareto, TradeOff
from softimpact.simulate import Assessment, Assessments, ImpactHistory
from softimpact.simulate.assessments import AssessedImpact
from softimpact.studio.figures.style import (
    BEFORE,
    BLUE,
    BOTH,
    GREEN,
    LIMIT,
    PURPLE,
    SKY,
    SPRINGS,
    TEXT,
    new_figure,
    tidy,
)
from softimpact.symbolic import Analysis, InvalidValue

COLOURS = (BLUE, BEFORE, GREEN, PURPLE, SKY)
"""Of lines, in their order."""

MILLI = 1e3


def own_axes(axes: Any, width: float = 7.0, height: float = 4.0) -> Any:
    """Return the axes given, or those of a new figure [in]."""
    return new_figure(width, height).add_subplot() if axes is None else axes


@singledispatch
def plot(result: Any, axes: Any = None) -> Any:
    """Draw a result.

    Args:
        result: of ``analyse``, ``simulate_impact``, ``assess_impact``, ``assess_impacts``,
            ``design``, ``pareto_fronts`` or ``trade_off_front``.
        axes: Matplotlib's, to draw into; None makes a figure of its own.

    Returns:
        The axes.

    Raises:
        InvalidValue: there is no figure of such a result.
    """
    raise InvalidValue("result", f"there is no figure of a {type(result).__name__}")


@plot.register
def plot_history(result: ImpactHistory, axes: Any = None) -> Any:
    """Draw the contact force over time."""
    return plot_forces([result], ["contact force"], axes)


@plot.register
def plot_assessment(result: Assessment, axes: Any = None) -> Any:
    """Draw the contact force at each end of what the motors may do, and the limit."""
    names = [f"motors {kind}" for kind in result.ends]
    axes = plot_forces(list(result.ends.values()), names, axes)
    limit = result.limits.transient.force
    if np.isfinite(limit):
        label = f"limit, {limit:.0f} N"
        axes.axhline(limit, color=LIMIT, linewidth=1.5, linestyle="--", label=label)
        axes.set_ylim(top=1.08 * max(limit, result.history.peak))
    axes.set_title(f"Contact force: {result.verdict.ruling}", fontsize=TEXT + 1)
    axes.legend(fontsize=TEXT, frameon=False)
    return axes


def plot_forces(
    histories: Sequence[ImpactHistory], names: Sequence[str], axes: Any = None
) -> Any:
    """Draw several contact forces over time until the last of them has passed, peaks marked."""
    axes = own_axes(axes)
    for history, name, colour in zip(histories, names, COLOURS * len(names), strict=False):
        time = MILLI * history.time
        axes.plot(time, history.force, color=colour, linewidth=2.0, label=name)
        axes.plot(MILLI * history.time_of_peak, history.peak, "o", color=colour)
    pressed = [h.time[np.flatnonzero(h.force > 0).max(initial=0)] for h in histories]
    axes.set_xlim(0.0, MILLI * 1.05 * max(*pressed, 1e-3))
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("time since first touch [ms]", fontsize=TEXT)
    axes.set_ylabel("contact force [N]", fontsize=TEXT)
    axes.set_title("Contact force", fontsize=TEXT + 1)
    tidy(axes)
    if len(histories) > 1:
        axes.legend(fontsize=TEXT, frameon=False)
    return axes


@plot.register
def plot_assessments(result: Assessments, axes: Any = None) -> Any:
    """Draw what share of its limit each of many impacts takes."""
    axes = own_axes(axes, height=1.5 + 0.3 * len(result.cases))
    shares = [100 * case.found.verdict.share for case in result.cases]
    colours = [LIMIT if share > 100 else BLUE for share in shares]
    places = range(len(shares))
    axes.barh(places, shares, color=colours, height=0.7)
    axes.axvline(100, color=LIMIT, linewidth=1.5, linestyle="--")
    axes.set_yticks(places, [_case_in_words(case) for case in result.cases], fontsize=TEXT)
    axes.invert_yaxis()
    axes.set_xlabel("share of the limit that binds [%]", fontsize=TEXT)
    axes.set_title("Impacts against their limits", fontsize=TEXT + 1)
    tidy(axes, "x")
    return axes


def _case_in_words(case: AssessedImpact) -> str:
    along = ", ".join(f"{x:.3g}" for x in case.direction)
    return f"{case.point} along [{along}] on {case.region}: {case.found.history.peak:.0f} N"


@plot.register
def plot_analysis(result: Analysis, axes: Any = None) -> Any:
    """Draw the chain that stands for the robot: its masses, and the springs behind them."""
    axes = own_axes(axes)
    mass, stiffness = result.chain.mass, result.chain.stiffness
    places = np.arange(len(mass))
    axes.bar(places, mass, width=0.6, color=BLUE)
    for i, (m, k) in enumerate(zip(mass, stiffness, strict=True)):
        axes.annotate(
            f"{m:.3g} kg\n{k:.3g} N/m behind it",
            (i, m),
            xytext=(0, 3),
            textcoords="offset points",
            ha="center",
            fontsize=TEXT,
        )
    axes.set_ylim(0.0, 1.25 * max(mass))
    axes.set_xticks(places, ["contact", *(str(i + 1) for i in places[1:])], fontsize=TEXT)
    axes.set_xlabel("from the contact point to ground", fontsize=TEXT)
    axes.set_ylabel("mass [kg]", fontsize=TEXT)
    axes.set_title("Chain of masses and springs", fontsize=TEXT + 1)
    tidy(axes, "y")
    return axes


@plot.register
def plot_design(result: Design, axes: Any = None) -> Any:
    """Draw each pose's force before the design and after it."""
    axes = own_axes(axes, width=max(4.0, 2.0 + 0.3 * len(result.poses)))
    names = [pose.candidate.pose.name for pose in result.poses]
    before = [pose.force_before for pose in result.poses]
    axes.plot(names, before, "o", color=BEFORE, label="nominal springs")
    for mode, colour, label in (
        ("table", SPRINGS, "springs designed"),
        ("free", BOTH, "springs and posture designed"),
    ):
        forces = [getattr(getattr(pose, mode), "force", np.nan) for pose in result.poses]
        if np.isfinite(forces).any():
            axes.plot(names, forces, "o", color=colour, label=label)
    axes.tick_params(axis="x", rotation=90 if len(names) > 8 else 0)
    axes.margins(x=0.5 if len(names) == 1 else 0.05)
    axes.set_xlabel("pose", fontsize=TEXT)
    axes.set_ylabel("largest force [N]", fontsize=TEXT)
    axes.set_title(result.study.title, fontsize=TEXT + 1)
    tidy(axes)
    axes.legend(fontsize=TEXT, frameon=False)
    return axes


@plot.register
def plot_pareto(result: Pareto, axes: Any = None) -> Any:
    """Draw the fronts between accuracy and force."""
    axes = own_axes(axes)
    task = result.study.task_pose.name
    for front, colour, label in (
        (result.task, SPRINGS, f"posture of {task}"),
        (result.free, BOTH, "posture free"),
    ):
        deflections = [MILLI * point.deflection for point in front.points]
        forces = [point.force for point in front.points]
        axes.plot(deflections, forces, "o-", color=colour, label=label)
    axes.set_xscale("log")
    axes.set_xlabel("largest deflection [mm]", fontsize=TEXT)
    axes.set_ylabel("largest force [N]", fontsize=TEXT)
    axes.set_title(result.study.title, fontsize=TEXT + 1)
    tidy(axes)
    axes.legend(fontsize=TEXT, frameon=False)
    return axes


@plot.register
def plot_trade_off(result: TradeOff, axes: Any = None) -> Any:
    """Draw the front of two or three objectives; the third is a colour."""
    axes = own_axes(axes)
    all_, order = result.axes.all, result.axes.order
    values = np.array([point.values for point in result.points])
    y, x, *third = (order.index(place) for place in range(len(all_)))
    titles = [f"{axis.kind.replace('_', ' ')} [{axis.unit}]" for axis in all_]
    if third:
        look: dict[str, Any] = {"c": values[:, third[0]], "cmap": "cividis", "edgecolors": "black"}
        marks = axes.scatter(values[:, x], values[:, y], **look)
        axes.figure.colorbar(marks, ax=axes).set_label(titles[third[0]], fontsize=TEXT)
    else:
        axes.plot(values[:, x], values[:, y], "o-", color=BOTH)
    axes.set_xscale("log")
    axes.set_xlabel(titles[x], fontsize=TEXT)
    axes.set_ylabel(titles[y], fontsize=TEXT)
    axes.set_title(result.study.title, fontsize=TEXT + 1)
    tidy(axes)
    return axes
