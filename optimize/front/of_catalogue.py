# SPDX-License-Identifier: BSD-3-Clause
"""Fronts whose springs can be bought: each design rounded to a catalogue and repaired."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..robust.catalogue import Bought
from ..robust.robust import with_catalogue
from ..search.failure import Unavailable
from ..study.study import Study
from .grid import Grid, GridNode, values_at
from .ranges import Levels
from .trade import Trade


def within_catalogue(study: Study) -> Study:
    """Return a study whose springs are no softer or stiffer than what can be bought.

    So levels are not sought where no entry reaches. The nominal springs stay within the range.
    """
    if not study.catalogue:
        return study
    least, most = min(study.catalogue), max(study.catalogue)
    lower = np.minimum(np.maximum(study.lower, least), study.nominal)
    upper = np.maximum(np.minimum(study.upper, most), study.nominal)
    return replace(study, lower=lower, upper=upper)


def bought_designs(trade: Trade, levels: Levels, grid: Grid) -> tuple[Grid, dict[GridNode, Bought]]:
    """Return a grid with springs of the catalogue, and what they are, at each level that has some.

    Raises:
        Unavailable: no level has springs that keep it.
    """
    found, choices = {}, {}
    missing: Unavailable | None = None
    for done, (node, state) in enumerate(grid.found.items()):
        trade.setting.say("catalogue", done, len(grid.found))
        try:
            choices[node], found[node] = with_catalogue(trade.at(values_at(levels, node)), state)
        except Unavailable as error:
            missing = error
    if missing is not None and not found:
        raise missing
    return replace(grid, found=found), choices
