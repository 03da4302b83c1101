# SPDX-License-Identifier: BSD-3-Clause
"""Sequential quadratic programming on the largest of many peaks, the postures held.

Where few numbers are sought and the worst of some impacts is made small, most peaks are far below
the worst: each step asks for the derivatives of those alone that are near it, and for as many peaks
of an impact as are. Steps are held within a region of trust. Madsen (1975) and Fletcher (1987,
section 14.3) have the method.

A step is the share by which each spring's compliance grows, since deflections are linear in these,
and forces nearly; of other values, it is the change of the logarithm.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from softimpact.symbolic.robot.rigid import Array

from ..objectives import Objective, WorstForce
from ..solver_options import FEASIBLE
from .ipopt import Begin, Found, Nlp, VariableBounds
from .minimax_point import Held, Point
from .nlp import peak_rows
from .rows import by_rows

STEPS = 100
"""Most steps."""

NEAR = 0.95
"""Share of the worst peak from which on the derivatives of another are asked for."""

CURVATURE = 0.01
"""Of the Lagrangian, a share of the force over a square decade, where nothing is known yet."""

TRUST = 0.3
"""First radius within which the model is trusted, in decades; steps are at most one decade."""

LONGEST = 1.0
"""Largest radius [decades]."""

LEAST, POOR, GOOD = 1e-4, 0.25, 0.75
"""Shares of what a step promised: to be taken at all, to be trusted no less, to be trusted more."""

HIGHEST_PENALTY = 1e4
"""Of the share by which a bound is missed, where one share of the force costs one."""

SMALLEST = 1e-7
"""Radius below which nothing is gained any more."""

GAIN = 1e-7
"""Share of the force below which what a step promises is not worth it."""

STATIONARY = 2e-4
"""Slope of the Lagrangian, a share of the force over a decade, that counts as none."""

FRESH = 2
"""How often the curvature is forgotten where it promises nothing but the slope is not zero."""

LOOKED, PROMISES = 3, 10
"""Steps after which a search is given up that would not come to what it must reach if each step
promised as much as the last, so often."""

GIVEN_UP = "Given_Up"
"""Status of a search that would not have come to what it had to reach."""

PLAIN = 1e-4
"""Curvature of the two variables that have none, so that the quadratic program is strictly convex:
for steps of a hundredth of the force it adds a ten-millionth."""

BLOCK = 32
"""Rows of a quadratic program come in multiples, so that few solvers are made."""


@dataclass(frozen=True)
class Effort:
    """How far a search goes.

    Attributes:
        gain: share of the force below which what a step promises is not worth it.
        reach: cost that must be in reach, else the search is given up.
    """

    gain: float = GAIN
    reach: float = np.inf


WHOLE, ROUGH = Effort(), Effort(gain=2e-5)
"""To the end; and as far as it takes to tell one optimum from another."""


@dataclass(frozen=True, eq=False)
class _Model:
    """What a step is taken from: rows·[step, F, t] ≤ room, by which peak or bound.

    Attributes:
        rows: derivatives by the step, less one for F (peaks) or t (bounds).
        room: to the linear model's limit.
        of: of each row, (impact, node) of a peak, or (posture, row) of a bound.
        peaks: number of rows that are peaks; they come first.
    """

    rows: Array
    room: Array
    of: list[tuple[int, int]]
    peaks: int


@dataclass(frozen=True, eq=False)
class _Step:
    """The solution of a quadratic program.

    Attributes:
        step: shares of compliances, and changes of other logarithms.
        level: of the worst peak, relative to where it is.
        missed: by how much the bounds are missed in the model.
        prices: multipliers of the rows.
        range_prices: of the limits of v.
    """

    step: Array
    level: float
    missed: float
    prices: Array
    range_prices: Array


@dataclass(frozen=True, eq=False)
class _Search:
    """Where a search stands.

    Attributes:
        held: the NLP.
        at: the best iterate.
        curvature: of the Lagrangian by steps from there, V×V.
        trust: radius within which the model is trusted, in decades.
        penalty: on the share by which bounds are missed.
        asked: peaks whose derivatives are wanted although they are not near the worst.
    """

    held: Held
    at: Point
    curvature: Array
    trust: float
    penalty: float = 1.0
    asked: frozenset[tuple[int, int]] = frozenset()

    @property
    def bounds(self) -> VariableBounds:
        """Limits of v."""
        return self.held.nlp.bounds

    def merit(self, point: Point) -> float:
        """Return what is made small: the worst share, and the penalty on bounds that are missed."""
        return point.worst + self.penalty * point.violation

    def promised(self, step: _Step) -> float:
        """Return by how much a step lowers the merit in the model."""
        bent = float(step.step @ self.curvature @ step.step) / 2
        return self.merit(self.at) - (
            self.at.worst + step.level + bent + self.penalty * step.missed
        )

    def after(self, step: _Step) -> Point:
        """Evaluate the end of a step."""
        change, springs = step.step.copy(), self.held.springs
        change[:springs] = -np.log10(1 + change[:springs])
        return self.held.at(np.clip(self.at.v + change, self.bounds.lower, self.bounds.upper))

    def step_of(self, change: Array) -> Array:
        """Return the step that changes v by this much."""
        step, springs = change.copy(), self.held.springs
        step[:springs] = 10 ** -change[:springs] - 1
        return step

    def forgotten(self) -> _Search:
        """Return the same with nothing known of the curvature."""
        curvature = np.diag(CURVATURE * self.held.decades**2)
        return replace(self, curvature=curvature, trust=TRUST)

    def moved(self, tried: Point) -> _Search:
        """Return the search at another iterate, from which steps are counted then."""
        scale = self.held.scale_after(self.step_of(tried.v - self.at.v))
        curvature = self.curvature * np.outer(scale, scale)
        return replace(self, at=tried, curvature=curvature, asked=frozenset())


def serves(objective: Objective, *, free: bool) -> bool:
    """Return whether ``least_worst`` makes an objective small: it holds postures."""
    return not free and objective.kind == WorstForce.kind


def least_worst(nlp: Nlp, begin: Begin, effort: Effort = WHOLE) -> Found:
    """Make the largest of all shares small over the hardware, the postures held."""
    bounds = nlp.bounds
    held = Held(nlp, np.clip(begin.postures, bounds.q_lower, bounds.q_upper))
    at = held.at(bounds.vector(begin.springs, begin.others))
    search = _Search(held, at, np.empty(0), TRUST).forgotten()
    status, fresh, steps = "Maximum_Iterations_Exceeded", 0, 0
    while steps < STEPS:
        model = _model(search)
        search, step = _bounded(search, model)
        promised, merit = search.promised(step), search.merit(search.at)
        if steps >= LOOKED and merit - PROMISES * promised > effort.reach:
            status = GIVEN_UP
            break
        kept = search.at.violation <= FEASIBLE
        if promised <= (effort.gain if kept else GAIN) * max(1.0, merit):
            slope = abs(search.curvature @ step.step / held.decades).max(initial=0.0)
            if slope <= STATIONARY or fresh == FRESH or effort.gain > GAIN:
                status = "Solve_Succeeded"
                break
            search, fresh = search.forgotten(), fresh + 1
            continue
        search, steps = _advanced(search, model, step), steps + 1
        if search.trust < SMALLEST:
            status = "Search_Direction_Becomes_Too_Small"
            break
    return _found(search, model, step, steps, status)


def _bounded(search: _Search, model: _Model) -> tuple[_Search, _Step]:
    """Return the next step; bounds that it could keep at a higher penalty raise that."""
    step = _solved(search, model, model.room)
    while step.missed > FEASIBLE and search.penalty < HIGHEST_PENALTY:
        dearer = replace(search, penalty=10 * search.penalty)
        nearer = _solved(dearer, model, model.room)
        if nearer.missed > 0.9 * step.missed:
            break
        search, step = dearer, nearer
    return search, step


def _advanced(search: _Search, model: _Model, step: _Step) -> _Search:
    """Take a step, or trust the model less."""
    promised, merit = search.promised(step), search.merit(search.at)
    tried = search.after(step)
    kept = (merit - search.merit(tried)) / promised
    if kept < POOR:  # bend the step to what peaks and bounds are at its end
        other = search.after(_solved(search, model, _room_at(search, model, step, tried)))
        if search.merit(other) < search.merit(tried):
            tried, kept = other, (merit - search.merit(other)) / promised
    search = replace(search, curvature=_curved(search, model, step, tried))
    length, trust = float(abs(tried.v - search.at.v).max()), search.trust
    if kept <= LEAST:
        asked = search.asked | _unasked(search, model, tried)
        return replace(search, asked=asked, trust=0.4 * length)
    if kept > GOOD and length > 0.8 * trust:
        trust = min(2 * trust, LONGEST)
    elif kept < POOR:
        trust = 0.5 * length
    return replace(search.moved(tried), trust=trust)


def _model(search: _Search) -> _Model:
    """Return the linear model of all peaks near the worst and of all bounds within reach."""
    at, asked = search.at, search.asked
    V, worst = at.v.size, at.worst
    of = [
        (impact, int(node))
        for impact, (nodes, heights) in enumerate(at.tops)
        for node, height in zip(nodes, heights, strict=True)
        if height >= NEAR * worst or (impact, int(node)) in asked
    ]
    peaks = len(of)
    reached = np.argwhere(at.rows + search.trust * abs(at.slopes).sum(axis=2) > 0)
    rows = np.zeros((peaks + len(reached), V + 2))
    rows[:peaks, :V], rows[:peaks, V] = at.slopes_of(of), -1.0
    rows[peaks:, :V], rows[peaks:, V + 1] = at.slopes[tuple(reached.T)], -1.0
    room = np.concatenate([worst - at.heights(of), -at.rows[tuple(reached.T)]])
    of += [(int(posture), int(row)) for posture, row in reached]
    return _Model(rows, room, of, peaks)


def _solved(search: _Search, model: _Model, room: Array) -> _Step:
    """Solve the quadratic program of a model with some room for its rows."""
    v, bounds, trust = search.at.v, search.bounds, search.trust
    V, count = v.size, len(room)
    rows = -(-count // BLOCK) * BLOCK
    a, upper = np.zeros((rows, V + 2)), np.full(rows, np.inf)
    a[:count], upper[:count], lower = model.rows, room, np.full(rows, -np.inf)
    curvature = np.diag(np.full(V + 2, PLAIN))
    curvature[:V, :V] = search.curvature
    least, most, gradient = np.full(V + 2, -np.inf), np.full(V + 2, np.inf), np.zeros(V + 2)
    down, up = np.maximum(bounds.lower - v, -trust), np.minimum(bounds.upper - v, trust)
    ends = search.step_of(down), search.step_of(up)
    least[:V], most[:V], least[-1] = np.minimum(*ends), np.maximum(*ends), 0.0
    gradient[V:] = 1.0, search.penalty
    of_problem = (curvature.T.ravel(), gradient, a.T.ravel(), lower, upper, least, most)
    solver = _quadratic(V + 2, rows)
    x, _, multipliers, ranges = (
        each[0] for each in by_rows(solver, *(each[None] for each in of_problem))
    )
    return _Step(x[:V], float(x[V]), max(float(x[V + 1]), 0.0), multipliers[:count], ranges[:V])


@lru_cache(maxsize=64)
def _quadratic(variables: int, rows: int) -> ca.Function:
    shapes = {"h": ca.Sparsity.dense(variables, variables), "a": ca.Sparsity.dense(rows, variables)}
    options: dict[str, Any] = {
        "error_on_fail": False,
        "daqp": {"primal_tol": 1e-9, "dual_tol": 1e-12, "eps_prox": 0.0},
    }
    return ca.conic("step", "daqp", shapes, options)


def _room_at(search: _Search, model: _Model, step: _Step, tried: Point) -> Array:
    """Return the room with which the model is right at the end of a step."""
    room = model.room.copy()
    along = model.rows[:, : search.at.v.size] @ step.step
    for i, key in enumerate(model.of):
        if i < model.peaks:
            top = tried.same_top(*key)
            if top is not None:
                room[i] = search.at.worst - top[1] + along[i]
        else:
            room[i] = along[i] - tried.rows[key]
    return room


def _curved(search: _Search, model: _Model, step: _Step, tried: Point) -> Array:
    """Return the curvature of the Lagrangian after a step, by BFGS with Powell's damping."""
    curvature, s = search.curvature, search.step_of(tried.v - search.at.v)
    V, scale = s.size, search.held.scale_after(s)
    priced = np.flatnonzero(step.prices > 1e-6)
    found = [tried.same_top(*model.of[i]) for i in priced if i < model.peaks]
    moved = [(model.of[i][0], top[0]) for i, top in zip(priced, found, strict=False) if top]
    if len(moved) < len(found):  # a peak is gone
        return curvature
    kept = [tried.slopes[model.of[i]] for i in priced if i >= model.peaks]
    after = np.concatenate([tried.slopes_of(moved), np.reshape(kept, (-1, V))]) / scale
    change = step.prices[priced] @ (after - model.rows[priced, :V])
    Bs = curvature @ s
    sBs, sy = float(s @ Bs), float(s @ change)
    if sBs < 1e-14:
        return curvature
    damped = 1.0 if sy >= 0.2 * sBs else 0.8 * sBs / (sBs - sy)
    y = damped * change + (1 - damped) * Bs
    return np.asarray(curvature - np.outer(Bs, Bs) / sBs + np.outer(y, y) / (s @ y))


