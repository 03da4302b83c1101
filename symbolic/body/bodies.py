# SPDX-License-Identifier: BSD-3-Clause
"""Everything that can be hit, by name."""

from __future__ import annotations

from difflib import get_close_matches

from ..errors import UnknownName
from .devices import DEVICES
from .regions import AREAS, REGIONS, BodyRegion

BODIES = {**REGIONS, **AREAS, **DEVICES}
"""Regions and areas of the body, and measuring devices, by name."""

NEAREST = 5
"""Most names shown before the regions where a name is unknown."""


def body_region(name: str) -> BodyRegion:
    """Return a region, area or device by name; raises UnknownName, the nearest names first."""
    if name not in BODIES:
        holding = [known for known in BODIES if name and name in known]
        near = [*holding, *get_close_matches(name, BODIES)]
        nearest_first = dict.fromkeys([*near[:NEAREST], *REGIONS])
        raise UnknownName("body region", name, nearest_first)
    return BODIES[name]
