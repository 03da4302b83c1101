# SPDX-License-Identifier: BSD-3-Clause
"""Power laws; Hertz's is the usual one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from ...errors import InvalidValue
from ...matrices import Matrix
from .law import Law

HERTZ_EXPONENT = 1.5
"""n_f of Hertz's law: a sphere, or any smooth blunt shape, on something that it does not fill."""


@dataclass(frozen=True)
class PowerLaw(Law):
    """f = k_f δ₊ⁿ (MSM §3.1.2).

    Attributes:
        stiffness: k_f [N/mⁿ].
        exponent: n ≥ 1.
    """

    stiffness: float
    exponent: float = HERTZ_EXPONENT

    kind: ClassVar[str] = "power"
    parameters: ClassVar[tuple[str, ...]] = ("stiffness",)

    def force(self, depth: Matrix) -> Matrix:
        """Return k_f δ₊ⁿ [N]; as a power, which unlike a root has a slope at δ = 0."""
        return self.stiffness * ca.fmax(depth, 0) ** self.exponent

    def check(self) -> None:
        """Raise InvalidValue for a stiffness ≤ 0 or an exponent below 1."""
        if not 0 < self.stiffness < math.inf:
            reason = f"must be finite and greater than 0, not {self.stiffness}"
            raise InvalidValue("stiffness", reason)
        if not 1 <= self.exponent < math.inf:
            raise InvalidValue("exponent", f"must be finite and at least 1, not {self.exponent}")
