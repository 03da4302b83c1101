# SPDX-License-Identifier: BSD-3-Clause
"""Laws one behind the other: what presses on a cover presses on the skin."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from ...errors import InvalidValue
from ...matrices import Matrix
from ...robot.rigid import Array
from .curve import through_points
from .law import Law
from .power import PowerLaw

LEAST_FORCE = 1e-4
"""Force [N] below which the shape of a series does not matter to anyone."""

MOST_FORCE = 1e5
"""Force [N] that no impact on a person comes near; a series goes on straight beyond it."""

SERIES_ERROR = 1e-5
"""Relative error that the force of a series may have above ``LEAST_FORCE``."""

START = 4
"""Points in a decade of force before more are added where the error asks for it."""

DEEPEST = 10.0
"""Depth [m] by which a law must have reached ``MOST_FORCE``."""


@dataclass(frozen=True)
class Series(Law):
    """Laws in series that have no closed form together: one force, the sum of their depths.

    The force is a monotone cubic through points of the exact series, with its exact slopes, dense
    enough for ``SERIES_ERROR``.

    Attributes:
        laws: at least two.
    """

    laws: tuple[Law, ...]

    @property
    def reach(self) -> float:
        """Force up to which all laws are known [N]."""
        return min(law.reach for law in self.laws)

    def force(self, depth: Matrix) -> Matrix:
        """Return f(δ) [N]."""
        points = _sampled(self.laws)
        return through_points(
            depth, tuple(points.depth), tuple(points.force), points.slope, points.slope[-1]
        )

    def check(self) -> None:
        """Raise InvalidValue if a number of one of the laws cannot be."""
        for law in self.laws:
            law.check()


def in_series(*laws: Law) -> Law:
    """Return laws that the same force presses, as one.

    Power laws of one exponent make another, k_f^(−1/n) = Σ k_i^(−1/n); what is left is sampled
    (see ``Series``). The order does not matter.

    Raises:
        InvalidValue: there is no law.
    """
    if not laws:
        raise InvalidValue("laws", "needs at least one law")
    flat = [part for law in laws for part in (law.laws if isinstance(law, Series) else (law,))]
    if len(flat) == 1:
        return flat[0]
    softness: dict[float, float] = {}  # k_f^(−1/n) by exponent
    others = []
    for law in flat:
        if isinstance(law, PowerLaw):
            soft = law.stiffness ** (-1 / law.exponent)
            softness[law.exponent] = softness.get(law.exponent, 0.0) + soft
        else:
            others.append(law)
    together = [PowerLaw(soft**-n, n) for n, soft in sorted(softness.items())]
    parts = (*together, *others)
    return parts[0] if len(parts) == 1 else Series(parts)


@dataclass(frozen=True, eq=False)
class _Points:
    depth: Array
    force: Array
    slope: Array


@lru_cache(maxsize=64)
def _sampled(laws: tuple[Law, ...]) -> _Points:
    decades = np.log10(MOST_FORCE / LEAST_FORCE)
    forces = np.geomspace(LEAST_FORCE, MOST_FORCE, round(START * decades) + 1)
    corners = [f for law in laws for f in getattr(law, "forces", ()) if f > LEAST_FORCE]
    forces = np.unique([*forces, *(f for f in corners if f < MOST_FORCE)])
    for _ in range(12):  # halves each interval at most so often
        points = _exact(laws, forces)
        between = np.sqrt(points.force[1:-1] * points.force[2:])
        depth = _exact(laws, between).depth[1:]
        found = through_points(
            ca.DM(depth), tuple(points.depth), tuple(points.force), points.slope, points.slope[-1]
        )
        error = np.abs(np.array(found).ravel() / between - 1)
        if (error <= SERIES_ERROR).all():
            break
        forces = np.unique([*forces, *between[error > SERIES_ERROR]])
    return points


def _exact(laws: tuple[Law, ...], forces: Array) -> _Points:
    """Return the series at 0 and at some forces: depths add up, and so do 1/slopes."""
    depth, softness = np.zeros_like(forces), np.zeros_like(forces)
    x = ca.SX.sym("x")
    for law in laws:
        f = law.force(x)
        both = ca.Function("law", [x], [f, ca.jacobian(f, x)]).map(len(forces))
        low, high = np.full_like(forces, 1e-20), np.full_like(forces, DEEPEST)
        if (np.array(both(high[None, :])[0]) < MOST_FORCE).any():
            raise InvalidValue(
                "law", f"gives less than {MOST_FORCE:g} N at a depth of {DEEPEST:g} m"
            )
        for _ in range(80):
            middle = np.sqrt(low * high)
            above = np.array(both(middle[None, :])[0]).ravel() > forces
            low, high = np.where(above, low, middle), np.where(above, middle, high)
        depth += high
        softness += 1 / np.array(both(high[None, :])[1]).ravel()
    at_zero = [0.0]
    return _Points(
        np.concatenate([at_zero, depth]),
        np.concatenate([at_zero, forces]),
        np.concatenate([at_zero, 1 / softness]),
    )
