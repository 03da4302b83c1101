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
from softimpact.symbolic.rigid import Array

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


def record_of(package: Generated) -> ImpactRecord:
    """Return what a package states of its impacts."""
    assert package.manifest.impact
    return package.manifest.impact
