# SPDX-License-Identifier: BSD-3-Clause
"""Small faults that can be put into a source: another sign, bound, operator or number."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

OPERATORS: dict[type[ast.AST], type[Any]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Pow: ast.Mult,
    ast.Lt: ast.GtE,
    ast.GtE: ast.Lt,
    ast.Gt: ast.LtE,
    ast.LtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
    ast.And: ast.Or,
    ast.Or: ast.And,
}
NUMBER = 1.1
"""Factor of a number that is changed: a bound or a constant of physics that is 10 % off."""


@dataclass(frozen=True, order=True)
class Mutant:
    """One fault.

    Attributes:
        line: of the source.
        what: was changed into what.
        node: place in the order of ``ast.walk``.
    """

    line: int
    what: str
    node: int


def mutants(source: str) -> list[Mutant]:
    """Return the faults that can be put into a source."""
    tree = ast.parse(source)
    outside = set(_annotations(tree))
    found = []
    for i, node in enumerate(ast.walk(tree)):
        other = deepcopy(node)
        if node not in outside and _change(other):
            what = f"{ast.unparse(node)} → {ast.unparse(other)}"
            found.append(Mutant(getattr(node, "lineno", 0), what, i))
    return sorted(found)


def mutated(source: str, mutant: Mutant) -> str:
    """Return a source with a fault."""
    tree = ast.parse(source)
    assert _change(list(ast.walk(tree))[mutant.node])
    return ast.unparse(tree)


def _change(node: ast.AST) -> bool:
    """Change a node; return whether there is anything to change."""
    match node:
        case ast.Compare(ops=[operator]) if type(operator) in OPERATORS:
            node.ops = [OPERATORS[type(operator)]()]
        case ast.BinOp() | ast.AugAssign() | ast.BoolOp() if type(node.op) in OPERATORS:
            node.op = OPERATORS[type(node.op)]()
        case ast.UnaryOp(op=ast.USub()):
            node.op = ast.UAdd()
        case ast.Constant(value=float(value)):
            node.value = value * NUMBER if value else 1.0
        case ast.Constant(value=int(value)) if not isinstance(value, bool):
            node.value = value + 1
        case _:
            return False
    return True


def _annotations(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield nodes that do nothing at run time."""
    for node in ast.walk(tree):
        for name in ("annotation", "returns"):
            part = getattr(node, name, None)
            if part is not None:
                yield from ast.walk(part)
