# SPDX-License-Identifier: BSD-3-Clause
"""Colours and marks of what several figures show."""

from __future__ import annotations

from typing import Any

from softimpact.papers.factor_study import FactorStudy
from softimpact.studio.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    VERMILLION,
)

SERIES: tuple[tuple[str, str], ...] = (
    (BLUE, "o"),
    (ORANGE, "s"),
    (GREEN, "^"),
    (VERMILLION, "D"),
    (SKY, "v"),
    (PURPLE, "P"),
    (BLACK, "x"),
)
"""Colour and mark of the first, second, … series; both tell them apart."""


def series(index: int) -> dict[str, Any]:
    """Return the looks of a series by its place."""
    colour, mark = SERIES[index % len(SERIES)]
    return {"color": colour, "marker": mark, "markersize": 4.5, "linewidth": 1.3}


def set_looks(study: FactorStudy, name: str) -> dict[str, Any]:
    """Return the looks of a set of rotors, the same in all figures."""
    return series(list(study.rotor_sets).index(name))


def label_poses(axes: Any, study: FactorStudy) -> None:
    """Name the poses on the horizontal axis."""
    places = range(len(study.names))
    axes.set_xticks(places, study.names, rotation=90)
