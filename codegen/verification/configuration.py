# SPDX-License-Identifier: BSD-3-Clause
"""The equilibrium of a closed chain at given motor angles, by Newton's method in C.

The unknowns are the coordinates of the joints without motors and the forces λ in the loops:
∂(V + λᵀφ)/∂q = 0 for these joints, and φ = 0. Motors are led from a known configuration to their
angles in short moves, so that the chain stays assembled as it is.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic import (
    Loop,
    Robot,
    closed_chain,
    constrained_stiffness,
    loop_gaps,
    loop_jacobian,
    potential_energy,
)
from softimpact.symbolic.matrices import Factorisation
from softimpact.symbolic.robot.rigid import Array

from ..expressions.evaluate import evaluate_exactly, evaluate_rounded
from ..expressions.graph import Graph, graph_of

NEWTON_STEPS = 12
"""Most Newton steps for one move of the motors."""

LONGEST_MOVE = 0.125
"""Longest move of a motor at once [rad, m]."""

MOST_MOVES = 64
"""Most moves."""

LONGEST_STEP = 1.0
"""Longest Newton step of a joint that is taken [rad, m]."""

LAST_STEP = {np.float64: 1e-9, np.float32: 1e-4}
"""Newton step [rad, m] after which the equilibrium counts as found: what is left is its square."""

REFINEMENTS = 2
"""Exact Newton steps that make golden results right to the last bit."""


@dataclass(frozen=True, eq=False)
class Configuration:
    """Equations for the joints that follow from the motors.

    Attributes:
        robot: a closed chain.
        gravity: along the base's axes [m/s²].
    """

    robot: Robot
    gravity: tuple[float, float, float]

    @cached_property
    def motors(self) -> tuple[int, ...]:
        """Indices of the joints with motors."""
        return tuple(i for i, actuated in enumerate(self.robot.actuated) if actuated)

    @cached_property
    def passive(self) -> tuple[int, ...]:
        """Indices of the joints without."""
        return tuple(i for i, actuated in enumerate(self.robot.actuated) if not actuated)

    @cached_property
    def home(self) -> Array:
        """A closed configuration, in digits that do not depend on the machine."""
        return closed_chain(self.robot).home.round(9)

    @property
    def forces(self) -> int:
        """Number of forces λ."""
        return len(closed_chain(self.robot).dependent)

    @property
    def unknowns(self) -> int:
        """Number of equations and of unknowns."""
        return len(self.passive) + self.forces

    @cached_property
    def equations(self) -> Graph:
        """Residuals, then their derivatives column by column, over q and λ."""
        q, force = ca.SX.sym("q", self.robot.n), ca.SX.sym("l", self.forces)
        gaps = loop_gaps(self.robot, q)
        energy = potential_energy(self.robot, q, self.gravity) + ca.dot(force, gaps)
        slope = ca.gradient(energy, q)[list(self.passive)]
        residual = ca.vertcat(ca.densify(slope), gaps)
        matrix = ca.jacobian(residual, ca.vertcat(q, force))
        columns = [*self.passive, *range(self.robot.n, self.robot.n + self.forces)]
        return graph_of([q, force], [residual, ca.densify(matrix[:, columns])])

    @cached_property
    def checks(self) -> Graph:
        """Numbers over q that are positive at a stable equilibrium assembled as home is."""
        q, chain = ca.SX.sym("q", self.robot.n), closed_chain(self.robot)
        side = ca.det(loop_jacobian(self.robot, q)[:, list(chain.dependent)])
        at_home = float(ca.Function("side", [q], [side])(chain.home))
        numbers = [side * math.copysign(1.0, at_home)]
        held = [k for k, i in enumerate(chain.independent) if i not in self.motors]
        if held:
            stiffness = constrained_stiffness(self.robot, q, self.gravity)[held, held]
            numbers += Factorisation(stiffness).d
        return graph_of([q], [ca.vertcat(*numbers)])

    @property
    def imbalance(self) -> float:
        """Largest torque of the joints without motors at home, with no force in the loops."""
        state = [self.home.tolist(), [0.0] * self.forces]
        return max(map(abs, evaluate_exactly(self.equations, state)[0]))

    @property
    def flops(self) -> int:
        """Operations of one Newton step, elimination included."""
        n = self.unknowns
        return self.equations.flops + (2 * n**3 + 3 * n**2 - 5 * n) // 6 + n * n

    @property
    def sines_and_cosines(self) -> int:
        """How many of them one Newton step takes."""
        return self.equations.count(ca.OP_SIN, ca.OP_COS)


def has_configuration(robot: Robot) -> bool:
    """Whether motors decide where other joints rest; couplings alone need no solver."""
    chain = closed_chain(robot)
    motors = {i for i, actuated in enumerate(robot.actuated) if actuated}
    closed = any(isinstance(loop, Loop) for loop in robot.loops)
    return closed and motors <= set(chain.independent)


def golden_configuration(
    configuration: Configuration, motor_angles: Sequence[float]
) -> Array | None:
    """Return the equilibrium to the last bit, or None where the C function has none."""
    goal = np.array(motor_angles, dtype=float)[:, None]
    q, force, good = _solve(configuration, goal, np.float64)
    if not good[0]:
        return None
    size = configuration.unknowns
    for _ in range(REFINEMENTS):
        residual, matrix = evaluate_exactly(
            configuration.equations, [q[:, 0].tolist(), force[:, 0].tolist()]
        )
        step = np.linalg.solve(np.array(matrix).reshape(size, size).T, np.array(residual))
        _subtract(configuration, q, force, step[:, None])
    return q[:, 0]


def rounded_configurations(
    configuration: Configuration, motor_angles: Array, kind: type[np.floating[Any]]
) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    """Return the equilibria of many motor angles (m×S) as C finds them in a precision.

    Returns:
        Configurations, n×S, and for which of them the search ended well.
    """
    q, _, good = _solve(configuration, motor_angles, kind)
    return q, good


def _solve(
    configuration: Configuration, goal: Array, kind: type[np.floating[Any]]
) -> tuple[NDArray[Any], NDArray[Any], NDArray[np.bool_]]:
    """Do what the C function does, on columns of motor angles; a test runs both at the edges."""
    samples, motors = goal.shape[1], list(configuration.motors)
    home = configuration.home[:, None].astype(kind)
    q, force = np.tile(home, samples), np.zeros((configuration.forces, samples), dtype=kind)
    start, target = home[motors], goal.astype(kind)
    farthest = abs(target - start).max(axis=0, initial=0.0)
    good = farthest <= MOST_MOVES * LONGEST_MOVE
    moves = np.maximum(1, np.ceil(np.where(good, farthest, 0.0) / LONGEST_MOVE)).astype(int)
    with np.errstate(all="ignore"):  # searches that fail may run away
        for move in range(1, moves.max(initial=1) + 1):
            at = np.flatnonzero(good & (move <= moves))
            share = kind(move) / moves[at].astype(kind)
            moved = start + (target[:, at] - start) * share
            q[np.array(motors)[:, None], at] = np.where(moves[at] == move, target[:, at], moved)
            good[at] = _balanced(configuration, q, force, at, kind)
    (checks,) = evaluate_rounded(configuration.checks, [q], kind)
    return q, force, good & (checks > 0).all(axis=0)


def _balanced(
    configuration: Configuration,
    q: NDArray[Any],
    force: NDArray[Any],
    at: NDArray[np.intp],
    kind: type[np.floating[Any]],
) -> NDArray[np.bool_]:
    """Balance the passive joints of some columns; return for which of them it was done."""
    passive, size = len(configuration.passive), configuration.unknowns
    found, left = np.full(q.shape[1], False), at
    for _ in range(NEWTON_STEPS):
        state = [q[:, left], force[:, left]]
        residual, flat = evaluate_rounded(configuration.equations, state, kind)
        step = _eliminated(flat.reshape(size, size, left.size), residual)
        near = (abs(step[:passive]) <= LONGEST_STEP).all(axis=0)
        left, step = left[near], step[:, near]
        q[np.array(configuration.passive)[:, None], left] -= step[:passive]
        force[:, left] -= step[passive:]
        small = abs(step[:passive]).max(axis=0, initial=0.0) <= LAST_STEP[kind]
        found[left[small]] = np.isfinite(force[:, left[small]]).all(axis=0)
        left = left[~small]
        if not left.size:
            break
    return found[at]


def _subtract(
    configuration: Configuration, q: NDArray[Any], force: NDArray[Any], step: NDArray[Any]
) -> None:
    passive = list(configuration.passive)
    q[passive] -= step[: len(passive)]
    force -= step[len(passive) :]


def _eliminated(matrix: NDArray[Any], right: NDArray[Any]) -> NDArray[Any]:
    """Solve A x = b for many samples by elimination with row pivots, as the C does.

    ``matrix[j, i]`` is the entry of row i and column j.
    """
    a, b = matrix.transpose(1, 0, 2).copy(), right.copy()
    n, every = len(b), np.arange(b.shape[1])
    with np.errstate(all="ignore"):
        for k in range(n):
            pivot = k + np.argmax(abs(a[k:, k]), axis=0)
            a[k, :, every], a[pivot, :, every] = a[pivot, :, every], a[k, :, every].copy()
            b[k, every], b[pivot, every] = b[pivot, every], b[k, every].copy()
            for i in range(k + 1, n):
                factor = a[i, k] / a[k, k]
                a[i, k + 1 :] -= factor * a[k, k + 1 :]
                b[i] -= factor * b[k]
        for k in reversed(range(n)):
            for j in range(k + 1, n):
                b[k] -= a[k, j] * b[j]
            b[k] /= a[k, k]
    return b
