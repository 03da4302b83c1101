# SPDX-License-Identifier: BSD-3-Clause
"""GIAF, masses and peak force along the whole self-motion, with the best point of each."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from softimpact.optimize.search.best_posture import BestPosture
from softimpact.papers.factor_study import FactorStudy
from softimpact.studio.figures.style import (
    BLACK,
    LIGHT,
    SMALL,
    TEXT,
    legend_below,
    new_figure,
    tidy,
)

from .looks import set_looks


def figure_of_redundancy(study: FactorStudy, tip: str) -> Figure:
    """Draw GIAF, reflected masses and peak force over the self-motion's length."""
    figure = new_figure(10.0, 9.5)
    top, middle, bottom = figure.subplots(3, 1, sharex=True)
    arc = study.curve.arc
    for name in study.rotor_sets:
        along, look = study.along[tip, name], {**set_looks(study, name), "marker": None}
        top.plot(arc, along.giaf, **look)
        middle.plot(arc, along.mass_rigid, **look)
        bottom.plot(arc[along.simulated], along.peak_force, **look)
        _mark(top, study, along.most_giaf, look)
        _mark(bottom, study, along.least_force, look)
    elastic = study.along[tip, next(iter(study.rotor_sets))]
    middle.plot(arc, elastic.mass_free, color=BLACK, linestyle="--", linewidth=1.3)
    _mark(middle, study, elastic.least_mass, {"color": BLACK})
    top.set_ylabel("GIAF ζ [–]", fontsize=TEXT)
    middle.set_ylabel("mass felt along the impact [kg]", fontsize=TEXT)
    bottom.set_ylabel("peak force of the first contact [N]", fontsize=TEXT)
    bottom.set_xlabel("length of the self-motion from the task's pose [rad]", fontsize=TEXT)
    for axes in (top, middle, bottom):
        tidy(axes)
    top.set_ylim(bottom=0)
    middle.set_ylim(bottom=0)
    _name_poses(top, study)
    for axes in (middle, bottom):
        _name_poses(axes, study, words=False)
    figure.suptitle(_title(study, tip))
    legend_below(figure, _legend(study), columns=3)
    return figure


def _mark(axes: Any, study: FactorStudy, best: BestPosture, look: dict[str, Any]) -> None:
    place = study.curve.arc[study.curve.nearest(best.q)]
    axes.plot(
        place,
        best.value,
        "*",
        color=look["color"],
        markersize=14,
        markeredgecolor=BLACK,
        zorder=5,
        clip_on=False,
    )


def _name_poses(axes: Any, study: FactorStudy, words: bool = True) -> None:
    """Mark where the poses lie, and name every third."""
    for i, (name, q) in enumerate(zip(study.names, study.poses, strict=True)):
        place = study.curve.arc[study.curve.nearest(q)]
        axes.axvline(place, color=LIGHT, linewidth=0.6, zorder=0)
        if words and i % 4 == 0:
            axes.annotate(
                name,
                (place, 1.0),
                xycoords=("data", "axes fraction"),
                ha="center",
                va="bottom",
                fontsize=SMALL,
            )


def _title(study: FactorStudy, tip: str) -> str:
    problem = study.study
    direction = ", ".join(f"{x:g}" for x in problem.direction)
    stiffness = ", ".join(sorted({f"{k:g}" for k in problem.nominal}))
    return (
        f"{problem.robot.name} along its self-motion, contact at {tip}\n"
        f"{problem.contact.region.title.lower()}, {problem.speed:g} m/s along [{direction}], "
        f"joint stiffness {stiffness} N·m/rad"
    )


def _legend(study: FactorStudy) -> list[Line2D]:
    rigid = [
        Line2D([], [], label=name, **{**set_looks(study, name), "marker": None})
        for name in study.rotor_sets
    ]
    elastic = Line2D([], [], color=BLACK, linestyle="--", label="mass felt without rotors, m_c")
    star: dict[str, Any] = {"marker": "*", "markersize": 12, "linestyle": "none"}
    best = Line2D([], [], color="white", markeredgecolor=BLACK, label="best by Ipopt", **star)
    return [*rigid, elastic, best, Line2D([], [], color=LIGHT, label="the study's poses")]
