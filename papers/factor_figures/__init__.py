# SPDX-License-Identifier: BSD-3-Clause
"""Figures of a factor study, a file each."""

from __future__ import annotations

from pathlib import Path

from softimpact.papers.factor_study import FactorStudy
from softimpact.studio.figures.style import save

from .agreement import figure_of_agreement, figure_of_agreement_scatter
from .heavy_base import figure_of_heavy_base
from .joints import figure_of_joints
from .polar import figure_of_directions
from .poses import figure_of_poses, figure_of_sweeps
from .postures import figure_of_chosen_postures
from .redundancy import figure_of_redundancy

__all__ = ["draw_factor_figures"]


def draw_factor_figures(study: FactorStudy, folder: Path) -> list[Path]:
    """Draw a factor study's figures as PNG files; return their paths.

    Args:
        study: numbers.
        folder: an existing one; files of the same name are replaced.
    """
    figures = {
        "giaf_of_poses": figure_of_poses(study),
        "single_joint_giaf": figure_of_joints(study),
        "directional_giaf": figure_of_directions(study),
        "postures": figure_of_chosen_postures(study),
        "fixed_base_imf": figure_of_heavy_base(study),
        "rank_correlation": figure_of_agreement(study),
        "giaf_against_force": figure_of_agreement_scatter(study),
    }
    for tip in study.tips:
        figures[f"giaf_sweeps_{tip}"] = figure_of_sweeps(study, tip)
        figures[f"self_motion_{tip}"] = figure_of_redundancy(study, tip)
    return [save(figure, folder / f"{name}.png") for name, figure in figures.items()]
