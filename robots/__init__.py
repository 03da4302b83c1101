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
