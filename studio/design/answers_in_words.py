# SPDX-License-Identifier: BSD-3-Clause
"""Which numbers of a design matter, and what its bounds cost, in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from softimpact.optimize import Study
from softimpact.optimize.answers import Price, by_name
from softimpact.optimize.units import figure_in_words
from softimpact.symbolic.robot.rigid import Array


def answers_in_words(study: Study, ranges: Array, prices: Sequence[Price]) -> Iterator[str]:
    """Yield the ranges of values that cost less than 0.5 %, and the prices, a line each.

    Args:
        study: that was solved.
        ranges: of each value of the hardware.
        prices: of bounds.
    """
    joints, named = study.spring_names, by_name(study, ranges)
    sought = [joints[i] for i in np.flatnonzero(study.lower < study.upper)]
    springs = ", ".join(f"{name} {named[name][0]:.0f}–{named[name][1]:.0f}" for name in sought)
    if springs:
        yield f"costs less than 0.5 %, one at a time: {springs} N·m/rad"
    units = dict(zip(study.range.names, study.units, strict=True))
    others = [
        f"{name} {low:.4g}–{figure_in_words(high, units[name])}"
        for name, (low, high) in named.items()
        if name not in joints
    ]
    if others:
        words = "the same of the rest" if springs else "costs less than 0.5 %, one at a time"
        yield f"{words}: {', '.join(others)}"
    for price in prices:
        yield f"{price.bound}: {price.room} buys {price.gain:.2g} {price.unit}"
