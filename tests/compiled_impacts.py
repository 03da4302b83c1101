# SPDX-License-Identifier: BSD-3-Clause
"""Impacts of a compiled package, called through ctypes."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from compiled_packages import KINDS, Generated

from softimpact.codegen.inputs.parameters import parameters_of
from softimpact.codegen.inputs.samples import Sample
from softimpact.codegen.verification.impacts import Impact, draw_impacts
from softimpact.symbolic import REGIONS
from softimpact.symbolic.robot.rigid import Array

OK, NULL_POINTER, NOT_FINITE, ZERO_DIRECTION, OUT_OF_RANGE, SINGULAR = range(6)
UNRESOLVED, BOUNDED = 8, 9
FREE_OR_DRIVEN, FREE, DRIVEN, SERVO = range(4)
PARTS = list(REGIONS)

AXES = {"rr": [0, 1], "rmin": [0, 2]}
"""Base axes along which a contact point moves that does not move along all."""


@dataclass(frozen=True)
class Motion:
    """What motors do, for how long forces count, and the budget: the end of a parameter struct."""

    motors: int = FREE
    reaction_time: float = 0.02
    horizon: float = 0.1
    steps: int = 4000


def packed_params(
    package: Generated, parameters: Sequence[Sequence[float]], motion: Motion, real: str
) -> ctypes.c_char_p:
    """Return a parameter struct."""
    return ctypes.c_char_p(package.params(real, parameters, **vars(motion)).tobytes())


@dataclass(frozen=True, eq=False)
class Impacts:
    """``peak_force`` and ``safe_speed`` of a compiled package."""

    package: Generated
    real: str

    @cached_property
    def library(self) -> ctypes.CDLL:
        """The compiled package."""
        return self.package.load(self.real).library

    def entry(self, function: str) -> Any:
        """Return a function."""
        return getattr(self.library, f"{self.package.manifest.name}_{function}")

    def region(self, name: str, clamped: bool) -> Any:
        """Return a region's struct."""
        region = region_type(self.real)()
        entry = self.entry("body_region")
        assert entry(PARTS.index(name), int(clamped), ctypes.byref(region)) == OK
        return region

    def call(
        self,
        function: str,
        sample: Sample,
        number: float,
        region: Any,
        motion: Motion | None = None,
    ) -> tuple[int, Array]:
        """Return the status and the two numbers written, NaN if none were."""
        real, kind = KINDS[self.real]
        out = np.full(2, np.nan, dtype=kind)
        q, n = (np.array(v, dtype=kind) for v in (sample.q, sample.n))
        p = packed_params(self.package, sample.parameters, motion or Motion(), self.real)
        status = self.entry(function)(
            *(ctypes.c_void_p(v.ctypes.data) for v in (q, n)),
            real(number),
            ctypes.byref(region),
            p,
            ctypes.c_void_p(out.ctypes.data),
        )
        return status, out.astype(float)

    def peak_force(self, case: Impact, steps: int = 4000) -> tuple[int, Array]:
        """Return status, peak force [N] and its time [s]."""
        region = self.region(case.region.name, case.clamped)
        motion = Motion(case.kind, case.reaction_time, case.horizon, steps)
        return self.call("peak_force", case.sample, case.speed, region, motion)

    def safe_speed(self, case: Impact, limit: float, steps: int = 4000) -> tuple[int, Array]:
        """Return status, safe speed [m/s] and its force [N]."""
        region = self.region(case.region.name, case.clamped)
        motion = Motion(case.kind, case.reaction_time, case.horizon, steps)
        return self.call("safe_speed", case.sample, limit, region, motion)


def region_type(real: str) -> type[ctypes.Structure]:
    """Return the struct of a region."""
    names = "stiffness damping effective_mass hertz_stiffness quasi_static_limit force_limit"
    fields = [(name, KINDS[real][0]) for name in names.split()]
    law = [("law", ctypes.c_void_p), ("law_points", ctypes.c_int), ("clamped", ctypes.c_int)]
    return type("Region", (ctypes.Structure,), {"_fields_": [*fields, *law]})


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
    motion: Motion | None = None,
) -> tuple[int, ctypes.Structure]:
    """Return status and choice among poses that strike a held chest."""
    real, kind = KINDS[compiled.real]
    out = selection(compiled.real)
    rows, along = (np.ascontiguousarray(x, kind) for x in (poses, n))
    mask = None if allowed is None else allowed.astype(np.uint8)
    status = compiled.entry("select_configuration")(
        ctypes.c_void_p(rows.ctypes.data),
        len(rows),
        None if mask is None else ctypes.c_void_p(mask.ctypes.data),
        ctypes.c_void_p(along.ctypes.data),
        real(speed),
        ctypes.byref(compiled.region("chest", clamped=True)),
        packed_params(compiled.package, list(parameters), motion or Motion(), compiled.real),
        ctypes.byref(out),
    )
    return status, out


def impacts(package: Generated, count: int, seed: int) -> list[Impact]:
    """Return random impacts."""
    directions = np.eye(3)[AXES.get(package.manifest.name, [0, 1, 2])]
    return draw_impacts(package.robot, parameters_of(package.robot), directions, count, seed)
