# SPDX-License-Identifier: BSD-3-Clause
"""What a package's functions share, as the templates show it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from textwrap import wrap

from ..expressions.printer import INDENT, LINE, Statements, print_graph
from ..inputs.parameters import Parameter
from ..sharing.stage import SharedStage
from .function import DIRECTION


@dataclass(frozen=True, eq=False)
class StageSource:
    """What several functions of a package call, in C.

    Attributes:
        prefix: of the package's names.
        parameters: all parameters of the package.
        stage: what it computes.
    """

    prefix: str
    parameters: Sequence[Parameter]
    stage: SharedStage

    @property
    def name(self) -> str:
        """Full name."""
        return f"{self.prefix}_{self.stage.name}"

    @property
    def declaration(self) -> str:
        """Prototype without the semicolon."""
        real = f"{self.prefix}_real"
        arguments = [f"const {real} {a.name}[{len(a.elements)}]" for a in self.stage.arguments]
        arguments += [f"const {self.prefix}_params *p"] * self.stage.reads_parameters
        line = f"void {self.name}({', '.join([*arguments, f'{real} out[{self.stage.size}]'])})"
        return "\n".join(wrap(line, LINE, subsequent_indent=INDENT))

    @cached_property
    def statements(self) -> Statements:
        """The computation."""
        count = len(self.stage.symbols) + 2
        places: list[list[str]] = [[]] * count
        for i, p in enumerate(self.parameters):
            places[DIRECTION + 1 + i] = [f"p->{place}" for place in p.places]
        for a in self.stage.arguments:
            (number,) = {element[0] for element in a.elements}
            read = {element[1]: f"{a.name}[{k}]" for k, element in enumerate(a.elements)}
            places[number] = [read.get(k, "") for k in range(max(read) + 1)]
        names = [[f"x{k + 1}" for k in range(self.stage.size)]]
        return print_graph(self.stage.graph, places, names, self.prefix)
