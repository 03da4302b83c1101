# SPDX-License-Identifier: BSD-3-Clause
"""Some of the postures that hold the task (GIAF Fig. 5)."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from softimpact.papers.factor_study import FactorStudy
from softimpact.studio.figures.postures import VIEWS, stick_points
from softimpact.studio.figures.style import LIGHT, TEXT, legend_below, new_figure, tidy

from .looks import SERIES

SHOWN = 5
"""Postures drawn in colour, spread evenly over the study's."""


def figure_of_chosen_postures(study: FactorStudy) -> Figure:
    """Draw some postures from above and from the front, all others faintly behind them."""
    model = study.study.model
    sticks = stick_points(model.robot, model.tip, list(study.poses))
    chosen = np.unique(np.linspace(0, len(sticks) - 1, SHOWN).round().astype(int))
    figure = new_figure(10.0, 5.6)
    panels = figure.subplots(1, len(VIEWS))
    lines: list[Any] = []
    for axes, (right, up, words) in zip(panels, VIEWS, strict=True):
        for points in sticks:
            axes.plot(points[right], points[up], color=LIGHT, linewidth=0.8, zorder=1)
        lines = [
            axes.plot(
                sticks[i][right],
                sticks[i][up],
                label=study.names[i],
                color=SERIES[k][0],
                marker=SERIES[k][1],
                linewidth=2.2,
                markersize=5,
                zorder=2,
            )[0]
            for k, i in enumerate(chosen)
        ]
        axes.set_aspect("equal", adjustable="datalim")
        axes.set_xlabel(f"{'xyz'[right]} [m]", fontsize=TEXT)
        axes.set_ylabel(f"{'xyz'[up]} [m]", fontsize=TEXT)
        axes.set_title(words, fontsize=TEXT)
        tidy(axes)
    title = f"Postures of {model.robot.name} with the tip in one place, base to {model.tip}"
    figure.suptitle(title)
    legend_below(figure, lines, columns=len(lines))
    return figure
