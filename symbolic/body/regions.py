# SPDX-License-Identifier: BSD-3-Clause
"""Regions and areas of the human body as an impact meets them (ISO/TS 15066, Annex A).

The numbers and their sources are in ``data/regions.csv`` and ``data/areas.csv``; a new one is a new
line there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from .laws import Law
from .tables import number, table_rows

TISSUE_DAMPING = 10.0
"""Damping of the body's spring [N·s/m] (MSM §3.1.1, whose printed unit is a slip)."""

NEWTON_PER_CM2 = 1e4
"""In Pa."""


@dataclass(frozen=True)
class BodyRegion:
    """What the robot hits: a region or area of the human body, or something in its place.

    Attributes:
        name: as used in study files and on the command line.
        title: as in ISO/TS 15066.
        stiffness: k_h [N/m].
        effective_mass: m_h, which moves with the region when it is not clamped [kg].
        quasi_static_limit: force limit when pressed or clamped [N].
        transient_limit: force limit of a short free impact [N], None where none is given.
        damping: c_h [N·s/m].
        permitted: False where contact may not happen at all, whatever the force; the
            quasi-static limit is then for reference alone.
        quasi_static_pressure: limit [Pa]; of a region, that of its most sensitive area; None where
            none is given.
        transient_pressure: limit [Pa], None where none is given.
        energy_limit: of the energy that the impact leaves in the region [J], None where none was
            found.
        region: name of the region that an area belongs to.
        skin: law of contact of its own; None: the ``Contact``'s Hertz stiffness.
        plate_mass: of a plate between skin and spring, as measuring devices have [kg].
    """

    name: str
    title: str
    stiffness: float
    effective_mass: float
    quasi_static_limit: float
    transient_limit: float | None
    damping: float = TISSUE_DAMPING
    permitted: bool = True
    quasi_static_pressure: float | None = None
    transient_pressure: float | None = None
    energy_limit: float | None = None
    region: str = ""
    skin: Law | None = None
    plate_mass: float = 0.0

    @property
    def force_limit(self) -> float:
        """Limit for the first milliseconds [N]: transient, or quasi-static where that is all."""
        return self.quasi_static_limit if self.transient_limit is None else self.transient_limit


def read_regions() -> dict[str, BodyRegion]:
    """Return the regions of the table by name, without pressures."""
    return {
        row["name"]: BodyRegion(
            name=row["name"],
            title=row["title"],
            stiffness=1e3 * float(row["stiffness"]),
            effective_mass=float(row["effective_mass"]),
            quasi_static_limit=float(row["force_quasi_static"]),
            transient_limit=number(row["force_transient"]),
            permitted=row["permitted"] == "yes",
            energy_limit=number(row["energy"]),
            region=row["name"],
        )
        for row in table_rows("regions.csv")
    }


def read_areas(regions: dict[str, BodyRegion]) -> dict[str, BodyRegion]:
    """Return the areas of the table by name, each on its region."""
    return {
        row["name"]: replace(
            regions[row["region"]],
            name=row["name"],
            title=row["title"],
            quasi_static_pressure=number(row["pressure_quasi_static"], NEWTON_PER_CM2),
            transient_pressure=number(row["pressure_transient"], NEWTON_PER_CM2),
        )
        for row in table_rows("areas.csv")
    }


def _with_least_pressure(region: BodyRegion) -> BodyRegion:
    inside = [area for area in AREAS.values() if area.region == region.name]

    def least(field: str) -> float | None:
        known = [value for area in inside if (value := getattr(area, field)) is not None]
        return min(known, default=None)

    return replace(
        region,
        quasi_static_pressure=least("quasi_static_pressure"),
        transient_pressure=least("transient_pressure"),
    )


AREAS = read_areas(read_regions())
"""The 29 areas by name, each with its region's spring, mass and force limits."""

REGIONS = {name: _with_least_pressure(region) for name, region in read_regions().items()}
"""The 12 regions by name."""
