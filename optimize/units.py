# SPDX-License-Identifier: BSD-3-Clause
"""Figures as people read them."""

from __future__ import annotations

SCALES = {"m": (1e3, "mm"), "1": (1.0, "")}
"""Units that people are not told as they are: lengths are small, a plain number has no unit."""


TWICE = 2.0
"""Ratio from which people understand a factor better than a percentage."""


def ratio_in_words(ratio: float, of: str) -> str:
    """Return how much of something there is, such as "12 % more force" or "3.7 times the force"."""
    if ratio >= TWICE:
        return f"{ratio:.2g} times the {of}"
    return f"{100 * abs(ratio - 1):.0f} % {'less' if ratio < 1 else 'more'} {of}"


def figure_in_words(value: float, unit: str, digits: int = 4) -> str:
    """Return a figure with its unit."""
    scale, shown = SCALES.get(unit, (1.0, unit))
    return f"{scale * value:.{digits}g} {shown}".strip()
