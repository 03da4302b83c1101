# SPDX-License-Identifier: BSD-3-Clause
"""What the functions of a package share: parts of their graphs that stand in C only once.

Functions are written without a thought of it. A stage is found in a function's graph wherever the
same numbers are computed in the same order, up to their signs, and is called there.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import casadi as ca

from ..expressions.graph import FREE, Graph, Node
from .stage import SharedStage, Use
from .values import ZERO, Value, Values

WORTH_A_CALL = 0.7
"""Share of a stage's operations that a call must save at least; the rest is computed twice."""

LEAST_OPERATIONS = 40
"""Stages that compute less, and a number for each that they pass on, are not worth a function."""


@dataclass(frozen=True, eq=False)
class Split:
    """A function's graph with calls of stages.

    Attributes:
        graph: over the package's inputs and, one further input each, what the calls compute; its
            last results are the calls' arguments, of one call after the other.
        calls: the stages that are called.
    """

    graph: Graph = field(repr=False)
    calls: tuple[SharedStage, ...]


def split_all(
    graphs: Mapping[str, Graph], uses: Mapping[str, Sequence[Use]], values: Values, inputs: int
) -> dict[str, Split]:
    """Return graphs with calls of stages; those that a single call would need are left out.

    Args:
        graphs: by the names of functions, as CasADi has them.
        uses: that may occur in each, those first that others are part of.
        values: that number them.
        inputs: how many inputs the package has.
    """
    left_out: set[str] = set()
    while True:
        kept = {name: [u for u in uses[name] if u.stage.name not in left_out] for name in graphs}
        found = {name: _split(graph, kept[name], values, inputs) for name, graph in graphs.items()}
        count = Counter(stage.name for split in found.values() for stage in split.calls)
        lone = {name for name, calls in count.items() if calls < 2}
        if not lone:
            return found
        left_out |= lone


def _split(graph: Graph, uses: Iterable[Use], values: Values, inputs: int) -> Split:
    found = values.of(graph, {})
    at = {value: index for index, value in reversed(list(enumerate(found)))}
    cut = _Cut(graph, found, at)
    for use in uses:
        cut.consider(use)
    return cut.split(inputs)


@dataclass
class _Cut:
    """A graph from which more and more is taken out."""

    graph: Graph
    values: list[Value]
    at: dict[Value, int]
    calls: list[Use] = field(default_factory=list)
    leaves: dict[int, tuple[int, int]] = field(default_factory=dict)  # (call, place) by node
    left: set[int] = field(init=False)

    def __post_init__(self) -> None:
        self.left = self.needed([], {})

    def needed(self, calls: Sequence[Use], leaves: Mapping[int, object]) -> set[int]:
        """Return the nodes that are left to compute, and the leaves that are read."""
        passed = {use.outputs for use in calls}
        arguments = {v for use in calls for a in use.arguments if a not in passed for v in a}
        waiting = [i for result in self.graph.results for i in result]
        waiting += [self._at(value) for value in arguments if value != ZERO]
        found: set[int] = set()
        while waiting:
            index = waiting.pop()
            if index not in found:
                found.add(index)
                if index not in leaves:
                    waiting += self.graph.nodes[index].operands
        return found

    def consider(self, use: Use) -> None:
        """Take a stage out where that is worth it."""
        places = {
            self.at[signed]: (len(self.calls), k)
            for k, value in enumerate(use.outputs)
            for signed in (-value, value)
            if signed in self.at and self._is_computed(self.at[signed])
        }
        now = self.left - self.leaves.keys()
        places = {i: place for i, place in places.items() if i in now}
        arguments = (value for a in use.arguments for value in a)
        if not places or not all(v == ZERO or {v, -v} & self.at.keys() for v in arguments):
            return
        calls, leaves = [*self.calls, use], {**self.leaves, **places}
        after = self.needed(calls, leaves)
        then = after - leaves.keys()
        saved = self._operations(now) - self._operations(then)
        least = max(WORTH_A_CALL * use.stage.plain.flops, LEAST_OPERATIONS + use.stage.size)
        if saved > least:
            self.calls, self.leaves, self.left = calls, leaves, after

    def _is_computed(self, index: int) -> bool:
        return self.graph.nodes[index].operation not in FREE

    def _at(self, value: Value) -> int:
        """Return the node of a value, or else of minus it."""
        return self.at[value if value in self.at else -value]

    def _operations(self, nodes: Iterable[int]) -> int:
        return sum(self._is_computed(i) for i in nodes)

    def split(self, inputs: int) -> Split:
        """Return what is left, with the calls in the order in which they were taken out."""
        nodes: list[Node] = []
        moved: dict[int, int] = {}
        for index in sorted(self.needed(self.calls, self.leaves)):
            node = self.graph.nodes[index]
            if index in self.leaves:
                call, place = self.leaves[index]
                nodes.append(Node(ca.OP_INPUT, element=(inputs + call, place)))
                if self.calls[call].outputs[place].sign != self.values[index].sign:
                    nodes.append(Node(ca.OP_NEG, (len(nodes) - 1,)))
            else:
                operands = tuple(moved[i] for i in node.operands)
                nodes.append(Node(node.operation, operands, node.value, node.element))
            moved[index] = len(nodes) - 1

        def place_of(value: Value) -> int:
            if value == ZERO:
                nodes.append(Node(ca.OP_CONST))
            elif value in self.at:
                return moved[self.at[value]]
            else:
                nodes.append(Node(ca.OP_NEG, (moved[self.at[-value]],)))
            return len(nodes) - 1

        def places_of(argument: tuple[Value, ...]) -> tuple[int, ...]:
            for call, use in enumerate(self.calls):  # handed on as a whole
                if use.outputs == argument:
                    first = len(nodes)
                    nodes.extend(
                        Node(ca.OP_INPUT, element=(inputs + call, k)) for k in range(len(argument))
                    )
                    return tuple(range(first, len(nodes)))
            return tuple(map(place_of, argument))

        results = [places_of(tuple(self.values[i] for i in r)) for r in self.graph.results]
        results += [places_of(a) for use in self.calls for a in use.arguments]
        stages = tuple(use.stage for use in self.calls)
        return Split(Graph(tuple(nodes), tuple(results)), stages)
