# SPDX-License-Identifier: BSD-3-Clause
"""Directional GIAF of the first pose in two planes (GIAF Fig. 4)."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from softimpact.papers.factor_study import FactorStudy
from softimpact.papers.factor_study.poses import ANGLES, PLANES
from softimpact.studio.figures.style import SMALL, TEXT, legend_below, new_figure

from .looks import set_looks

WORDS = {
    "base_xy": "base axes, +x to +y",
    "base_xz": "base axes, +x to +z",
    "tip_xy": "tip's axes, +x to +y",
    "tip_xz": "tip's axes, +x to +z",
}


def figure_of_directions(study: FactorStudy) -> Figure:
    """Draw the directional GIAF of the first pose in planes of base and tip, tips by planes."""
    figure = new_figure(14.0, 1.0 + 3.7 * len(study.tips))
    kind = {"projection": "polar"}
    grid = figure.subplots(len(study.tips), len(PLANES), subplot_kw=kind, squeeze=False)
    lines: list[Any] = []
    for row, tip in enumerate(study.tips):
        for axes, plane in zip(grid[row], PLANES, strict=True):
            lines = [
                axes.plot(
                    ANGLES,
                    study.factors[tip, name].polar[plane],
                    label=name,
                    **{**set_looks(study, name), "marker": None, "linewidth": 1.8},
                )[0]
                for name in study.rotor_sets
            ]
            axes.set_ylim(0, 1)
            axes.set_yticks([0.25, 0.5, 0.75, 1.0], ["", "0.5", "", "1"])
            axes.set_rlabel_position(0)
            axes.set_xticks(np.radians(range(0, 360, 30)))
            axes.tick_params(labelsize=SMALL)
            axes.set_title(f"{tip}\n{WORDS[plane]}", fontsize=TEXT)
    title = f"Directional GIAF ζₓ [–] of {study.study.robot.name} in pose {study.names[0]}"
    figure.suptitle(title)
    legend_below(figure, lines, columns=len(lines))
    return figure
