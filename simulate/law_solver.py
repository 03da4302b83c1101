# SPDX-License-Identifier: BSD-3-Clause
"""The force with which two sides press on each other through a law of contact, for many at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from softimpact.symbolic.body.laws import Law, PowerLaw
from softimpact.symbolic.body.laws.series import points_of
from softimpact.symbolic.robot.rigid import Array

NEWTON, CLOSE = 40, 1e-10
"""Most iterations for a depth, and its change, as a share, after which it is found."""

TINY = 1e-30
"""Keeps shares of a depth of zero finite [m]."""

LawAndSlope = Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True, eq=False)
class LawSolver:
    """Solves δ + e f(δ) = p: the depth δ of a law between sides that give way by e a newton.

    Attributes:
        law: δ > 0 → f and ∂f/∂δ.
        softness: e [m/N].
    """

    law: LawAndSlope
    softness: float | Array

    def solve(self, pushed: Array, guess: Array | None = None) -> tuple[Array, Array]:
        """Return force [N] and depth [m] for depths p that there would be without the force.

        Newton's steps, kept between 0 and p, where the root is; f may be as steep as it likes.
        """
        p = np.maximum(pushed, 0.0)
        low, high = np.zeros_like(p), p
        depth = (
            np.where((guess > 0) & (guess < p), guess, 0.5 * p) if guess is not None else 0.5 * p
        )
        force = np.zeros_like(p)
        for _ in range(NEWTON):
            force, slope = self.law(depth)
            over = depth + self.softness * force - p
            low, high = np.where(over < 0, depth, low), np.where(over < 0, high, depth)
            new = depth - over / (1 + self.softness * slope)
            new = np.where((new >= low) & (new <= high), new, 0.5 * (low + high))
            change = abs(new - depth)
            depth = new
            if (change <= CLOSE * (depth + TINY)).all():
                break
        return self.law(depth)[0], depth


def law_solver(law: Law, softness: float | Array, scale: float | Array = 1.0) -> LawSolver:
    """Return the solver of a law between sides that give way by ``softness`` [m/N].

    Args:
        law: of contact.
        softness: one number, or one for each impact.
        scale: factor on the law's force, likewise.
    """
    plain = _power(law) if isinstance(law, PowerLaw) else points_of(law).evaluated

    def scaled(depth: Array) -> tuple[Array, Array]:
        force, slope = plain(depth)
        return scale * force, scale * slope

    return LawSolver(scaled, softness)


def _power(law: PowerLaw) -> LawAndSlope:
    k, n = float(law.stiffness), law.exponent

    def evaluated(depth: Array) -> tuple[Array, Array]:
        slope = k * (np.sqrt(depth) if n == 1.5 else depth ** (n - 1))
        return slope * depth, n * slope

    return evaluated