def _unasked(search: _Search, model: _Model, tried: Point) -> set[tuple[int, int]]:
    """Return the peaks that spoiled a step and were not in the model."""
    found = set()
    for impact, (nodes, heights) in enumerate(tried.tops):
        for node in nodes[heights >= tried.worst * (1 - 1e-9)]:
            top = search.at.same_top(impact, int(node))
            if top is not None:
                found.add((impact, top[0]))
    return found - set(model.of[: model.peaks])


def _found(search: _Search, model: _Model, step: _Step, steps: int, status: str) -> Found:
    held, bounds, at = search.held, search.bounds, search.at
    program, shape = held.nlp.program, held.nlp.instance.shape
    multipliers = np.zeros(peak_rows(program, shape).stop)
    for key, price in zip(model.of[model.peaks :], step.prices[model.peaks :], strict=True):
        multipliers[key[0] * program.rows + program.held + key[1]] = price
    at_end = np.isclose(at.v, bounds.lower) | np.isclose(at.v, bounds.upper)
    springs, others = bounds.parted(at.v)
    return Found(
        status=status,
        success=status == "Solve_Succeeded",
        iterations=steps,
        postures=held.postures,
        springs=springs,
        others=others,
        shares=at.shares,
        violation=at.violation,
        multipliers=multipliers,
        range_multipliers=np.where(at_end, step.range_prices / held.decades, 0.0),
        own=np.array([at.worst]),
        speeds=np.ones(len(shape.impacts)),
        cost=at.worst,
    )
