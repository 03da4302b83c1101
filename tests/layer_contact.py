# SPDX-License-Identifier: BSD-3-Clause
"""A rigid shape on a bonded rubber layer, solved numerically."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from softimpact.symbolic.body.pads import Pad
from softimpact.symbolic.robot.rigid import Array

Gap = Callable[[Array, Array], Array]
"""Height [m] of the rigid shape above its lowest point, over x and y [m]."""


def largest_pressure(gap: Gap, force: float, pad: Pad, width: float, n: int = 128) -> float:
    """Return the largest pressure [Pa] under a rigid shape that presses with a force.

    The layer keeps its volume and sticks to what is below; the shape is smooth. Its surface gives
    way by Fourier's modes (of a periodic square of some width): conjugate gradients with contact
    (Polonsky and Keer, Wear 231, 1999).
    """
    step = width / n
    axis = (np.arange(n) - n / 2) * step
    height = gap(*np.meshgrid(axis, axis, indexing="ij"))
    wave = np.hypot(*np.meshgrid(*[2 * np.pi * np.fft.fftfreq(n, step)] * 2, indexing="ij"))
    wave[0, 0] = 1.0
    softness = 1.5 / pad.modulus / wave * _share_of_half_space(wave * pad.thickness)
    softness[0, 0] = 0.0  # the layer keeps its volume

    def sunk(pressure: Array) -> Array:
        return np.asarray(np.fft.ifft2(softness * np.fft.fft2(pressure)).real)

    pressure = np.full((n, n), force / width**2)
    direction, before, conjugate = np.zeros_like(pressure), 1.0, 0.0
    for _ in range(300):
        touching = pressure > 0
        residual = sunk(pressure) + height
        residual -= residual[touching].mean()
        square = float((residual[touching] ** 2).sum())
        step_on = residual + conjugate * square / before * direction
        direction, before = np.where(touching, step_on, 0.0), square
        moved = sunk(direction)
        moved -= moved[touching].mean()
        along = (residual * direction)[touching].sum() / (moved * direction)[touching].sum()
        new = np.maximum(np.where(touching, pressure - along * direction, pressure), 0)
        overlap = (new == 0) & (residual < 0)
        conjugate = 0.0 if overlap.any() else 1.0
        new = np.where(overlap, new - along * residual, new)
        new *= force / (new.sum() * step**2)
        change, pressure = np.abs(new - pressure).sum() / new.sum(), new
        if change < 1e-5:
            return float(pressure.max())
    raise AssertionError("the contact did not settle")


def _share_of_half_space(s: Array) -> Array:
    """Return how soft a bonded layer that keeps its volume is beside a half-space, over k·t."""
    small = np.minimum(s, 20.0)
    exact = (np.sinh(2 * small) - 2 * small) / (np.cosh(2 * small) + 1 + 2 * small**2)
    return np.asarray(np.where(s > 20, 1.0, exact))
