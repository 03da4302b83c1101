# SPDX-License-Identifier: BSD-3-Clause
"""Which numbers of several graphs are the same."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import casadi as ca

from ..expressions.graph import Graph, Node
from ..expressions.operations import operation


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
