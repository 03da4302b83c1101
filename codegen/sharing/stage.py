# SPDX-License-Identifier: BSD-3-Clause
"""Parts of several functions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import casadi as ca

from softimpact.symbolic import Matrix

from ..expressions.graph import Graph, Node, graph_of
from ..expressions.reciprocals import with_reciprocals
from .values import Value, Values


class Argument(NamedTuple):
    """A vector that a stage reads.

    Attributes:
        name: in C.
        elements: of the stage's inputs, one for each entry.
    """

    name: str
    elements: tuple[tuple[int, int], ...]


@dataclass(frozen=True, eq=False)
class SharedStage:
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

    stage: SharedStage
    arguments: tuple[tuple[Value, ...], ...] = field(repr=False)
    outputs: tuple[Value, ...] = field(repr=False)
