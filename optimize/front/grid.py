# SPDX-License-Identifier: BSD-3-Clause
"""A front's grid of levels, filled from the loosest to the tightest and looked at once more."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import product

from ..robust.exchange import ExchangeState
from ..search.failure import SolverFailure
from .dominance import WORTH
from .ranges import Levels
from .trade import Trade

GridNode = tuple[int, ...]
"""Places of levels, one of each objective that is held; 0 is the tightest."""


@dataclass(eq=False)
class Grid:
    """What was found at each level.

    Attributes:
        found: designs, by the places of their levels.
        beyond: levels that no hardware keeps.
        unsolved: Ipopt's statuses at levels within reach where it failed.
    """

    found: dict[GridNode, ExchangeState] = field(default_factory=dict)
    beyond: set[GridNode] = field(default_factory=set)
    unsolved: dict[GridNode, str] = field(default_factory=dict)


def fill(trade: Trade, levels: Levels) -> Grid:
    """Search at every level.

    Each search begins with what the next looser levels found. Then, from the tightest on, levels
    whose tighter neighbour is better are searched again from there: what keeps the tighter level
    keeps this one, too.
    """
    sizes = [values.size for values in levels.values]
    nodes = sorted(product(*map(range, sizes)), key=lambda node: (-sum(node), node))
    grid, say, total = Grid(dict(levels.known)), trade.setting.say, 2 * len(nodes)
    for done, node in enumerate(nodes):
        say("levels", done, total)
        if node not in grid.found:
            _first_time(trade, levels, grid, node)
    for done, node in enumerate(reversed(nodes)):
        say("levels again", len(nodes) + done, total)
        _again(trade, levels, grid, node)
    say("levels again", total, total)
    return grid


def values_at(levels: Levels, node: GridNode) -> tuple[float, ...]:
    """Return the values at which the objectives are held at a node."""
    return tuple(float(values[i]) for values, i in zip(levels.values, node, strict=True))


def _beside(levels: Levels, node: GridNode, step: int) -> Iterator[GridNode]:
    """Yield the next looser (step 1) or tighter (-1) levels."""
    for k, values in enumerate(levels.values):
        if 0 <= node[k] + step < values.size:
            yield (*node[:k], node[k] + step, *node[k + 1 :])


def _first_time(trade: Trade, levels: Levels, grid: Grid, node: GridNode) -> None:
    looser = list(_beside(levels, node, 1))
    if any(each in grid.beyond for each in looser):
        grid.beyond.add(node)
        return
    values = values_at(levels, node)
    neighbours = [grid.found[each] for each in looser if each in grid.found] or levels.ends
    status = _search(trade, grid, node, values, neighbours)
    if status is None:
        return
    if trade.within_reach(values):
        grid.unsolved[node] = status
    else:
        grid.beyond.add(node)


def _again(trade: Trade, levels: Levels, grid: Grid, node: GridNode) -> None:
    tighter = [grid.found[each] for each in _beside(levels, node, -1) if each in grid.found]
    own = grid.found.get(node)
    if own is not None:
        least = trade.cost(own) - WORTH * abs(trade.cost(own))
        tighter = [state for state in tighter if trade.cost(state) < least]
    if tighter and node not in grid.beyond:
        _search(trade, grid, node, values_at(levels, node), tighter)


def _search(
    trade: Trade,
    grid: Grid,
    node: GridNode,
    values: Sequence[float],
    neighbours: Sequence[ExchangeState],
) -> str | None:
    """Put the better of what is known and what is found now into the grid.

    Returns:
        Ipopt's status if nothing was solved.
    """
    try:
        state = trade.near(values, neighbours)
    except SolverFailure as failure:
        return failure.best.status
    known = grid.found.get(node)
    if known is None or trade.cost(state) < trade.cost(known):
        grid.found[node] = state
    grid.unsolved.pop(node, None)
    return None
