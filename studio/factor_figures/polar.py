# SPDX-License-Identifier: BSD-3-Clause
"""Directional GIAF of the first pose in two planes (GIAF Fig. 4)."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from softimpact.studio.factor_study import FactorStudy
from softimpact.studio.factor_study.poses import ANGLES
from softimpact.studio.figures.style import SMALL, TEXT, legend_below, new_figure

from .looks import set_looks

PLANES = (("polar_xy", "xy plane, angle from +x to +y"), ("polar_xz", "xz plane, from +x to +z"))


def figure_of_directions(study: FactorStudy) -> Figure:
    """Draw the directional GIAF of the first pose around z and around y, tips by planes."""
    figure = new_figure(9.0, 0.9 + 4.2 * len(study.tips))
    kind = {"projection": "polar"}
    grid = figure.subplots(len(study.tips), 2, subplot_kw=kind, squeeze=False)
    lines: list[Any] = []
    for row, tip in enumerate(study.tips):
        for axes, (plane, words) in zip(grid[row], PLANES, strict=True):
            lines = [
                axes.plot(
                    ANGLES,
                    getattr(study.factors[tip, name], plane),
                    label=name,
                    **{**set_looks(study, name), "marker": None, "linewidth": 1.8},
                )[0]
                for name in study.rotor_sets
            ]
            axes.set_ylim(0, 1)
            axes.set_yticks([0.25, 0.5, 0.75, 1.0])
            axes.tick_params(labelsize=SMALL)
            axes.set_title(f"{tip}: {words}", fontsize=TEXT)
    title = f"Directional GIAF ζₓ [–] of {study.study.robot.name} in pose {study.names[0]}"
    figure.suptitle(title)
    legend_below(figure, lines, columns=len(lines))
    return figure
