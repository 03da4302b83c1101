# SPDX-License-Identifier: BSD-3-Clause
"""Laws one behind the other: what presses on a cover presses on the skin."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from ...errors import InvalidValue
from ...matrices import Matrix
from ...robot.rigid import Array
from .curve import Curve
from .law import Law
from .points import CubicPoints
from .power import PowerLaw

LEAST_FORCE = 1e-4
"""Force [N] below which the shape of a series does not matter to anyone."""

MOST_FORCE = 1e5
"""Force [N] that no impact on a person comes near; a series goes on straight beyond it."""

SERIES_ERROR = 1e-5
"""Relative error that the force of a series may have above ``LEAST_FORCE``."""

START = 8
"""Points in a decade of force before more are added where the error asks for it."""

SHALLOWEST, DEEPEST = 1e-18, 10.0
"""Depths [m] between which a law must reach every force up to twice ``MOST_FORCE``."""

MOST_HALVINGS = 16
"""How often an interval of forces may be halved."""

BESIDE = 1e-6
"""Relative step in force by which slopes are found."""


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
        return _sampled(self.laws).force(depth)

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


def points_of(law: Law) -> CubicPoints:
    """Return the points through which a law goes: a curve's own, any other's sampled."""
    if isinstance(law, Curve):
        return law.points
    return _sampled(law.laws if isinstance(law, Series) else (law,))


@lru_cache(maxsize=64)
def _sampled(laws: tuple[Law, ...]) -> CubicPoints:
    decades = np.log10(MOST_FORCE / LEAST_FORCE)
    forces = np.geomspace(LEAST_FORCE, MOST_FORCE, round(START * decades) + 1)
    corners = [f for law in laws for f in getattr(law, "forces", ())]
    forces = np.unique([*forces, *(f for f in corners if LEAST_FORCE < f < MOST_FORCE)])
    for _ in range(MOST_HALVINGS):
        between = np.sqrt(forces[:-1] * forces[1:])
        sought = [forces, forces * (1 - BESIDE), forces * (1 + BESIDE), between]
        sizes = np.cumsum([len(group) for group in sought[:-1]])
        depth, less, more, middle = np.split(_depths(laws, np.concatenate(sought)), sizes)
        step = BESIDE * forces
        points = _rising(depth, forces, step / (depth - less), step / (more - depth))
        rough = np.abs(points.evaluated(middle)[0] / between - 1) > SERIES_ERROR
        if not rough.any():
            break
        forces = np.unique([*forces, *between[rough]])
    return points


def _rising(depth: Array, force: Array, before: Array, after: Array) -> CubicPoints:
    """Return points with 0 in front, and slopes that keep a cubic through them rising."""
    depth, force, before, after = (np.append(0.0, part) for part in (depth, force, before, after))
    steepest = 3 * np.diff(force) / np.diff(depth)  # Fritsch and Carlson
    before[1:] = np.minimum(before[1:], steepest)
    after[:-1] = np.minimum(after[:-1], steepest)
    return CubicPoints(depth, force, before, after, float(after[-1]))


def _depths(laws: tuple[Law, ...], forces: Array) -> Array:
    """Return the depth of a series at some forces: the sum of its laws' depths, by bisection."""
    total = np.zeros_like(forces)
    for law in laws:
        if isinstance(law, PowerLaw):
            total += (forces / law.stiffness) ** (1 / law.exponent)
            continue
        force = _evaluated(law)
        low, high = np.full_like(forces, SHALLOWEST), np.full_like(forces, DEEPEST)
        if force(high[:1])[0] < 2 * MOST_FORCE:
            reason = f"gives less than {2 * MOST_FORCE:g} N at a depth of {DEEPEST:g} m"
            raise InvalidValue("law", reason)
        for _ in range(100):
            middle = np.sqrt(low * high)
            above = force(middle) > forces
            low, high = np.where(above, low, middle), np.where(above, middle, high)
        total += high
    return total


def _evaluated(law: Law) -> Callable[[Array], Array]:
    """Return a law's force over depths as arrays."""
    if isinstance(law, Curve):
        points = law.points
        return lambda depth: points.evaluated(depth)[0]
    return lambda depth: np.array(law.force(ca.DM(depth)), dtype=float).ravel()
