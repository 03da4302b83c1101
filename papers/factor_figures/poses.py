# SPDX-License-Identifier: BSD-3-Clause
"""GIAF of all poses, and how it changes with rotors and gears (GIAF Fig. 1 and 2)."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from softimpact.papers.factor_study import FactorStudy
from softimpact.papers.factor_study.poses import RATIOS, SCALES
from softimpact.studio.figures.style import SMALL, TEXT, legend_below, new_figure, tidy
from softimpact.symbolic.robot.rigid import Array

from .looks import label_poses, series, set_looks


def figure_of_poses(study: FactorStudy) -> Figure:
    """Draw GIAF over the poses for every set of rotors, a panel for each tip."""
    figure = new_figure(10.0, 0.8 + 2.9 * len(study.tips))
    panels = figure.subplots(len(study.tips), 1, sharex=True, squeeze=False)[:, 0]
    lines: list[Any] = []
    for axes, tip in zip(panels, study.tips, strict=True):
        lines = [
            axes.plot(study.factors[tip, name].giaf, label=name, **set_looks(study, name))[0]
            for name in study.rotor_sets
        ]
        axes.set_title(f"contact at {tip}", fontsize=TEXT)
        axes.set_ylabel("GIAF ζ [–]", fontsize=TEXT)
        axes.set_ylim(bottom=0)
        label_poses(axes, study)
        tidy(axes)
    figure.suptitle(f"Impact absorption of {study.study.robot.name}, by set of rotor inertias")
    legend_below(figure, lines, columns=len(lines))
    return figure


def figure_of_sweeps(study: FactorStudy, tip: str) -> Figure:
    """Draw GIAF over the poses with scaled rotors and gears, a column for each set of rotors."""
    names = list(study.rotor_sets)
    figure = new_figure(3.0 + 3.3 * len(names), 7.0)
    grid = figure.subplots(2, len(names), sharex=True, sharey=True, squeeze=False)
    for column, name in enumerate(names):
        factors = study.factors[tip, name]
        rows = ((factors.inertia_sweep, SCALES, "× b"), (factors.gear_sweep, RATIOS, "× N"))
        for axes, (values, scales, unit) in zip(grid[:, column], rows, strict=True):
            lines = _sweep(axes, values, scales, unit)
            label_poses(axes, study)
            tidy(axes)
            if column == 0:
                what = "reflected inertia b" if unit == "× b" else "gear ratio N, b ∝ N²"
                axes.set_ylabel(f"GIAF ζ [–]\n{what}", fontsize=TEXT)
            if column == len(names) - 1:
                axes.legend(
                    handles=lines,
                    fontsize=SMALL,
                    loc="center left",
                    bbox_to_anchor=(1.0, 0.5),
                    frameon=False,
                )
        grid[0, column].set_title(name, fontsize=TEXT)
    figure.suptitle(f"GIAF of {study.study.robot.name} at {tip} with scaled rotors and gears")
    return figure


def _sweep(axes: Any, values: Array, scales: tuple[float, ...], unit: str) -> list[Any]:
    axes.set_yscale("log")
    return [
        axes.plot(values[:, k], label=f"{scale:g} {unit}", **{**series(k), "markersize": 3})[0]
        for k, scale in enumerate(scales)
    ]
