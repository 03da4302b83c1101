# SPDX-License-Identifier: BSD-3-Clause
"""What the functions of a package share: parts of their graphs that stand in C only once.

Functions are written without a thought of it. A stage is found in a function's graph wherever the
same numbers are computed in the same order, up to their signs, and is called there.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import casadi as ca

from softimpact.symbolic import Matrix

from .graph import FREE, Graph, Node, graph_of
from .operations import operation
from .reciprocals import with_reciprocals

WORTH_A_CALL = 0.7
"""Share of a stage's operations that a call must save at least; the rest is computed twice."""

LEAST_OPERATIONS = 40
"""Stages that compute less, and a number for each that they pass on, are not worth a function."""


class Value(NamedTuple):
    """A number that graphs compute, or minus it."""

    number: int
    sign: int = 1

    def times(self, sign: int) -> Value:
        """Return it, or minus it."""
        return self if self == ZERO else Value(self.number, self.sign * sign)

    def __neg__(self) -> Value:
        return self.times(-1)


ZERO = Value(-1)


class Values:
    """Numbers what graphs compute: the same for the same operations on the same inputs."""

    def __init__(self) -> None:
        self._known: dict[tuple[object, ...], int] = {}

    def of(self, graph: Graph, given: Mapping[tuple[int, int], Value]) -> list[Value]:
        """Return the value of each node of a graph.

        Args:
            graph: any.
            given: values of elements of inputs; the others stand for themselves.
        """
        found: list[Value] = []
        for node in graph.nodes:
            known = given.get(node.element) if node.operation == ca.OP_INPUT else None
            found.append(known or self._of(node, [found[i] for i in node.operands]))
        return found

    def _of(self, node: Node, operands: list[Value]) -> Value:
        match node.operation:
            case ca.OP_INPUT:
                return self._numbered("input", *node.element)
            case ca.OP_CONST:
                return self._numbered("constant", node.value) if node.value else ZERO
            case ca.OP_NEG:
                return -operands[0]
            case ca.OP_ADD:
                return self._sum(*operands)
            case ca.OP_SUB:
                return self._sum(operands[0], -operands[1])
            case number:
                return self._result(number, operands)

    def _result(self, number: int, operands: list[Value]) -> Value:
        if ZERO in operands and number in (ca.OP_MUL, ca.OP_SQ):
            return ZERO
        known = operation(number)
        ordered = sorted(operands) if known.commutes else operands
        if known.parity is None:
            return self._numbered(number, *ordered)
        value = self._numbered(number, *(x.number for x in ordered))
        odd = known.parity == "odd" and sum(x.sign < 0 for x in ordered) % 2 == 1
        return -value if odd else value

    def _sum(self, a: Value, b: Value) -> Value:
        if ZERO in (a, b):
            return b if a == ZERO else a
        first, second = sorted((a, b))
        value = self._numbered(ca.OP_ADD, first.number, second.number, first.sign * second.sign)
        return value.times(first.sign)

    def _numbered(self, *key: object) -> Value:
        return Value(self._known.setdefault(key, len(self._known)))


class Argument(NamedTuple):
    """A vector that a stage reads.

    Attributes:
        name: in C.
        elements: of the stage's inputs, one for each entry.
    """

    name: str
    elements: tuple[tuple[int, int], ...]


@dataclass(frozen=True, eq=False)
class Stage:
    """A part of several functions.

    Attributes:
        name: without the package's prefix.
        summary: one line.
        symbols: of all inputs of the package, then its own.
        names: of its own inputs, in C.
        value: what it computes, over the symbols.
    """

    name: str
    summary: str
    symbols: tuple[Matrix, ...] = field(repr=False)
    names: tuple[str, ...]
    value: Matrix = field(repr=False)

    @cached_property
    def plain(self) -> Graph:
        """Its graph as functions hold it, with sines and cosines."""
        return graph_of(self.symbols, [self.value])

    @cached_property
    def graph(self) -> Graph:
        """The same over sines and cosines, two further inputs."""
        nodes = [
            Node(ca.OP_INPUT, element=self._turns[i]) if i in self._turns else node
            for i, node in enumerate(self.plain.nodes)
        ]
        return with_reciprocals(Graph(tuple(nodes), self.plain.results).only([0]))

    @cached_property
    def _turns(self) -> dict[int, tuple[int, int]]:
        """Sines and cosines among the nodes, by their element of the further inputs."""
        found: dict[int, tuple[int, int]] = {}
        for kind, operation_ in enumerate((ca.OP_SIN, ca.OP_COS)):
            nodes = [i for i, node in enumerate(self.plain.nodes) if node.operation == operation_]
            nodes.sort(key=self._joint)
            found |= {i: (len(self.symbols) + kind, k) for k, i in enumerate(nodes)}
        return found

    def _joint(self, index: int) -> tuple[int, int]:
        """Return the first input element of a node, so that joints come in order."""
        waiting, read = [index], []
        while waiting:
            node = self.plain.nodes[waiting.pop()]
            waiting += node.operands
            read += [node.element[1]] * (node.operation == ca.OP_INPUT)
        return min(read), index

    @cached_property
    def arguments(self) -> tuple[Argument, ...]:
        """The vectors that it reads."""
        read = sorted({n.element for n in self.graph.nodes if n.operation == ca.OP_INPUT})
        first = len(self.symbols) - len(self.names)
        names = ["q", "n", *[""] * (first - 2), *self.names, "s", "c"]
        return tuple(
            Argument(name, tuple(element for element in read if element[0] == i))
            for i, name in enumerate(names)
            if name and any(element[0] == i for element in read)
        )

    @cached_property
    def reads_parameters(self) -> bool:
        """Whether it reads the parameter struct."""
        own = {0, 1, *range(len(self.symbols) - len(self.names), len(self.symbols) + 2)}
        return any(n.operation == ca.OP_INPUT and n.element[0] not in own for n in self.graph.nodes)

    @property
    def size(self) -> int:
        """Number of values that it passes on."""
        return len(self.plain.results[0])

    def on(self, values: Values, inputs: Mapping[int, Sequence[Value]]) -> Use:
        """Return a use of it.

        Args:
            values: of the package.
            inputs: values of those inputs that do not stand for themselves.
        """
        given = {(i, k): value for i, column in inputs.items() for k, value in enumerate(column)}
        found = values.of(self.plain, given)
        turns = {element: found[i] for i, element in self._turns.items()}
        elements = {
            n.element: found[i]
            for i, n in enumerate(self.plain.nodes)
            if n.operation == ca.OP_INPUT
        } | turns
        arguments = tuple(tuple(elements[e] for e in a.elements) for a in self.arguments)
        return Use(self, arguments, tuple(found[i] for i in self.plain.results[0]))


@dataclass(frozen=True, eq=False)
class Use:
    """A stage at some inputs.

    Attributes:
        stage: which.
        arguments: values of what it reads.
        outputs: values of what it computes.
    """

    stage: Stage
    arguments: tuple[tuple[Value, ...], ...] = field(repr=False)
    outputs: tuple[Value, ...] = field(repr=False)


@dataclass(frozen=True, eq=False)
class Split:
    """A function's graph with calls of stages.

    Attributes:
        graph: over the package's inputs and, one further input each, what the calls compute; its
            last results are the calls' arguments, of one call after the other.
        calls: the stages that are called.
    """

    graph: Graph = field(repr=False)
    calls: tuple[Stage, ...]


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
    cut.left = cut.needed([], {})
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
    left: set[int] = field(default_factory=set)

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
        places = {
            i: place for i, place in places.items() if i in self.left and i not in self.leaves
        }
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
