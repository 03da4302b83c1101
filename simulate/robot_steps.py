# SPDX-License-Identifier: BSD-3-Clause
"""Steps of a linear robot's modes, with the contact force at a step's end still to be found.

Shapes have (r,), shared by all samples, or (S, r).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from softimpact.symbolic.robot.rigid import Array

from .exact_steps import DenseStep, ModalStep, dense_step, modal_step


@dataclass(frozen=True, eq=False)
class UndampedSteps:
    """Steps of modes that only meet in the contact force."""

    step: ModalStep
    shape: Array

    @property
    def softness(self) -> Array:
        """What a unit force at the last node takes from the depth [m/N]."""
        return np.asarray((self.shape * self.step.after * self.shape).sum(axis=-1))

    def moved(
        self, y: Array, rate: Array, force: Array, given: Array, later: Array
    ) -> tuple[Array, Array]:
        """Return modes after a step without the new force.

        Args:
            y: modes, (S, r).
            rate: ẏ.
            force: f_c at the first node, length S.
            given: other forces on the modes at the first node, (S, r).
            later: those at the last node.
        """
        return self.step.moved(y, rate, given - force[:, None] * self.shape, later)

    def pushed(self, y: Array, rate: Array, force: Array) -> tuple[Array, Array]:
        """Return modes with the force at the last node, too."""
        push = force[:, None] * self.shape
        return y - self.step.after * push, rate - self.step.after_rate * push


@dataclass(frozen=True, eq=False)
class DampedSteps:
    """The same for modes that a damping couples."""

    step: DenseStep
    shape: Array

    @property
    def softness(self) -> Array:
        """What a unit force at the last node takes from the depth [m/N]."""
        n = self.shape.shape[-1]
        return np.asarray((self.shape * self._answer[..., :n]).sum(axis=-1))

    @property
    def _answer(self) -> Array:
        return np.asarray((self.step.after @ self.shape[..., None])[..., 0])

    def moved(
        self, y: Array, rate: Array, force: Array, given: Array, later: Array
    ) -> tuple[Array, Array]:
        """Return modes after a step without the new force; see ``UndampedSteps``."""
        n = self.shape.shape[-1]
        x = np.hstack([y, rate])
        x = self.step.moved(x, given - force[:, None] * self.shape, later)
        return x[:, :n], x[:, n:]

    def pushed(self, y: Array, rate: Array, force: Array) -> tuple[Array, Array]:
        """Return modes with the force at the last node, too."""
        n = self.shape.shape[-1]
        push = force[:, None] * self._answer
        return y - push[..., :n], rate - push[..., n:]


def robot_steps(
    squared: Array, shape: Array, damping: Array | None, h: float | Array
) -> UndampedSteps | DampedSteps:
    """Return the steps h [s] of modes ÿ + C ẏ + ω² y = −φ f_c + given forces.

    Args:
        squared: ω², (r,) or (S, r).
        shape: φ, likewise.
        damping: C, (r, r) or (S, r, r); None where nothing damps.
        h: step [s], one number or one for each sample.
    """
    if damping is None:
        return UndampedSteps(modal_step(squared, np.asarray(h)[..., None]), shape)
    n = shape.shape[-1]
    A = np.zeros((*damping.shape[:-2], 2 * n, 2 * n))
    b = np.zeros((*damping.shape[:-2], 2 * n, n))
    A[..., :n, n:], b[..., n:, :] = np.eye(n), np.eye(n)
    A[..., n:, :n], A[..., n:, n:] = -squared[..., None] * np.eye(n), -damping
    return DampedSteps(dense_step(A, b, h), shape)
