# SPDX-License-Identifier: BSD-3-Clause
"""Figures as people read them."""

from __future__ import annotations

SCALES = {"m": (1e3, "mm"), "1": (1.0, "")}
"""Units that people are not told as they are: lengths are small, a plain number has no unit."""


def figure_in_words(value: float, unit: str, digits: int = 4) -> str:
    """Return a figure with its unit."""
    scale, shown = SCALES.get(unit, (1.0, unit))
    return f"{scale * value:.{digits}g} {shown}".strip()
