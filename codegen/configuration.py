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

from .evaluate import evaluate_exactly, evaluate_rounded
from .graph import Graph, graph_of

NEWTON_STEPS = 12
"""Most Newton steps for one move of the motors."""

MOVE = 0.125
"""Longest move of a motor at once [rad, m]."""

MOVES = 64
"""Most moves."""

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
        """A closed configuration."""
        return closed_chain(self.robot).home

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
    """Mirror of the C function over columns of motor angles."""
    samples, motors = goal.shape[1], list(configuration.motors)
    q = np.tile(configuration.home[:, None], samples).astype(kind)
    force = np.zeros((configuration.forces, samples), dtype=kind)
    start, target = q[motors].copy(), goal.astype(kind)
    moves = max(1, math.ceil(float(abs(target - start).max(initial=0.0)) / MOVE))
    good = np.full(samples, True)
    with np.errstate(all="ignore"):  # searches that fail may run away
        for move in range(1, moves + 1):
            q[motors] = target if move == moves else start + (target - start) * kind(move / moves)
            for _ in range(NEWTON_STEPS):
                residual, flat = evaluate_rounded(configuration.equations, [q, force], kind)
                size = configuration.unknowns
                step = _eliminated(flat.reshape(size, size, samples), residual)
                _subtract(configuration, q, force, step)
                longest = abs(step[: len(configuration.passive)]).max(axis=0)
                if not (longest[good] > LAST_STEP[kind]).any():
                    break
            good &= longest <= LAST_STEP[kind]
    (checks,) = evaluate_rounded(configuration.checks, [q], kind)
    return q, force, good & (checks > 0).all(axis=0)


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
