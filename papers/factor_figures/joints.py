# SPDX-License-Identifier: BSD-3-Clause
"""Which joint's rotor matters most (GIAF Fig. 3)."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from softimpact.papers.factor_study import FactorStudy
from softimpact.studio.figures.style import TEXT, legend_below, new_figure, tidy

from .looks import label_poses, series


def figure_of_joints(study: FactorStudy) -> Figure:
    """Draw GIAF with the rotor of one joint alone, tips by sets of rotors."""
    names = list(study.rotor_sets)
    figure = new_figure(1.0 + 3.6 * len(names), 1.2 + 2.9 * len(study.tips))
    grid = figure.subplots(len(study.tips), len(names), sharex=True, sharey=True, squeeze=False)
    lines: list[Any] = []
    for row, tip in enumerate(study.tips):
        for column, name in enumerate(names):
            axes, values = grid[row, column], study.factors[tip, name].single_joint_giaf
            lines = [
                axes.plot(values[:, i], label=joint, **{**series(i), "markersize": 3.5})[0]
                for i, joint in enumerate(study.study.robot.joint_names)
            ]
            axes.set_ylim(0, 1.02)
            label_poses(axes, study)
            tidy(axes)
            if row == 0:
                axes.set_title(name, fontsize=TEXT)
            if column == 0:
                axes.set_ylabel(f"single-joint GIAF ζᵢ [–]\nat {tip}", fontsize=TEXT)
    figure.suptitle(f"GIAF of {study.study.robot.name} with the rotor of one joint alone")
    legend_below(figure, lines, columns=len(lines))
    return figure
