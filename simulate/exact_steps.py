# SPDX-License-Identifier: BSD-3-Clause
"""Exact steps of a linear system under a force that is linear from node to node.

State rows are samples; numbers of a system may differ from sample to sample (leading axis) or be
shared by all.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from softimpact.symbolic import BodyRegion
from softimpact.symbolic.robot.rigid import Array

TAYLOR = 14
"""Terms of the matrix exponential's series, for matrices scaled to norms below one half."""

SMALL = 1e-3
"""(ωh)² below which series take the place of sines, as differences of cosines lose digits."""


@dataclass(frozen=True, eq=False)
class ModalStep:
    """A step of modes ÿ + ω² y = −φ f + g; coefficients have shape (r,) or (S, r).

    Attributes:
        cosine: cos ωh.
        sine: sin(ωh)/ω [s].
        squared: ω².
        before, after: what a unit force at the first and at the last node does to y.
        before_rate, after_rate: the same for ẏ.
    """

    cosine: Array
    sine: Array
    squared: Array
    before: Array
    after: Array
    before_rate: Array
    after_rate: Array

    def moved(self, y: Array, rate: Array, first: Array, last: Array) -> tuple[Array, Array]:
        """Return y and ẏ after the step under modal forces at its ends."""
        position = self.cosine * y + self.sine * rate + self.before * first + self.after * last
        speed = self.cosine * rate - self.squared * self.sine * y
        return position, speed + self.before_rate * first + self.after_rate * last


def modal_step(squared: Array, h: float | Array) -> ModalStep:
    """Return the step h [s] of modes of squared frequencies ω² (negative: they run away).

    h is one number, or has shape (S, 1).
    """
    root = np.sqrt(np.asarray(squared, dtype=complex))
    x = squared * h * h
    slow = abs(x) < SMALL
    safe = np.where(slow, 1.0, root * h)
    cosine = np.cos(root * h).real
    sine = np.where(slow, h * (1 - x / 6 + x * x / 120), (h * np.sin(safe) / safe).real)
    apart = np.where(slow, 1.0, squared)
    constant = np.where(slow, h * h * (0.5 - x / 24 + x * x / 720), (1 - cosine) / apart)
    after = np.where(slow, h * h * (1 / 6 - x / 120 + x * x / 5040), (1 - sine / h) / apart)
    return ModalStep(
        cosine, sine, squared, constant - after, after, sine - constant / h, constant / h
    )


@dataclass(frozen=True, eq=False)
class DenseStep:
    """A step of ẋ = A x + b f: x⁺ = Φ x + Γ₀ f₀ + Γ₁ f₁ for b of one or more columns.

    Attributes:
        transition: Φ, (m, m) or (S, m, m).
        before, after: Γ₀ and Γ₁, (m, k) or (S, m, k).
    """

    transition: Array
    before: Array
    after: Array

    def moved(self, x: Array, first: Array, last: Array) -> Array:
        """Return x after the step, (S, m), under forces at its ends, (S, k)."""
        return (
            _applied(self.transition, x) + _applied(self.before, first) + _applied(self.after, last)
        )


def _applied(matrix: Array, rows: Array) -> Array:
    if matrix.ndim == 2:
        return np.asarray(rows @ matrix.T)
    return np.asarray((matrix @ rows[..., None])[..., 0])


def dense_step(A: Array, b: Array, h: float | Array) -> DenseStep:
    """Return the step h [s], one number or one for each sample, of ẋ = A x + b f."""
    m, k = b.shape[-2:]
    steps = np.asarray(h)[..., None, None]
    leading = np.broadcast_shapes(A.shape[:-2], b.shape[:-2], steps.shape[:-2])
    block = np.zeros((*leading, m + 2 * k, m + 2 * k))
    block[..., :m, :m] = A * steps
    block[..., :m, m : m + k] = b * steps
    block[..., m : m + k, m + k :] = np.eye(k)
    E = exponential(block)
    constant, ramp = E[..., :m, m : m + k], E[..., :m, m + k :]
    return DenseStep(E[..., :m, :m], constant - ramp, ramp)


def exponential(matrix: Array) -> Array:
    """Return the exponentials of matrices (..., m, m), by scaling and squaring."""
    norm = float(abs(matrix).sum(axis=-1).max(initial=0.0))
    squarings = max(0, int(np.ceil(np.log2(max(norm, 1e-300)))) + 1)
    scaled = matrix / 2.0**squarings
    total = term = np.broadcast_to(np.eye(matrix.shape[-1]), matrix.shape)
    for k in range(1, TAYLOR + 1):
        term = term @ scaled / k
        total = total + term
    for _ in range(squarings):
        total = total @ total
    return np.asarray(total)


def body_system(region: BodyRegion, clamped: bool) -> tuple[Array, Array, Array]:
    """Return A, b and c of a body under the contact force: ẋ = A x + b f_c, x_0 = c·x.

    Its states are x_0 − x_h, ẋ_0 − ẋ_h where a plate has a mass, and x_h, ẋ_h unless it is
    clamped. Without a damper or a plate x_0 follows the force at once: that part is not here, see
    ``standing_compliance``.
    """
    k, c, m, plate = region.stiffness, region.damping, region.effective_mass, region.plate_mass
    free = [] if clamped else [[0.0, 1.0], [0.0, 0.0]]
    size = (2 if plate else 1 if c else 0) + len(free)
    A, b, out = np.zeros((size, size)), np.zeros((size, 1)), np.zeros(size)
    at = size - len(free)
    if plate:
        mobility = 1 / plate + (0 if clamped else 1 / m)
        A[:2, :2] = [[0.0, 1.0], [-k * mobility, -c * mobility]]
        b[1, 0] = 1 / plate
        out[0] = 1.0
        if not clamped:
            A[at + 1, :2] = [k / m, c / m]
    elif c:
        A[0, 0], b[0, 0], out[0] = -k / c, 1 / c, 1.0
        if not clamped:
            b[at + 1, 0] = 1 / m
    elif not clamped:
        b[at + 1, 0] = 1 / m
    if not clamped:
        A[at, at + 1], out[at] = 1.0, 1.0
    return A, b, out


def standing_compliance(region: BodyRegion) -> float:
    """Return what of x_0 follows the force at once [m/N]."""
    return 0.0 if region.damping or region.plate_mass else 1 / region.stiffness
