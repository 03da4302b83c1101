# SPDX-License-Identifier: BSD-3-Clause
"""What a body may bear, all as forces, and whether an impact keeps it.

Each limit of the standard becomes the force that reaches it: the force limit itself, the pressure
limit by the shape that touches, and the energy limit by F = √(2 k_h E), the force at which the
region's spring holds E. So the least of them binds, and a safe speed needs to know forces only.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from ..errors import InvalidValue
from .regions import BodyRegion
from .shapes import Shape, force_at_pressure

QUASI_STATIC_FROM = 0.5
"""When the quasi-static limit takes over from the transient one in a clamped contact [s]."""

Quantity = Literal["force", "pressure", "energy"]
"""What a limit is of."""

Ruling = Literal["kept", "exceeded", "not permitted", "no limit"]
"""What becomes of an impact."""


@dataclass(frozen=True)
class Limit:
    """A limit as a force.

    Attributes:
        force: that reaches it [N]; infinite where no limit is given.
        quantity: what it is a limit of.
    """

    force: float
    quantity: Quantity


@dataclass(frozen=True)
class Limits:
    """What a body may bear.

    Attributes:
        permitted: False where contact may not happen at all, whatever the force; the limits
            are then for reference.
        transient: of the peak in the first 0.5 s.
        quasi_static: of what presses later; None where nothing can, since the body gives way.
    """

    permitted: bool
    transient: Limit
    quasi_static: Limit | None


@dataclass(frozen=True)
class Verdict:
    """Whether an impact keeps a body's limits.

    Attributes:
        ruling: kept, exceeded, not permitted, or no limit where the body has none.
        binding: phase and quantity nearest to, or furthest beyond, its limit; ``transient force``,
            for example.
        share: how much of that limit is used; above 1 it is exceeded.
    """

    ruling: Ruling
    binding: str
    share: float


def limits_of(region: BodyRegion, clamped: bool, shape: Shape | None = None) -> Limits:
    """Return the limits of a region.

    Args:
        region: of the body.
        clamped: whether it is held; only then something can press on it for long.
        shape: what touches; None: pressure is not judged.
    """
    energy, stiffness = region.energy_limit, region.stiffness
    transient = [
        Limit(region.force_limit, "force"),
        Limit(_reaching(shape, region.transient_pressure, region), "pressure"),
        Limit(math.inf if energy is None else math.sqrt(2 * stiffness * energy), "energy"),
    ]
    pressing = [
        Limit(region.quasi_static_limit, "force"),
        Limit(_reaching(shape, region.quasi_static_pressure, region), "pressure"),
    ]
    return Limits(region.permitted, _least(transient), _least(pressing) if clamped else None)


def judge(limits: Limits, peak: float, pressing: float | None = None) -> Verdict:
    """Return the verdict on an impact.

    Args:
        limits: of what is hit.
        peak: largest force of all contacts [N].
        pressing: largest force from ``QUASI_STATIC_FROM`` on [N]; needed where the body is clamped.

    Raises:
        InvalidValue: a clamped body, but no ``pressing``.
    """
    used = {f"transient {limits.transient.quantity}": peak / limits.transient.force}
    if limits.quasi_static is not None:
        if pressing is None:
            raise InvalidValue("pressing", "is needed where the body is clamped")
        name = f"quasi-static {limits.quasi_static.quantity}"
        used[name] = pressing / limits.quasi_static.force
    binding = max(used, key=lambda name: used[name])
    return Verdict(_ruling(limits, used[binding]), binding, used[binding])


def _ruling(limits: Limits, share: float) -> Ruling:
    if not limits.permitted:
        return "not permitted"
    if limits.transient.force == math.inf:
        return "no limit"
    return "kept" if share <= 1 else "exceeded"


def _reaching(shape: Shape | None, pressure: float | None, region: BodyRegion) -> float:
    """Return the force that reaches a pressure, infinite where there is no limit."""
    if shape is None or (pressure is None and region.quasi_static_pressure is None):
        return math.inf
    limit = region.quasi_static_pressure if pressure is None else pressure
    assert limit is not None
    return force_at_pressure(shape, limit)


def _least(limits: list[Limit]) -> Limit:
    return min(limits, key=lambda limit: limit.force)
