# SPDX-License-Identifier: BSD-3-Clause
"""The contact between robot and body: Hertz's law in series with the body region (MSM §3.1)."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from ..matrices import Matrix
from .regions import BodyRegion

HERTZ_STIFFNESS = 1.9e7
"""k_f of the skin [N/m^1.5], measured on 7 mm foam of 70 ShA (MSM §3.1.2)."""

HERTZ_EXPONENT = 1.5
"""n_f of Hertz's law."""


@dataclass(frozen=True)
class Contact:
    """What the robot's contact point hits.

    Attributes:
        region: the region of the body.
        clamped: True if it is held against something rigid, False if it can give way with its
            effective mass.
        hertz_stiffness: k_f of the skin [N/m^1.5].
    """

    region: BodyRegion
    clamped: bool = True
    hertz_stiffness: float = HERTZ_STIFFNESS

    def force(self, depth: Matrix) -> Matrix:
        """Return f_c = k_f δ₊^1.5 [N] for a penetration δ [m] of the skin."""
        return hertz_force(self.hertz_stiffness, depth)


def hertz_force(stiffness: Matrix, depth: Matrix) -> Matrix:
    """Return k_f δ₊^1.5 [N]; as a power, which unlike a square root has a slope at δ = 0."""
    return stiffness * ca.fmax(depth, 0) ** HERTZ_EXPONENT
