# SPDX-License-Identifier: BSD-3-Clause
"""Impacts of a compiled package, called through ctypes."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from compiled_packages import KINDS, Generated

from softimpact.codegen.impact_error import Impact
from softimpact.codegen.manifest import ImpactRecord
from softimpact.codegen.samples import Sample
from softimpact.symbolic import REGIONS
from softimpact.symbolic.robot.rigid import Array

OK, NULL_POINTER, NOT_FINITE, ZERO_DIRECTION, OUT_OF_RANGE, SINGULAR = range(6)
UNRESOLVED = 8
PARTS = list(REGIONS)


@dataclass(frozen=True, eq=False)
class Impacts:
    """``peak_force`` and ``safe_speed`` of a compiled package."""

    package: Generated
    real: str

    @cached_property
    def library(self) -> ctypes.CDLL:
        """The compiled package."""
        return self.package.load(self.real).library

    def region(self, name: str, clamped: bool) -> Any:
        """Return a region's struct."""
        region = region_type(self.real)()
        entry = getattr(self.library, f"{self.package.manifest.name}_body_region")
        assert entry(PARTS.index(name), int(clamped), ctypes.byref(region)) == OK
        return region

    def call(self, function: str, sample: Sample, number: float, region: Any) -> tuple[int, Array]:
        """Return the status and the two numbers written, NaN if none were."""
        real, kind = KINDS[self.real]
        out = np.full(2, np.nan, dtype=kind)
        vectors = [np.array(v, dtype=kind) for v in (sample.q, sample.n)]
        p = np.array(sample.parameters, dtype=kind).ravel()
        entry = getattr(self.library, f"{self.package.manifest.name}_{function}")
        pointers = [ctypes.c_void_p(v.ctypes.data) for v in (*vectors, p, out)]
        place = ctypes.byref(region)
        status = entry(*pointers[:2], real(number), place, *pointers[2:])
        return status, out.astype(float)

    def peak_force(self, case: Impact) -> tuple[int, Array]:
        """Return status, peak force [N] and its time [s]."""
        region = self.region(case.region.name, case.clamped)
        return self.call("peak_force", case.sample, case.speed, region)

    def safe_speed(self, case: Impact, limit: float) -> tuple[int, Array]:
        """Return status, safe speed [m/s] and its force [N]."""
        region = self.region(case.region.name, case.clamped)
        return self.call("safe_speed", case.sample, limit, region)


def region_type(real: str) -> type[ctypes.Structure]:
    """Return the struct of a region."""
    names = "stiffness damping effective_mass hertz_stiffness quasi_static_limit force_limit"
    fields = [(name, KINDS[real][0]) for name in names.split()]
    return type("Region", (ctypes.Structure,), {"_fields_": [*fields, ("clamped", ctypes.c_int)]})


def selection(real: str) -> ctypes.Structure:
    """Return an empty result."""
    kind = KINDS[real][0]
    counts = [(name, ctypes.c_int) for name in ("best", "second", "usable")]
    fields = [*counts, *((name, kind) for name in ("force", "margin"))]
    kept: type[ctypes.Structure] = type("Selection", (ctypes.Structure,), {"_fields_": fields})
    return kept()


def choose(
    compiled: Impacts,
    poses: Array,
    n: Array,
    speed: float,
    parameters: Array,
    allowed: Array | None = None,
) -> tuple[int, ctypes.Structure]:
    """Return status and choice among poses that strike a held chest."""
    real, kind = KINDS[compiled.real]
    out = selection(compiled.real)
    rows, along, p = (np.ascontiguousarray(x, kind) for x in (poses, n, parameters))
    mask = None if allowed is None else allowed.astype(np.uint8)
    entry = getattr(compiled.library, f"{compiled.package.manifest.name}_select_configuration")
    status = entry(
        ctypes.c_void_p(rows.ctypes.data),
        len(rows),
        None if mask is None else ctypes.c_void_p(mask.ctypes.data),
        ctypes.c_void_p(along.ctypes.data),
        real(speed),
        ctypes.byref(compiled.region("chest", clamped=True)),
        ctypes.c_void_p(p.ctypes.data),
        ctypes.byref(out),
    )
    return status, out


def record_of(package: Generated) -> ImpactRecord:
    """Return what a package states of its impacts."""
    assert package.manifest.impact
    return package.manifest.impact
