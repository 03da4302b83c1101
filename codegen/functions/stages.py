# SPDX-License-Identifier: BSD-3-Clause
"""What functions share: M and J entry by entry, and what the masses do to forces."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import casadi as ca

from softimpact.symbolic import Matrix, contact_mobility
from softimpact.symbolic.matrices import Factorisation, symmetric

from ..expressions.graph import graph_of
from ..inputs.parameters import is_elastic
from ..sharing.stage import SharedStage, Use
from ..sharing.values import Value, Values
from .impact_factors import axes_of_factors
from .symbols import Symbols

Build = Callable[[Matrix, Matrix], Matrix]

Q = 0
"""Place of q among the package's inputs."""


@dataclass(frozen=True, eq=False)
class Stages:
    """The stages of a package.

    Attributes:
        symbols: of the package.
        values: that number what its functions compute.
        mass, jacobian, row: M, J and nᵀJ at q.
        mobility, inverse, answer: J H⁻¹ Jᵀ, j H⁻¹ jᵀ and H⁻¹ jᵀ of a mass matrix H = M + diag b.
    """

    symbols: Symbols
    values: Values
    mass: SharedStage
    jacobian: SharedStage
    row: SharedStage
    mobility: SharedStage
    inverse: SharedStage
    answer: SharedStage

    def uses_at(self, q: Matrix) -> Iterator[Use]:
        """Yield the stages at joint coordinates, those first that others are part of."""
        s, model = self.symbols, self.symbols.model
        jacobians = [model.jacobian(q, axes) for axes in axes_of_factors(s)]
        masses = list(_masses(s, q))
        columns = [q, model.direction_row(q, s.n), *jacobians]
        columns += [part for mass, rotors in masses for part in (_lower(mass), rotors)]
        at_q, row, *others = self._values([ca.vec(ca.densify(ca.SX(x))) for x in columns])
        found, parts = others[: len(jacobians)], others[len(jacobians) :]
        for M, b in zip(parts[::2], parts[1::2], strict=True):
            yield from (self._on(self.mobility, M, b, J) for J in found)
            yield from (self._on(stage, M, b, row) for stage in (self.inverse, self.answer))
        for stage in (self.mass, self.jacobian, self.row):
            yield stage.on(self.values, {Q: at_q})

    def _on(self, stage: SharedStage, *inputs: Sequence[Value]) -> Use:
        first = len(self.symbols.inputs)
        return stage.on(self.values, {first + i: column for i, column in enumerate(inputs)})

    def _values(self, columns: Sequence[Matrix]) -> list[list[Value]]:
        graph = graph_of(self.symbols.inputs, columns)
        found = self.values.of(graph, {})
        return [[found[i] for i in result] for result in graph.results]


def stages_of(s: Symbols) -> Stages:
    """Return the stages of a package."""
    m = s.mass_matrix.shape[0]
    M, b = ca.SX.sym("M", m * (m + 1) // 2), ca.SX.sym("b", m)
    full = _filled(_lower(s.mass_matrix), M)
    H = symmetric(lambda i, j: full[i * (i + 1) // 2 + j] + (b[i] if i == j else 0), m)

    def over(name: str, summary: str, build: Build, like: Matrix) -> SharedStage:
        j = ca.SX.sym("j", like.numel())
        value = build(H, ca.reshape(j, *like.shape))
        return SharedStage(name, summary, (*s.inputs, M, b, j), ("M", "b", "j"), value)

    def at_q(name: str, summary: str, value: Matrix) -> SharedStage:
        return SharedStage(name, summary, s.inputs, (), value)

    row = s.model.direction_row(s.q, s.n)
    return Stages(
        s,
        Values(),
        at_q("mass_entries", "M(q), row by row up to the diagonal.", _lower(s.mass_matrix)),
        at_q("jacobian_entries", "J(q), column by column.", ca.vec(ca.densify(s.jacobian))),
        at_q("row_entries", "n'J(q).", ca.densify(ca.SX(row)).T),
        over("mobility_entries", "J inv(M + diag b) J', row by row up to the diagonal.", _mobility,
             s.jacobian),
        over("inverse_mass", "j inv(M + diag b) j'.", _inverse_mass, row),
        over("pushed_entries", "inv(M + diag b) j', then j inv(M + diag b) j'.", _pushed, row),
    )  # fmt: skip


def _masses(s: Symbols, q: Matrix) -> Iterator[tuple[Matrix, Matrix]]:
    """Yield the mass matrices that functions factorise, and what is added to their diagonals."""
    M, m = s.model.mass_matrix(q), s.mass_matrix.shape[0]
    yield M, ca.SX(m, 1)
    if not s.robot.loops:
        yield M, s.values["rotor_inertia"]
    else:
        yield s.model.rotor_mass_matrix(q), ca.SX(m, 1)
    if s.robot.loops and not is_elastic(s.robot):
        yield s.model.generalised_mass(q).matrix, ca.SX(m, 1)


def _mobility(H: Matrix, J: Matrix) -> Matrix:
    return _lower(contact_mobility(H, J).matrix)


def _pushed(H: Matrix, j: Matrix) -> Matrix:
    return ca.vertcat(Factorisation(H).solve(j.T), _inverse_mass(H, j))


def _inverse_mass(H: Matrix, j: Matrix) -> Matrix:
    factors = Factorisation(H)
    y = factors.halfway(j.T)
    return factors.inner(y, y)


def _lower(matrix: Matrix) -> Matrix:
    """Return a symmetric matrix row by row up to its diagonal."""
    dense = ca.densify(ca.SX(matrix))
    return ca.vertcat(*[dense[i, : i + 1].T for i in range(dense.shape[0])])


def _filled(pattern: Matrix, symbols: Matrix) -> Matrix:
    """Return symbols where a vector is not 0 throughout, and 0 elsewhere."""
    zero = [pattern[i].is_zero() for i in range(pattern.numel())]
    return ca.vertcat(*[ca.SX(0) if zero[i] else symbols[i] for i in range(len(zero))])
