# SPDX-License-Identifier: BSD-3-Clause
"""C99 statements from a graph.

Every statement defines one constant. A value that is read once is written where it is read, as
long as the line stays short; sines and cosines of joint angles come first and are called s1, c1.
The order of operations and every rounding are those of CasADi.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import chain, pairwise
from textwrap import wrap

import casadi as ca

from .graph import Graph, Node
from .operations import Binding, operation

LINE = 100
"""Longest line [columns], indentation included."""

INDENT = "    "


@dataclass(frozen=True)
class Statements:
    """C statements and the names of what they compute.

    Attributes:
        lines: definitions in order.
        results: for each result of the graph, a C expression for each element: a name, or a
            constant.
    """

    lines: tuple[str, ...]
    results: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Call:
    """A C function that computes an input of the graph before it is first read.

    Attributes:
        name: of the function, whose last argument is an array that it fills.
        variable: name of that array.
        size: of it.
        input: number of the input whose elements it holds.
        arguments: numbers of the results that it reads, an array each.
        names: of these arrays, where they have to be made.
        last: further arguments.
    """

    name: str
    variable: str
    size: int
    input: int
    arguments: Sequence[int]
    names: Sequence[str]
    last: Sequence[str] = ()


def print_graph(
    graph: Graph,
    inputs: Sequence[Sequence[str]],
    result_names: Sequence[Sequence[str]],
    prefix: str,
    angles: int | None = None,
    calls: Sequence[Call] = (),
) -> Statements:
    """Print a graph as C99.

    Args:
        graph: what to print.
        inputs: C expression of each element of each input.
        result_names: wanted name of each element of each result.
        prefix: of the macros and of the type, e.g. ``panda`` for ``panda_real``, ``PANDA_SIN``.
        angles: index of the input whose sines and cosines are named after their joint.
        calls: of C functions that compute further inputs, whose arguments are the last results.
    """
    printer = _Printer(graph, inputs, prefix, calls)
    printer.name_sines(angles)
    printer.name_results(result_names)
    return printer.statements()


@dataclass(frozen=True)
class _Text:
    """A C expression that may still be written into another one."""

    text: str
    binding: Binding

    def within(self, least: Binding) -> str:
        """Return the text as an operand of something that binds as tightly as ``least``."""
        bare = self.binding >= least and not (least > Binding.SUM and self.text.startswith("-"))
        return self.text if bare else f"({self.text})"


class _Printer:
    def __init__(
        self, graph: Graph, inputs: Sequence[Sequence[str]], prefix: str, calls: Sequence[Call]
    ) -> None:
        self.graph, self.inputs = graph, inputs
        self.calls = {call.input: call for call in calls}
        self.waiting = dict(self.calls)
        passed = [graph.results[i] for call in calls for i in call.arguments]
        self.shown = graph.results[: len(graph.results) - len(passed)]
        self.passed = Counter(index for result in passed for index in result)
        self.arrays: dict[int, str] = {}
        self.second: list[tuple[int, int]] = []
        self.prefix, self.real, self.macro = prefix, f"{prefix}_real", f"{prefix.upper()}_"
        self.uses = graph.uses()
        self.names: dict[int, str] = {}
        self.texts: dict[int, _Text] = {}
        self.lines: list[str] = []
        self.first: list[int] = []
        self.temporaries = 0
        self.groups = 0

    def name_sines(self, angles: int | None) -> None:
        """Name sines and cosines of a joint's angle, shifted or not, and put them first."""
        found: list[tuple[int, int, int, int]] = []
        for index, node in enumerate(self.graph.nodes):
            if node.operation in (ca.OP_SIN, ca.OP_COS):
                (angle,) = node.operands
                joint = self._joint(angle, angles)
                if joint is not None:
                    found.append((joint, angle, node.operation, index))
        for joint, angle, kind, index in sorted(found):
            others = {other[1] for other in found if other[0] == joint and other[1] < angle}
            suffix = f"_{len(others) + 1}" if others else ""
            self.names[index] = f"{'c' if kind == ca.OP_COS else 's'}{joint + 1}{suffix}"
            self.first.append(index)
        if angles is not None:
            self.second = self._further_pairs()

    def _further_pairs(self) -> list[tuple[int, int]]:
        """Return sines and cosines of other angles, where none of these is made of another."""
        found: dict[int, dict[int, int]] = {}
        for index, node in enumerate(self.graph.nodes):
            if node.operation in (ca.OP_SIN, ca.OP_COS) and index not in self.names:
                found.setdefault(node.operands[0], {})[node.operation] = index
        pairs = [(p[ca.OP_SIN], p[ca.OP_COS]) for p in found.values() if len(p) == 2]
        turns = {index for pair in pairs for index in pair}
        angles = [self.graph.nodes[sine].operands[0] for sine, _ in pairs]
        apart = turns.isdisjoint(self._needed(angles, self._before))
        return pairs if len(pairs) > 1 and apart else []

    def _needed(self, indices: Iterable[int], before: Callable[[int], Iterable[int]]) -> set[int]:
        found: set[int] = set()
        waiting = list(indices)
        while waiting:
            index = waiting.pop()
            if index not in found and index not in self.texts:
                found.add(index)
                waiting += before(index)
        return found

    def _before(self, index: int) -> Iterable[int]:
        """Return the nodes that must be computed before one."""
        node = self.graph.nodes[index]
        call = self._call_of(node)
        return (i for k in call.arguments for i in self.graph.results[k]) if call else node.operands

    def _call_of(self, node: Node) -> Call | None:
        return self.calls.get(node.element[0]) if node.operation == ca.OP_INPUT else None

    def _joint(self, index: int, angles: int | None) -> int | None:
        """Return the joint whose angle a node is, up to a constant."""
        nodes = self.graph.nodes
        parts = [nodes[index], *(nodes[i] for i in nodes[index].operands)]
        elements = [p.element for p in parts if p.operation == ca.OP_INPUT]
        plain = all(p.operation in (ca.OP_INPUT, ca.OP_CONST) for p in parts[1:])
        if not plain or len(elements) != 1 or elements[0][0] != angles:
            return None
        return elements[0][1]

    def name_results(self, result_names: Sequence[Sequence[str]]) -> None:
        """Name what is a result; the first of several equal results gives the name."""
        for result, names in zip(self.shown, result_names, strict=True):
            for index, name in zip(result, names, strict=True):
                if name and self._is_computed(index):
                    self.names.setdefault(index, name)

    def _is_computed(self, index: int) -> bool:
        node = self.graph.nodes[index]
        return node.operation not in (ca.OP_INPUT, ca.OP_CONST) or self._call_of(node) is not None

    def statements(self) -> Statements:
        """Print every node once."""
        self._print_pairs()
        for index in self.first:
            self._print_with_operands([index])
        for index in range(len(self.graph.nodes)):
            self._print(index)
        results = tuple(tuple(self.texts[index].text for index in result) for result in self.shown)
        return Statements(tuple(self.lines), results)

    def _print_pairs(self) -> None:
        """Print the sines and cosines of all angles that need both; one call computes them."""
        nodes = self.graph.nodes
        self._print_turns(
            [
                (sine, cosine)
                for sine, cosine in pairwise(self.first)
                if (nodes[sine].operation, nodes[cosine].operation) == (ca.OP_SIN, ca.OP_COS)
                and nodes[sine].operands == nodes[cosine].operands
            ]
        )

    def _print_turns(self, pairs: Sequence[tuple[int, int]]) -> None:
        if not pairs:
            return
        self.groups += 1
        suffix = f"_{self.groups}" if self.groups > 1 else ""
        angles = self._array(
            f"angles{suffix}", [self.graph.nodes[sine].operands[0] for sine, _ in pairs]
        )
        arrays = [f"{name}{suffix}" for name in ("sines", "cosines")]
        self.lines += [f"{INDENT}{self.real} {name}[{len(pairs)}];" for name in arrays]
        call = f"{self.prefix}_sines_cosines({angles}, {len(pairs)}, {', '.join(arrays)});"
        self.lines.append(f"{INDENT}{call}")
        for k, pair in enumerate(pairs):
            for array, index in zip(arrays, pair, strict=True):
                self.arrays[index] = f"{array}[{k}]"
                self.texts[index] = _Text(self.arrays[index], Binding.ATOM)
                if self.uses[index] > self.passed[index]:
                    self._define(index)

    def _array(self, name: str, indices: Sequence[int]) -> str:
        """Return a C expression of the array of some values: one that they are in, or a new one."""
        self._print_with_operands(indices)
        texts = [self.arrays.get(index, self.texts[index].text) for index in indices]
        array, bracket, place = texts[0].rpartition("[")
        if bracket and place[:-1].isdigit():
            first = int(place[:-1])
            if texts == [f"{array}[{first + k}]" for k in range(len(texts))]:
                return f"&{texts[0]}" if first else array
        values = ", ".join(self.texts[index].text for index in indices)
        line = f"{INDENT}const {self.real} {name}[{len(indices)}] = {{{values}}};"
        self.lines += wrap(line, LINE, subsequent_indent=2 * INDENT)
        return name

    def _make(self, call: Call) -> None:
        """Print a call, once what it reads is there."""
        arrays = [
            self._array(f"{call.variable}_{name}", self.graph.results[i])
            for name, i in zip(call.names, call.arguments, strict=True)
        ]
        self.lines.append(f"{INDENT}{self.real} {call.variable}[{call.size}];")
        arguments = ", ".join([*arrays, *call.last, call.variable])
        self.lines.append(f"{INDENT}{call.name}({arguments});")

    def _print_with_operands(self, indices: Iterable[int]) -> None:
        for index in sorted(self._needed(indices, lambda i: self.graph.nodes[i].operands)):
            self._print(index)

    def _print(self, index: int) -> None:
        if index in self.texts:
            return
        node = self.graph.nodes[index]
        if node.operation == ca.OP_CONST:
            self.texts[index] = self._constant(node.value)
        elif node.operation == ca.OP_INPUT:
            argument, element = node.element
            call = self.waiting.pop(argument, None)
            if call is not None:
                self._make(call)
            self.texts[index] = _Text(self.inputs[argument][element], Binding.ATOM)
            self.arrays[index] = self.texts[index].text
            if index in self.names:
                self._define(index)
        elif index in chain.from_iterable(self.second):
            pairs, self.second = self.second, []
            self._print_turns(pairs)
        else:
            self._print_operation(index)

    def _constant(self, value: float) -> _Text:
        digits = repr(value)
        digits = digits if "." in digits or "e" in digits else f"{digits}.0"
        return _Text(f"{self.macro}R({digits})", Binding.ATOM)

    def _print_operation(self, index: int) -> None:
        node = self.graph.nodes[index]
        known = operation(node.operation)
        if known.repeats:
            self._define(node.operands[0])
        text = self._expression(index)
        while len(self._definition("t0000", text)) > LINE:
            longest = max(node.operands, key=lambda i: len(self.texts[i].text))
            if not self._define(longest):
                break
            text = self._expression(index)
        self.texts[index] = text
        if index in self.names or self.uses[index] > 1:
            self._define(index)

    def _expression(self, index: int) -> _Text:
        node = self.graph.nodes[index]
        known = operation(node.operation)
        operands = [
            self.texts[operand].within(binding)
            for operand, binding in zip(node.operands, known.operands, strict=True)
        ]
        return _Text(known.text.format(*operands, R=self.macro), known.binding)

    def _define(self, index: int) -> bool:
        """Give a value a name of its own; False if it has one or needs none."""
        if not self._is_computed(index) or self.texts[index].text.isidentifier():
            return False
        name = self.names.get(index)
        if name is None:
            self.temporaries += 1
            name = f"t{self.temporaries}"
        self.lines.append(self._definition(name, self.texts[index]))
        self.texts[index] = _Text(name, Binding.ATOM)
        return True

    def _definition(self, name: str, text: _Text) -> str:
        return f"{INDENT}const {self.real} {name} = {text.text};"
