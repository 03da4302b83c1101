# SPDX-License-Identifier: BSD-3-Clause
"""CasADi's scalar expressions as a plain list of operations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from softimpact.symbolic import Matrix

from .operations import operation

CONSTANT_DIGITS = 15
"""Significant digits of printed constants: the last bits of what a robot's numbers were computed
to may differ between machines, and 15 digits leave them out of the package's bytes."""

FREE = frozenset({ca.OP_CONST, ca.OP_INPUT, ca.OP_SIN, ca.OP_COS})
"""Operations that do not count as flops."""


@dataclass(frozen=True)
class Node:
    """An operation on earlier nodes, a constant, or an element of an input.

    Attributes:
        operation: CasADi's number.
        operands: indices of earlier nodes.
        value: of a constant, never negative.
        element: argument and index in it, of an input.
    """

    operation: int
    operands: tuple[int, ...] = ()
    value: float = 0.0
    element: tuple[int, int] = (0, 0)


@dataclass(frozen=True)
class Graph:
    """Expressions as nodes in an order in which they can be computed; no node twice.

    Attributes:
        nodes: operands before what uses them.
        results: for each expression, the nodes of its elements, column by column.
    """

    nodes: tuple[Node, ...]
    results: tuple[tuple[int, ...], ...]

    @property
    def flops(self) -> int:
        """Number of operations; sines, cosines and the reading of inputs do not count."""
        return sum(node.operation not in FREE for node in self.nodes)

    def count(self, *operations: int) -> int:
        """Return how many nodes are one of some operations."""
        return sum(node.operation in operations for node in self.nodes)

    def uses(self) -> list[int]:
        """Return how often each node is read."""
        count = [0] * len(self.nodes)
        for node in self.nodes:
            for operand in node.operands:
                count[operand] += 1
        for result in self.results:
            for index in result:
                count[index] += 1
        return count

    @cached_property
    def computations(self) -> frozenset[int]:
        """CasADi's numbers of all operations that compute something."""
        return frozenset(node.operation for node in self.nodes) - {ca.OP_CONST, ca.OP_INPUT}

    @cached_property
    def last_uses(self) -> list[int]:
        """Return which node reads each node last; of results, one beyond the last."""
        last = [-1] * len(self.nodes)
        for index, node in enumerate(self.nodes):
            for operand in node.operands:
                last[operand] = index
        for result in self.results:
            for index in result:
                last[index] = len(self.nodes)
        return last

    def only(self, results: Sequence[int]) -> Graph:
        """Return the graph of some of the results, without nodes that none of them needs."""
        kept = tuple(self.results[i] for i in results)
        needed = {index for result in kept for index in result}
        for index in reversed(range(len(self.nodes))):
            if index in needed:
                needed.update(self.nodes[index].operands)
        order = {old: new for new, old in enumerate(sorted(needed))}
        nodes = []
        for old in order:
            node = self.nodes[old]
            moved = tuple(order[i] for i in node.operands)
            nodes.append(Node(node.operation, moved, node.value, node.element))
        return Graph(tuple(nodes), tuple(tuple(order[i] for i in result) for result in kept))


def graph_of(inputs: Sequence[Matrix], expressions: Sequence[Matrix]) -> Graph:
    """Return the graph of expressions over SX inputs; it rounds as CasADi does.

    Args:
        inputs: vectors of symbols.
        expressions: SX or DM, dense or sparse; structural zeros become the constant 0.

    Raises:
        UnsupportedOperation: an expression holds an operation that the generator does not know.
    """
    dense = [ca.densify(ca.SX(expression)) for expression in expressions]
    function = ca.Function("graph", list(inputs), ca.cse(dense))
    builder = _GraphBuilder([expression.numel() for expression in dense])
    for k in range(function.n_instructions()):
        builder.add(function, k)
    return Graph(tuple(builder.nodes), tuple(map(tuple, builder.results))).only(range(len(dense)))


@dataclass(frozen=True)
class _Signed:
    """A node, or minus it."""

    index: int
    negative: bool = False

    def __neg__(self) -> _Signed:
        return _Signed(self.index, not self.negative)


class _GraphBuilder:
    """Replays a function's instructions, whose registers are reused, into nodes.

    Signs travel with the values instead of being computed, so that values that differ only in
    sign are computed once. No result changes by a bit, as rounding is symmetric.
    """

    def __init__(self, sizes: Sequence[int]) -> None:
        self.nodes: list[Node] = []
        self.known: dict[Node, int] = {}
        self.registers: dict[int, _Signed] = {}
        self.results = [[-1] * size for size in sizes]

    def add(self, function: ca.Function, k: int) -> None:
        """Add the k-th instruction of a function."""
        number = function.instruction_id(k)
        reads, writes = function.instruction_input(k), function.instruction_output(k)
        if number == ca.OP_OUTPUT:
            self.results[writes[0]][writes[1]] = self._plain(self.registers[reads[0]])
        elif number == ca.OP_INPUT:
            self.registers[writes[0]] = self._node(Node(number, element=(reads[0], reads[1])))
        elif number == ca.OP_CONST:
            self.registers[writes[0]] = self._constant(function.instruction_constant(k))
        else:
            operands = [self.registers[r] for r in reads[: operation(number).arity]]
            self.registers[writes[0]] = self._operation(number, operands)

    def _constant(self, value: float) -> _Signed:
        rounded = float(f"{abs(value):.{CONSTANT_DIGITS}g}")
        constant = self._node(Node(ca.OP_CONST, value=rounded))
        return -constant if value < 0 else constant

    def _operation(self, number: int, operands: list[_Signed]) -> _Signed:
        if number == ca.OP_NEG:
            return -operands[0]
        if number == ca.OP_ADD:
            return self._sum(operands[0], operands[1])
        if number == ca.OP_SUB:
            return self._sum(operands[0], -operands[1])
        parity = operation(number).parity
        if parity is None:
            return self._node(Node(number, tuple(self._plain(operand) for operand in operands)))
        value = self._node(Node(number, tuple(operand.index for operand in operands)))
        odd = parity == "odd" and sum(operand.negative for operand in operands) % 2 == 1
        return -value if odd else value

    def _sum(self, a: _Signed, b: _Signed) -> _Signed:
        if a.negative == b.negative:
            total = self._node(Node(ca.OP_ADD, (a.index, b.index)))
            return -total if a.negative else total
        if a.negative:
            a, b = b, a
        if Node(ca.OP_SUB, (b.index, a.index)) in self.known:
            return -self._node(Node(ca.OP_SUB, (b.index, a.index)))
        return self._node(Node(ca.OP_SUB, (a.index, b.index)))

    def _plain(self, signed: _Signed) -> int:
        """Return a node of its own for minus a value."""
        if not signed.negative:
            return signed.index
        node = self.nodes[signed.index]
        if node.operation == ca.OP_SUB:
            return self._node(Node(ca.OP_SUB, node.operands[::-1])).index
        return self._node(Node(ca.OP_NEG, (signed.index,))).index

    def _node(self, node: Node) -> _Signed:
        key = node
        if len(node.operands) == 2 and operation(node.operation).commutes:
            key = Node(node.operation, tuple(sorted(node.operands)))
        if key not in self.known:
            self.known[key] = len(self.nodes)
            self.nodes.append(node)
        return _Signed(self.known[key])
