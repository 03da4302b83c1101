# SPDX-License-Identifier: BSD-3-Clause
"""C functions as the templates show them: signatures, statements and checks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import casadi as ca

from ..expressions.graph import Graph, Node
from ..expressions.printer import INDENT, Call, Statements, print_graph
from ..functions.description import CFunction, Output
from ..inputs.parameters import SCALARS, Parameter
from ..record.manifest import FunctionRecord
from ..sharing.split import Split

Q, DIRECTION = 0, 1
"""Places of q and of the direction among a function's symbols."""


@dataclass(frozen=True, eq=False)
class CSource:
    """A function of a package in C.

    Attributes:
        prefix: of the package's names.
        joints: number of joints.
        parameters: all parameters of the package.
        function: what it computes.
        record: its cost and accuracy.
        split: its graph with calls of what it shares with others; None if it calls none.
    """

    prefix: str
    joints: int
    parameters: Sequence[Parameter]
    function: CFunction
    record: FunctionRecord
    split: Split | None = None

    @property
    def name(self) -> str:
        """Full name."""
        return f"{self.prefix}_{self.function.name}"

    @property
    def has_struct(self) -> bool:
        """Whether the package has a parameter struct: not if all parameters are frozen."""
        return any(p.frozen is None for p in self.parameters)

    @property
    def struct(self) -> str | None:
        """Type of the struct it writes; None if it has one output."""
        return f"{self.name}_t" if len(self.function.outputs) > 1 else None

    @property
    def inputs(self) -> list[str]:
        """Names of the arguments it reads."""
        function = self.function
        direction, struct = ["n"] * function.direction, ["p"] * bool(function.parameters)
        return ["q", *direction, *(p.name for p in function.scalars), *struct]

    @property
    def pointers(self) -> list[str]:
        """Names of all arguments but scalars."""
        scalars = [p.name for p in self.function.scalars]
        return [*(name for name in self.inputs if name not in scalars), self.output_argument]

    @property
    def checks(self) -> list[str]:
        """Calls that return the status of each number it reads beside q and n."""
        scalars = [self._check(p, p.name) for p in self.function.scalars]
        return [*self.parameter_checks, *scalars]

    @property
    def parameter_checks(self) -> list[str]:
        """The same for parameters only."""
        return [self._check(p, f"p->{p.name}") for p in self.function.parameters]

    def _check(self, p: Parameter, name: str) -> str:
        return f"{self.prefix}_{p.range.check}({'' if p.shape else '&'}{name}, {p.size})"

    @property
    def output_argument(self) -> str:
        """Name of the argument it writes to."""
        return "out" if self.struct else self.function.outputs[0].name

    @property
    def arguments(self) -> list[str]:
        """Declarations of all arguments."""
        kinds = {
            "q": f"const {self.prefix}_real q[{self.joints}]",
            "n": f"const {self.prefix}_real n[3]",
            "p": f"const {self.prefix}_params *p",
            **{p.name: f"{self.prefix}_real {p.name}" for p in self.function.scalars},
        }
        if self.struct:
            written = f"{self.struct} *out"
        else:
            output = self.function.outputs[0]
            star = "" if output.shape else "*"
            written = f"{self.prefix}_real {star}{output.name}{_brackets(output)}"
        return [*(kinds[name] for name in self.inputs), written]

    @property
    def declaration(self) -> str:
        """Prototype without the semicolon, wrapped if it is long."""
        line = f"int {self.name}({', '.join(self.arguments)})"
        if len(line) < 100:
            return line
        return f"int {self.name}(\n    " + ",\n    ".join(self.arguments) + ")"

    def member(self, output: Output) -> str:
        """Declaration of an output as a member of a struct or as a local variable."""
        return f"{self.prefix}_real {output.name}{_brackets(output)}"

    @property
    def places(self) -> list[list[str]]:
        """Where each entry of q, the unit vector, the parameters and the scalars stands."""
        return [
            [f"q[{i}]" for i in range(self.joints)],
            [f"u[{i}]" for i in range(3)],
            *([f"p->{place}" for place in p.places] for p in self.parameters),
            *(p.places for p in SCALARS),
        ]

    angles: ClassVar[int | None] = Q
    """Among them what joints' angles are, whose sines are computed at once."""

    @cached_property
    def statements(self) -> Statements:
        """The computation."""
        names = [
            *(self._locals(output) for output in self.outputs),
            *([f"guard{i + 1}"] for i in range(len(self.function.guards))),
        ]
        if self.split is None:
            return print_graph(self.function.graph, self.places, names, self.prefix, self.angles)
        calls = list(self._calls(len(self.function.symbols), len(names)))
        places = [*self.places, *[[f"{c.variable}[{k}]" for k in range(c.size)] for c in calls]]
        return print_graph(self.split.graph, places, names, self.prefix, self.angles, calls)

    def _calls(self, inputs: int, results: int) -> Iterator[Call]:
        """Yield the calls of stages, whose arguments are the graph's last results."""
        seen: Counter[str] = Counter()
        for k, stage in enumerate(self.split.calls if self.split else ()):
            seen[stage.name] += 1
            again = f"_{seen[stage.name]}" if seen[stage.name] > 1 else ""
            names = [argument.name for argument in stage.arguments]
            yield Call(
                name=f"{self.prefix}_{stage.name}",
                variable=f"{stage.name}{again}",
                size=stage.size,
                input=inputs + k,
                arguments=range(results, results + len(names)),
                names=names,
                last=["p"] * stage.reads_parameters,
            )
            results += len(names)

    @property
    def outputs(self) -> tuple[Output, ...]:
        """What it writes."""
        return self.function.outputs

    def _locals(self, output: Output) -> list[str]:
        """Return the names of an output's entries; empty ones need none."""
        if self._is_handed_on(output):
            return [""] * len(output.places)
        return [self._local(output, place) for place in output.places]

    def _local(self, output: Output, place: tuple[int, ...]) -> str:
        if not place:
            return output.name if self.struct else "result"
        joint = "_" if max(output.shape) > 9 else ""
        return f"{output.name}_{joint.join(str(i + 1) for i in place)}"

    @property
    def guards(self) -> list[tuple[str, str]]:
        """Conditions of a regular configuration, and the status where they do not hold."""
        macro = f"{self.prefix.upper()}_R"
        conditions = []
        for guard, (text,) in zip(self.function.guards, self._guard_texts, strict=True):
            condition = f"{text} > {macro}({guard.low!r})"
            if guard.high is not None:
                condition += f" && {text} < {macro}({guard.high!r})"
            conditions.append((condition, guard.status))
        return conditions

    @property
    def _guard_texts(self) -> tuple[tuple[str, ...], ...]:
        return self.statements.results[len(self.outputs) :]

    @property
    def unchecked(self) -> list[str]:
        """Names of results that may overflow, so that the function must look at them."""
        if self.function.open_ended or _is_bounded(self.function.graph):
            return []
        guarded = {
            text
            for guard, (text,) in zip(self.function.guards, self._guard_texts, strict=True)
            if guard.high is not None
        }
        texts = [text for result in self.statements.results[: len(self.outputs)] for text in result]
        return [
            text for text in dict.fromkeys(texts) if text.isidentifier() and text not in guarded
        ]

    @property
    def sparse_outputs(self) -> list[Output]:
        """Matrices with so many zeros that these are written first, all at once."""
        return [output for output in self.outputs if self._is_sparse(output)]

    @property
    def assignments(self) -> list[str]:
        """Statements that write the outputs, without the zeros of sparse ones."""
        lines = []
        for output, texts in zip(self.outputs, self.statements.results, strict=False):
            target = f"out->{output.name}" if self.struct else output.name
            if self._is_handed_on(output):
                lines += _mirrored(target, texts[0].removesuffix("[0]"), output.shape[0])
                continue
            if not output.shape and not self.struct:
                target = f"*{target}"
            for place, text in zip(output.places, texts, strict=True):
                if self._is_sparse(output) and text == self._zero:
                    continue
                mirrored = {place, place[::-1]} if output.symmetric else {place}
                lines += [f"{target}{_index(at)} = {text};" for at in sorted(mirrored)]
        return lines

    def _is_handed_on(self, output: Output) -> bool:
        """Whether an internal function copies a matrix from what a call computes."""
        if self.split is None or not (output.symmetric and self.function.open_ended):
            return False
        result = self.split.graph.results[self.outputs.index(output)]
        nodes = [self.split.graph.nodes[i] for i in result]
        first = nodes[0].element[0]
        expected = [(first, k) for k in range(len(nodes))]
        called = all(_is_input(node) for node in nodes) and first >= len(self.function.symbols)
        return called and [node.element for node in nodes] == expected

    @property
    def _zero(self) -> str:
        return f"{self.prefix.upper()}_R(0.0)"

    def _is_sparse(self, output: Output) -> bool:
        texts = self.statements.results[self.outputs.index(output)]
        return len(output.shape) == 2 and 2 * texts.count(self._zero) > len(texts)


