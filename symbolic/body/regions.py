# SPDX-License-Identifier: BSD-3-Clause
"""Regions of the human body as an impact meets them: springs, effective masses, force limits.

Stiffnesses, effective masses and quasi-static force limits are those of ISO/TS 15066:2016,
Annex A (Tables A.2 and A.3), from public transcriptions that agree with each other. Transient
limits are twice the quasi-static ones, except for the skull, the forehead and the face, for which
the specification gives none.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import UnknownName

TISSUE_DAMPING = 10.0
"""Damping of the body's spring [N·s/m] (MSM §3.1.1, whose printed unit is a slip)."""


@dataclass(frozen=True)
class BodyRegion:
    """A region of the human body.

    Attributes:
        name: as used in study files and on the command line.
        title: as in ISO/TS 15066.
        stiffness: k_h [N/m].
        effective_mass: that moves with the region when it is not clamped [kg].
        quasi_static_limit: force limit when pressed or clamped [N].
        transient_limit: force limit of a short free impact [N], None where none is given.
        damping: c_h [N·s/m].
    """

    name: str
    title: str
    stiffness: float
    effective_mass: float
    quasi_static_limit: float
    transient_limit: float | None
    damping: float = TISSUE_DAMPING

    @property
    def force_limit(self) -> float:
        """Limit for the first milliseconds [N]: transient, or quasi-static where that is all."""
        return self.quasi_static_limit if self.transient_limit is None else self.transient_limit


def _region(
    name: str, title: str, n_per_mm: float, mass: float, limit: float, transient: bool = True
) -> BodyRegion:
    return BodyRegion(name, title, 1e3 * n_per_mm, mass, limit, 2 * limit if transient else None)


REGIONS = {
    region.name: region
    for region in (
        _region("head", "Skull and forehead", 150, 4.4, 130, transient=False),
        _region("face", "Face", 75, 4.4, 65, transient=False),
        _region("neck", "Neck", 50, 1.2, 150),
        _region("back", "Back and shoulders", 35, 40, 210),
        _region("chest", "Chest", 25, 40, 140),
        _region("abdomen", "Abdomen", 10, 40, 110),
        _region("pelvis", "Pelvis", 25, 40, 180),
        _region("upper_arm", "Upper arms and elbow joints", 30, 3, 150),
        _region("lower_arm", "Lower arms and wrist joints", 40, 2, 160),
        _region("hand", "Hands and fingers", 75, 0.6, 140),
        _region("thigh", "Thighs and knees", 50, 75, 220),
        _region("lower_leg", "Lower legs", 60, 75, 130),
    )
}
"""Every region by name."""


def body_region(name: str) -> BodyRegion:
    """Return a region by name; raises UnknownName, which lists the regions there are."""
    if name not in REGIONS:
        raise UnknownName("body region", name, REGIONS)
    return REGIONS[name]
