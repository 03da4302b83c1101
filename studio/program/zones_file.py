# SPDX-License-Identifier: BSD-3-Clause
"""Who may be met where: a TOML file of zones, each with the regions of the body to be met there."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from softimpact.simulate.zones import Somebody, Zone
from softimpact.symbolic import Contact, InvalidValue, SoftImpactError, body_region
from softimpact.symbolic.body.laws import Law
from softimpact.symbolic.body.shapes import Shape, shape_from
from softimpact.symbolic.file_section import Finite, why_unreadable

Corner = tuple[Finite, Finite, Finite]


class ZonesFileError(SoftImpactError):
    """A file says nothing of zones."""

    def __init__(self, path: Path, reason: str) -> None:
        super().__init__(f"{path}: {reason}")
        self.path, self.reason = path, reason


class TypedZone(BaseModel):
    """A zone as a file has it."""

    model_config = ConfigDict(extra="forbid")

    name: str
    regions: list[str] = Field(min_length=1)
    box: tuple[Corner, Corner] | None = None
    time: tuple[Finite, Finite] | None = None
    clamped: bool | None = None
    shape: str | None = None

    @model_validator(mode="after")
    def _somewhere(self) -> TypedZone:
        if self.box is None and self.time is None:
            raise ValueError("give a box [[x, y, z], [x, y, z]] (m), a time [from, to] (s) or both")
        return self

    def zone(self) -> Zone:
        """Return it checked; raises InvalidValue."""
        lower, upper = self.box or ((-np.inf,) * 3, (np.inf,) * 3)
        begin, end = self.time or (-np.inf, np.inf)
        zone = Zone(self.name, lower, upper, begin, end)
        zone.check()
        return zone


class ZonesFile(BaseModel):
    """A file: zones, and the regions that may be met everywhere."""

    model_config = ConfigDict(extra="forbid")

    everywhere: list[str] = []
    zones: list[TypedZone] = Field(min_length=1)


def read_zones(
    path: Path, cover: Law | None, clamped: bool, shape: Shape | None
) -> tuple[list[Somebody], list[str]]:
    """Read who may be met where.

    Args:
        path: of a TOML file.
        cover: what the robot wears.
        clamped: whether bodies are held where the file does not say.
        shape: of what touches, where the file does not say.

    Returns:
        Who may be met in zones, and the regions that may be met everywhere.

    Raises:
        ZonesFileError: it is no such file.
        InvalidValue, UnknownName: a zone or a region that cannot be.
        OSError: there is no such file.
    """
    try:
        file = ZonesFile.model_validate(tomllib.loads(path.read_text(encoding="utf-8-sig")))
    except ValueError as error:
        raise ZonesFileError(path, why_unreadable(error)) from None
    by_kind: dict[tuple[str, bool, str | None], list[Zone]] = {}
    for typed in file.zones:
        held = clamped if typed.clamped is None else typed.clamped
        for region in typed.regions:
            by_kind.setdefault((region, held, typed.shape), []).append(typed.zone())
    somebody = [
        Somebody(
            Contact(body_region(region), held, cover=cover),
            shape_from(touching) if touching else shape,
            tuple(zones),
        )
        for (region, held, touching), zones in by_kind.items()
    ]
    if len({zone.name for zone in file.zones}) < len(file.zones):
        raise InvalidValue("zones", "need names of their own")
    return somebody, file.everywhere