def _brackets(output: Output) -> str:
    return _index(output.shape)


def _mirrored(target: str, packed: str, size: int) -> list[str]:
    """Return statements that fill a symmetric matrix from its rows up to the diagonal."""
    return [
        f"for (int i = 0; i < {size}; ++i) {{",
        f"{INDENT}for (int j = 0; j <= i; ++j) {{",
        f"{2 * INDENT}{target}[i][j] = {packed}[i*(i + 1)/2 + j];",
        f"{2 * INDENT}{target}[j][i] = {target}[i][j];",
        f"{INDENT}}}",
        "}",
    ]


def _index(place: tuple[int, ...]) -> str:
    return "".join(f"[{i}]" for i in place)


def _is_bounded(graph: Graph) -> bool:
    """Whether sums and products of sines, cosines and the unit vector are all there is."""
    turns = (ca.OP_SIN, ca.OP_COS)
    plain = (ca.OP_ADD, ca.OP_SUB, ca.OP_MUL, ca.OP_SQ, ca.OP_TWICE, ca.OP_NEG, ca.OP_CONST)
    angles = {i for i, node in enumerate(graph.nodes) if _is_input(node) and node.element[0] == Q}
    for node in graph.nodes:
        known = node.operation in (*turns, *plain) or _is_input(node)
        outside = _is_input(node) and node.element[0] > DIRECTION
        unturned = node.operation not in turns and not angles.isdisjoint(node.operands)
        if not known or outside or unturned:
            return False
    return angles.isdisjoint(index for result in graph.results for index in result)


def _is_input(node: Node) -> bool:
    return node.operation == ca.OP_INPUT
