# SPDX-License-Identifier: BSD-3-Clause
"""IMF on a floating base of growing mass: it says nothing about a fixed one."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from softimpact.papers.factor_study import FactorStudy
from softimpact.papers.factor_study.heavy_base import MASSES
from softimpact.studio.figures.style import TEXT, legend_below, new_figure, tidy

from .looks import set_looks


def figure_of_heavy_base(study: FactorStudy) -> Figure:
    """Draw 1 − ξ and ζ over the mass of the base, the band that all poses lie in."""
    figure = new_figure(10.0, 4.8)
    left, right = figure.subplots(1, 2)
    lines: list[Any] = []
    for name, found in study.heavy_base.items():
        look = set_looks(study, name)
        for axes, values in ((left, found.not_mitigated), (right, found.giaf)):
            low, high = values.min(axis=0), values.max(axis=0)
            axes.fill_between(MASSES, low, high, color=look["color"], alpha=0.25, linewidth=0)
            middle = axes.plot(MASSES, (low * high) ** 0.5, label=name, **look)[0]
        lines.append(middle)
    left.set_yscale("log")
    left.set_ylabel("1 − IMF, 1 − ξ [–]", fontsize=TEXT)
    right.set_ylabel("GIAF ζ [–]", fontsize=TEXT)
    right.set_ylim(bottom=0)
    left.set_title("IMF goes to one in every pose, as 1/mass", fontsize=TEXT)
    right.set_title("GIAF goes to the fixed robot's", fontsize=TEXT)
    for axes in (left, right):
        axes.set_xscale("log")
        axes.set_xlabel("mass of the floating base [kg]", fontsize=TEXT)
        tidy(axes)
    tip, poses = study.study.model.tip, len(study.names)
    figure.suptitle(
        f"{study.study.robot.name} on a floating base, contact at {tip}: bands over {poses} poses"
    )
    legend_below(figure, lines, columns=len(lines))
    return figure
