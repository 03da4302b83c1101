# SPDX-License-Identifier: BSD-3-Clause
"""Measuring devices as bodies, so that a laboratory can compare its reading.

A pad K1, a plate, a spring K2; fixed (``clamped``) or on a slide (free). What the device reads is
the force in its spring.
"""

from __future__ import annotations

import math

from .pads import PADS, Pad
from .regions import REGIONS, BodyRegion
from .tables import table_rows

SPRINGS = tuple(1e3 * float(row["spring"]) for row in table_rows("devices.csv"))
"""K2 of the devices there are [N/m]."""

HEAVIEST = max(region.effective_mass for region in REGIONS.values())
"""Mass of a slide that stands for no region in particular [kg]: the more, the worse."""


def measuring_device(
    spring: float, pad: Pad, plate_mass: float = 0.0, stands_for: BodyRegion | None = None
) -> BodyRegion:
    """Return a measuring device as a body.

    Args:
        spring: K2 [N/m].
        pad: K1.
        plate_mass: between them [kg].
        stands_for: region whose limits hold, and whose mass it slides with; None: no limits.
    """
    name = f"device_{spring / 1e3:g}_{pad.name}"
    title = f"Device, K2 {spring / 1e3:g} N/mm, K1 {pad.name}"
    region = stands_for
    return BodyRegion(
        name=name if region is None else f"{name}_{region.name}",
        title=title if region is None else f"{title}, for {region.title}",
        stiffness=spring,
        effective_mass=HEAVIEST if region is None else region.effective_mass,
        quasi_static_limit=math.inf if region is None else region.quasi_static_limit,
        transient_limit=None if region is None else region.transient_limit,
        damping=0.0,
        permitted=True if region is None else region.permitted,
        quasi_static_pressure=None if region is None else region.quasi_static_pressure,
        transient_pressure=None if region is None else region.transient_pressure,
        energy_limit=None if region is None else region.energy_limit,
        region="" if region is None else region.region,
        skin=pad.law,
        plate_mass=plate_mass,
    )


DEVICES = {
    device.name: device
    for device in (measuring_device(spring, pad) for spring in SPRINGS for pad in PADS.values())
}
"""Every device by name, ``device_75_sh70`` for example."""
