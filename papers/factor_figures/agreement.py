# SPDX-License-Identifier: BSD-3-Clause
"""How well factors foretell the order of peak forces, from soft to rigid joints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from softimpact.papers.factor_study import FactorStudy
from softimpact.papers.factor_study.agreement import AXES, REGIONS, STIFFNESSES, Agreement
from softimpact.studio.figures.style import (
    BLACK,
    LIGHT,
    SMALL,
    TEXT,
    legend_below,
    new_figure,
    tidy,
)

from .looks import series

WORDS = {
    "giaf": "GIAF ζ",
    "directional_giaf": "directional GIAF ζₓ",
    "mass_ratio": "mass ratio nᵀΛ⁻¹n / nᵀΛ_F⁻¹n",
    "mass_free": "m_c = 1 / nᵀΛ_F⁻¹n (without rotors)",
    "mass_rigid": "1 / nᵀΛ⁻¹n (with rotors)",
}

SHOWN = (1e3, 1e4, np.inf)
"""Joint stiffnesses of the scatter plots [N·m/rad]."""


def figure_of_agreement(study: FactorStudy) -> Figure:
    """Draw Spearman's ρ of every predictor over joint stiffness, regions by directions."""
    figure = new_figure(12.5, 7.2)
    grid = figure.subplots(len(REGIONS), len(AXES), sharex=True, sharey=True, squeeze=False)
    lines: list[Any] = []
    for axes, agreement in zip(grid.flat, study.agreements, strict=True):
        lines = _correlations(axes, agreement)
        title = f"{agreement.region}, impact along {agreement.axis}"
        axes.set_title(title, fontsize=TEXT)
    for axes in grid[:, 0]:
        axes.set_ylabel("rank correlation ρ [–]", fontsize=TEXT)
    for axes in grid[-1]:
        axes.set_xlabel("joint stiffness k_s [N·m/rad]", fontsize=TEXT)
    poses = len(study.names)
    figure.suptitle(
        f"{study.study.robot.name}: do factors put {poses} poses in the order of their peak "
        "forces? (1: exactly, 0: no better than chance, −1: in reverse)"
    )
    legend_below(figure, lines, columns=3)
    return figure


def _correlations(axes: Any, agreement: Agreement) -> list[Any]:
    places = _places()
    axes.axhline(0, color=BLACK, linewidth=0.8)
    axes.axvline(np.sqrt(places[-1] * places[-2]), color=LIGHT, linewidth=1.0, linestyle=":")
    lines = [
        axes.plot(places, values, label=WORDS[name], **series(k))[0]
        for k, (name, values) in enumerate(agreement.correlation.items())
    ]
    axes.set_xscale("log")
    axes.set_ylim(-1.05, 1.05)
    ticks = [1e2, 1e3, 1e4, 1e5, 1e6]
    words = [f"$10^{{{round(np.log10(k))}}}$" for k in ticks]
    axes.set_xticks([*ticks, places[-1]], [*words, "rigid"])
    axes.minorticks_off()
    tidy(axes)
    return lines


def _places() -> Sequence[float]:
    """Where stiffnesses are drawn; rigid joints follow the stiffest after a gap."""
    last = STIFFNESSES[-2]
    return [*STIFFNESSES[:-1], last * 10**0.7]


def figure_of_agreement_scatter(study: FactorStudy) -> Figure:
    """Draw peak force against GIAF, mass ratio and the masses for the study's own region."""
    problem = study.study
    agreement = _own(study)
    figure = new_figure(12.5, 8.4)
    grid = figure.subplots(len(SHOWN), len(WORDS), sharey="row", sharex="col", squeeze=False)
    for row, stiffness in zip(grid, SHOWN, strict=True):
        k = int(np.argmin([abs(np.log(min(s, 1e9) / min(stiffness, 1e9))) for s in STIFFNESSES]))
        for axes, name in zip(row, WORDS, strict=True):
            axes.scatter(
                agreement.predictors[name],
                agreement.peak_force[:, k],
                s=16,
                color=series(list(WORDS).index(name))["color"],
            )
            correlation = agreement.correlation[name][k]
            axes.set_title(f"ρ = {correlation:+.2f}", fontsize=SMALL)
            tidy(axes)
        words = "rigid" if np.isinf(stiffness) else f"k_s = {stiffness:g} N·m/rad"
        row[0].set_ylabel(f"peak force [N]\n{words}", fontsize=TEXT)
    for axes, name in zip(grid[-1], WORDS, strict=True):
        unit = "[kg]" if name in ("mass_free", "mass_rigid") else "[–]"
        axes.set_xlabel(f"{WORDS[name]} {unit}".replace(" (", "\n("), fontsize=SMALL)
    figure.suptitle(
        f"{problem.robot.name}, {len(study.names)} poses, {agreement.region}, impact along "
        f"{agreement.axis} at {problem.speed:g} m/s"
    )
    return figure


def _own(study: FactorStudy) -> Agreement:
    """The agreement nearest to the study's own impact."""
    problem = study.study

    def score(a: Agreement) -> tuple[bool, float]:
        same = a.region == problem.contact.region.name
        return same, abs(float(np.array(AXES[a.axis]) @ problem.direction))

    return max(study.agreements, key=score)
