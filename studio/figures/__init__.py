# SPDX-License-Identifier: BSD-3-Clause
"""Figures of a design, a file each."""

from __future__ import annotations

from pathlib import Path

from softimpact.studio.design.report import DesignReport

from .forces import figure_of_forces
from .gains import figure_of_gains
from .postures import figure_of_postures
from .ranking import figure_of_ranking
from .springs import figure_of_springs
from .style import save

__all__ = [
    "draw_figures",
    "figure_of_forces",
    "figure_of_gains",
    "figure_of_postures",
    "figure_of_ranking",
    "figure_of_springs",
]


def draw_figures(report: DesignReport, folder: Path) -> list[Path]:
    """Draw a design's figures as PNG files.

    Args:
        report: of a design.
        folder: an existing one; files of the same name are replaced.

    Returns:
        Paths of the files. ``gains.png`` is missing if the design ran in one mode only.
    """
    gains = report.design.gains
    figures = {
        "force_over_time": figure_of_forces(report),
        "ranking": figure_of_ranking(report),
        "postures": figure_of_postures(report),
        "springs": figure_of_springs(report),
        **({} if gains is None else {"gains": figure_of_gains(report, gains)}),
    }
    return [save(figure, folder / f"{name}.png") for name, figure in figures.items()]
