# SPDX-License-Identifier: BSD-3-Clause
"""Robots and studies that come with softimpact.

A robot is one MJCF file beside this one; ``docs/adding-a-robot.md`` is the recipe.
"""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).resolve().parent


def built_in_robots() -> dict[str, Path]:
    """Return the model files of the built-in robots by name."""
    return {path.stem: path for path in sorted(FOLDER.glob("*.xml"))}


def built_in_studies() -> dict[str, Path]:
    """Return the study files of the built-in robots by name."""
    return {path.stem: path for path in sorted(FOLDER.glob("studies/*.toml"))}


def study_path(study: str | Path) -> Path:
    """Return the file of a study by its name, or the path itself."""
    path = Path(study)
    return path if path.is_file() else built_in_studies().get(str(study), path)
