# SPDX-License-Identifier: BSD-3-Clause
"""A C function by what it reads and computes."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import casadi as ca
import numpy as np

from softimpact.symbolic import Matrix

from ..expressions.graph import Graph, graph_of
from ..expressions.reciprocals import with_reciprocals
from ..inputs.parameters import Parameter


@dataclass(frozen=True, eq=False)
class Output:
    """What a C function writes.

    Attributes:
        name: of the struct's field or of the argument.
        value: SX, a scalar, a column or a matrix.
        unit: of its entries.
        meaning: in words.
        symmetric: whether a square matrix is.
        scale: what its errors are stated over: a number or an SX; None is its largest entry.
    """

    name: str
    value: Matrix
    unit: str
    meaning: str
    symmetric: bool = False
    scale: Matrix | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape as a C array; () for a scalar."""
        rows, columns = self.value.shape
        if rows == columns == 1:
            return ()
        return (rows * columns,) if 1 in (rows, columns) else (rows, columns)

    @property
    def places(self) -> list[tuple[int, ...]]:
        """Return the C indices of the entries that are compared: one of two that are equal."""
        return [
            place
            for place in np.ndindex(self.shape)
            if not self.symmetric or place == tuple(sorted(place, reverse=True))
        ]

    def entry(self, place: tuple[int, ...]) -> Matrix:
        """Return the expression at C indices."""
        if len(place) == 2:
            return self.value[place[0], place[1]]
        return self.value[place[0] if place else 0]


@dataclass(frozen=True, eq=False)
class Guard:
    """A number that must lie between two bounds, or else the configuration has another status."""

    value: Matrix
    low: float
    high: float | None = None
    status: str = "SINGULAR"


@dataclass(frozen=True, eq=False)
class CFunction:
    """A function of the package.

    Attributes:
        name: without the package's prefix.
        summary: one line for the header.
        outputs: one is an argument of its own, several share a struct.
        symbols: of all inputs of the package: q, n, the parameters, the scalars.
        direction: whether it takes the direction of impact n.
        parameters: fields of the parameter struct that it reads.
        scalars: that it takes.
        guards: what tells singular and open configurations apart.
        open_ended: whether some results may not be finite, which its callers look at.
        divides: whether divisions stay divisions; for results that cannot afford the rounding of
            a reciprocal.
        elsewhere: joint coordinates other than q at which it needs what others need at q.
    """

    name: str
    summary: str
    outputs: tuple[Output, ...]
    symbols: tuple[Matrix, ...] = field(repr=False)
    direction: bool = False
    parameters: tuple[Parameter, ...] = ()
    scalars: tuple[Parameter, ...] = ()
    guards: tuple[Guard, ...] = ()
    open_ended: bool = False
    divides: bool = False
    elsewhere: tuple[Matrix, ...] = field(default=(), repr=False)

    @cached_property
    def graph(self) -> Graph:
        """The outputs' compared entries, then the guards."""
        return self.with_reciprocals(self.plain)

    def with_reciprocals(self, graph: Graph) -> Graph:
        """Return a graph of the function with reciprocals, if it can afford them."""
        return graph if self.divides else with_reciprocals(graph)

    @cached_property
    def plain(self) -> Graph:
        """The same with all divisions that CasADi has."""
        values = [ca.vertcat(*[o.entry(place) for place in o.places]) for o in self.outputs]
        guards = [guard.value for guard in self.guards]
        return graph_of(self.symbols, [*values, *guards])

    @cached_property
    def scales(self) -> Graph:
        """What errors are stated over, of each output that has a scale of its own."""
        own = [ca.SX(o.scale) for o in self.outputs if o.scale is not None]
        return graph_of(self.symbols, own) if own else Graph((), ())

    @cached_property
    def flops(self) -> int:
        """Operations for the outputs; checks, sines and cosines do not count."""
        return self.graph.only(range(len(self.outputs))).flops

    @property
    def sines_and_cosines(self) -> int:
        """How many sines and cosines it takes."""
        return self.graph.count(ca.OP_SIN, ca.OP_COS)
