# SPDX-License-Identifier: BSD-3-Clause
"""All that is known of a design NLP at one choice of the hardware, its postures held."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic.robot.rigid import Array

from ..impact.impact_program import ImpactProgram
from ..impact.peaks import top_weights, tops
from .ipopt import Nlp
from .nlp import Program
from .rows import by_rows, loaded

LEAST_SQUARE = 1e-12
"""Square of the share of a limit below which a figure counts as this, for the slope of its root."""

SAME_TOP = 6
"""Nodes by which a peak may move from one iterate to the next and still be the same."""


@dataclass(frozen=True, eq=False)
class Held:
    """A design NLP whose postures are held: what is sought is v, the log10 of the hardware.

    Attributes:
        nlp: the NLP.
        postures: K×n [rad].
    """

    nlp: Nlp
    postures: Array

    @property
    def springs(self) -> int:
        """How many of v, the first, are springs."""
        return self.nlp.bounds.springs

    @property
    def decades(self) -> Array:
        """Derivative of v by a step: by the share by which a compliance grows, for springs."""
        found = np.ones(self.nlp.program.variables)
        found[: self.springs] = -1 / np.log(10)
        return found

    def scale_after(self, step: Array) -> Array:
        """Return by what a step from its end counts as more than the same before it."""
        found = np.ones(step.size)
        found[: self.springs] += step[: self.springs]
        return found

    def at(self, v: Array) -> Point:
        """Evaluate forces and bounds."""
        program, instance, K = self.nlp.program, self.nlp.instance, len(self.postures)
        y, by_v = by_rows(loaded(program.hardware), v[None])
        rows, slopes = bound_rows(program, self.postures, np.tile(v, (K, 1)), instance.tasks)
        squares = np.array(program.squares)
        share = np.sqrt(np.maximum(1 + rows[:, squares], LEAST_SQUARE))
        rows[:, squares] = 2 * (share - 1)
        slopes[:, squares] /= share[..., None]
        felt = np.column_stack(
            [
                self.postures[[k for k, _ in instance.shape.impacts]],
                np.tile(y, (len(instance.impacts), 1)),
            ]
        )
        forces = self._forces(felt)
        return Point(
            held=self,
            v=v,
            rows=rows,
            slopes=slopes * self.decades,
            felt=felt,
            by_step=by_v.reshape(v.size, -1).T * self.decades,
            forces=forces,
            tops=tops(forces),
        )

    def _forces(self, felt: Array) -> Array:
        """Return the force of each impact over time, over what counts as one there."""
        program, instance = self.nlp.program, self.nlp.instance
        points = np.array([point for _, point in instance.shape.impacts])
        found = np.empty((len(points), program.impacts[0].nodes))
        for point in np.unique(points):
            at = np.flatnonzero(points == point)
            forces = program.impacts[point]["forces"]
            found[at] = by_rows(forces, felt[at], instance.impacts[at])[0]
        return found / instance.units[:, None]


@dataclass(frozen=True, eq=False)
class Point:
    """An iterate.

    Attributes:
        held: the NLP.
        v: log10 of the hardware's values.
        rows: of the bounds in each posture, at most zero where they are kept, K×R; those of
            squares of shares by the shares, as steep where these are one.
        slopes: their derivatives by a step, K×R×V.
        felt: what each impact feels, a row each.
        by_step: derivative of what is felt of the hardware by a step.
        forces: shares over time, a row for each impact.
        tops: nodes and shares of each impact's peaks.
    """

    held: Held
    v: Array
    rows: Array
    slopes: Array
    felt: Array
    by_step: Array
    forces: Array
    tops: list[tuple[NDArray[np.int64], Array]]
    _known: dict[tuple[int, int], Array] = field(default_factory=dict)

    @cached_property
    def shares(self) -> Array:
        """The largest peak of each impact."""
        return np.array([heights.max() for _, heights in self.tops])

    @cached_property
    def worst(self) -> float:
        """The largest peak of all."""
        return float(self.shares.max())

    @cached_property
    def violation(self) -> float:
        """By how much the bounds are missed."""
        return float(self.rows.max(initial=0.0))

    def heights(self, tops: Sequence[tuple[int, int]]) -> Array:
        """Return the shares of some peaks."""
        found = [self.tops[impact][1][self.tops[impact][0] == node] for impact, node in tops]
        return np.concatenate(found)

    def slopes_of(self, tops: Sequence[tuple[int, int]]) -> Array:
        """Return the derivatives by a step of some peaks' shares, given by impact and node."""
        nlp = self.held.nlp
        impacts, program = nlp.instance.shape.impacts, nlp.program
        asked = [top for top in tops if top not in self._known]
        for point in {impacts[impact][1] for impact, _ in asked}:
            some = [top for top in asked if impacts[top[0]][1] == point]
            for top, slope in zip(some, self._slopes(program.impacts[point], some), strict=True):
                self._known[top] = slope
        return np.array([self._known[top] for top in tops]).reshape(-1, self.v.size)

    def _slopes(self, program: ImpactProgram, tops: Sequence[tuple[int, int]]) -> Array:
        which = [impact for impact, _ in tops]
        weights = np.array([top_weights(self.forces[i], node) for i, node in tops])
        instance, n = self.held.nlp.instance, self.held.nlp.program.n
        by_x = by_rows(program["slope"], self.felt[which], instance.impacts[which], weights)[0]
        by_felt = by_x[:, n : n + len(self.by_step)]
        return np.asarray(by_felt @ self.by_step / instance.units[which][:, None])

    def same_top(self, impact: int, node: int) -> tuple[int, float] | None:
        """Return node and share of the peak that was at some node in another iterate."""
        nodes, heights = self.tops[impact]
        nearest = int(np.argmin(abs(nodes - node)))
        if abs(nodes[nearest] - node) > SAME_TOP:
            return None
        return int(nodes[nearest]), float(heights[nearest])


def bound_rows(program: Program, postures: Array, v: Array, tasks: Array) -> tuple[Array, Array]:
    """Return the rows of the bounds, m×R, and their derivatives by v, m×R×V.

    Args:
        program: the functions.
        postures: m×n [rad].
        v: log10 of the hardware's values, m×V.
        tasks: numbers of each posture's task, m×size.
    """
    bounds = _bounds(program.task, program.held, program.n)
    rows, by_v = by_rows(bounds, np.column_stack([postures, v]), tasks)
    return rows, by_v.reshape(*v.shape, -1).transpose(0, 2, 1)


def values_of_bounds(program: Program, postures: Array, v: Array, tasks: Array) -> Array:
    """Return the rows of the bounds alone, m×R; arguments as ``bound_rows``."""
    bounds = _bounds(program.task, program.held, None)
    return by_rows(bounds, np.column_stack([postures, v]), tasks)[0]


@lru_cache(maxsize=32)
def _bounds(serialised: str, held: int, n: int | None) -> ca.Function:
    """Return (x, b) -> the bounds' rows and, behind n joints, their derivative by v."""
    task = loaded(serialised)
    x, b = task.sx_in()
    rows, by_x = task(x, b)
    found = [rows[held:, :]] if n is None else [rows[held:, :], by_x[held:, n:]]
    return ca.Function("bounds", [x, b], found)
