# SPDX-License-Identifier: BSD-3-Clause
"""Postures by rank: what an impact in each of them does, the springs given."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from softimpact.optimize import Study
from softimpact.studio.design.selection import NAMES, Criterion, PoseFigures

from .style import BLUE, LIMIT, SMALL, TEXT, new_figure, tidy


def figure_of_selection(
    study: Study, criterion: Criterion, ranked: Sequence[PoseFigures]
) -> Figure:
    """Draw the peak force of each posture, best first by a criterion.

    Args:
        study: robot, impact and configurations.
        criterion: that they are ranked by.
        ranked: best first.
    """
    figure = new_figure(8.0, 1.6 + 0.22 * len(ranked))
    axes = figure.add_subplot()
    place, force = np.arange(len(ranked)), [pose.peak_force for pose in ranked]
    axes.barh(place, force, color=BLUE, height=0.62)
    for k, value in zip(place, force, strict=True):
        axes.annotate(
            f"{value:.0f}",
            (value, k),
            xytext=(3, 0),
            textcoords="offset points",
            va="center",
            fontsize=SMALL,
        )
    limit = study.limit
    axes.axvline(limit, color=LIMIT, linestyle="--", linewidth=1.5)
    axes.annotate(
        f"limit {limit:.4g} N",
        (limit, -0.6),
        xytext=(4, 0),
        textcoords="offset points",
        color=LIMIT,
        fontsize=SMALL,
        va="bottom",
    )
    axes.set_yticks(place, [pose.name for pose in ranked])
    axes.set_ylim(len(ranked) - 0.4, -1.4)
    axes.set_xlim(0, 1.12 * max(*force, limit))
    axes.set_xlabel("peak force [N]", fontsize=TEXT)
    by = "" if criterion == "peak_force" else f", ranked by {NAMES[criterion]}"
    spread = max(force) / min(force) - 1
    axes.set_title(
        f"The posture is worth {100 * spread:.0f} % of force: {min(force):.0f} to "
        f"{max(force):.0f} N{by}",
        fontsize=TEXT + 1,
        loc="left",
    )
    tidy(axes, grid="x")
    return figure
