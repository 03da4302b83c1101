# SPDX-License-Identifier: BSD-3-Clause
"""What presses on a clamped body later, in C: as Python has it, and kept by allowed speeds."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from compiled_impacts import (
    BOUNDED,
    DRIVEN,
    FREE,
    FREE_OR_DRIVEN,
    OK,
    OUT_OF_RANGE,
    Impacts,
    Motion,
    impacts,
    packed_params,
)
from compiled_packages import KINDS, Generated
from impact_models import model_of

from softimpact.codegen.inputs.samples import Sample
from softimpact.simulate import Approach
from softimpact.simulate.many import many_peaks
from softimpact.simulate.stepping import ManyPeaks
from softimpact.symbolic import Contact, Motors, body_region
from softimpact.symbolic.robot.rigid import Array

NEVER = 5.0
KEPT = 1.002
"""Share of a limit up to which Python's forces of C's speeds may come."""


def asked(
    compiled: Impacts, function: str, sample: Sample, *numbers: float, region: Any, motion: Motion
) -> tuple[int, Array]:
    """Return the status of a function of the tip, and the numbers written."""
    real, kind = KINDS[compiled.real]
    out = np.full(4, np.nan, dtype=kind)
    q, n = (np.array(v, dtype=kind) for v in (sample.q, sample.n))
    status = compiled.entry(function)(
        ctypes.c_void_p(q.ctypes.data), 0, ctypes.c_void_p(n.ctypes.data),
        *(real(x) for x in numbers), ctypes.byref(region),
        packed_params(compiled.package, sample.parameters, motion, compiled.real),
        ctypes.c_void_p(out.ctypes.data),
    )  # fmt: skip
    return status, out.astype(float)


def peaks(compiled: Impacts, sample: Sample, speed: float, kind: Any, reaction: float) -> ManyPeaks:
    """Return peak and pressing force of an impact on a clamped hand by Python."""
    return many_peaks(
        model_of(compiled, sample),
        Approach(sample.q, sample.n, speed),
        Contact(body_region("hand")),
        [speed],
        motors=Motors(kind, reaction),
        horizon=0.5,
    )


@pytest.mark.slow
@pytest.mark.parametrize("real", ["double", "float"])
def test_pressing_forces_are_pythons(package: Callable[[str], Generated], real: str) -> None:
    compiled, pressed = Impacts(package("panda"), real), 0
    region = compiled.region("hand", clamped=True)
    for k, case in enumerate(impacts(compiled.package, 3, seed=51)):
        number, kind, reaction = ((FREE, "free", 0.02), (DRIVEN, "driven", NEVER),
                                  (DRIVEN, "driven", 0.49))[k % 3]  # fmt: skip
        motion = Motion(number, reaction, 0.5, 100_000)
        status, (force, *_) = asked(
            compiled, "pressing_force_at", case.sample, 0.1, region=region, motion=motion
        )
        right = peaks(compiled, case.sample, 0.1, kind, reaction)
        assert status == OK
        off = (force - right.pressing[0]) / right.peak[0]
        assert -3e-3 < off < 1e-2  # a force that falls in the step at 0.5 s is taken to fall evenly
        pressed += right.pressing[0] > 1
    assert pressed >= 1
    region.clamped = 0
    status, (force, *_) = asked(
        compiled, "pressing_force_at", case.sample, 0.1, region=region, motion=motion
    )
    assert (status, force) == (OK, 0.0)


@pytest.mark.parametrize("real", ["double", pytest.param("float", marks=pytest.mark.slow)])
def test_allowed_speeds_keep_both_limits(package: Callable[[str], Generated], real: str) -> None:
    compiled, decided = Impacts(package("panda"), real), set()
    region = compiled.region("hand", clamped=True)
    for k, case in enumerate(impacts(compiled.package, 4, seed=52)):
        reaction = (0.02, NEVER)[k % 2]
        motion = Motion(FREE_OR_DRIVEN, reaction, 0.5, 100_000)
        status, out = asked(compiled, "allowed_speed_at", case.sample, region=region, motion=motion)
        plain = compiled.call("safe_speed", case.sample, region.force_limit, region, motion)
        assert status == OK
        assert out[0] <= plain[1][0]
        ends = [peaks(compiled, case.sample, out[0], kind, reaction) for kind in ("free", "driven")]
        share = max(h.peak[0] / region.force_limit for h in ends)
        later = max(h.pressing[0] / region.quasi_static_limit for h in ends)
        assert max(share, later) <= KEPT
        assert max(share, later) > 0.97
        decided.add(bool(out[0] < plain[1][0]))
        assert (later > share) == (out[0] < plain[1][0])
    assert decided == {True, False}


def test_factors_keep_both_limits_of_a_motion(package: Callable[[str], Generated]) -> None:
    compiled = Impacts(package("panda"), "double")
    region, random, decided = compiled.region("hand", clamped=True), np.random.default_rng(5), set()
    for k, case in enumerate(impacts(compiled.package, 6, seed=55)):
        motion = Motion(DRIVEN, (0.02, NEVER)[k % 2], 0.5, 100_000)
        p = packed_params(compiled.package, case.sample.parameters, motion, "double")
        q, dq = np.array(case.sample.q), random.normal(size=7)

        def asked_of(
            function: str, rates: Array, *number: float, p: Any = p, q: Array = q
        ) -> Array:
            out = np.zeros(5)
            status = compiled.entry(function)(
                ctypes.c_void_p(q.ctypes.data), ctypes.c_void_p(rates.ctypes.data),
                *(ctypes.c_double(x) for x in number), ctypes.byref(region), p,
                ctypes.c_void_p(out.ctypes.data),
            )  # fmt: skip
            assert status in (OK, BOUNDED)
            return out

        factor = asked_of("allowed_factor", dq)[0]
        transient = asked_of("speed_factor", dq, region.force_limit)[0]
        assert 0 < factor <= transient
        limit = region.quasi_static_limit
        may = [asked_of("may_press", dq * f, limit).view(np.int32)[0] for f in (factor, transient)]
        assert may[0] == 0
        assert bool(may[1]) == (factor < transient)
        decided.add(bool(may[1]))
    assert decided == {True, False}


def test_limits_that_are_none_are_refused(package: Callable[[str], Generated]) -> None:
    compiled = Impacts(package("panda"), "double")
    sample = impacts(compiled.package, 1, seed=53)[0].sample
    region, motion = compiled.region("hand", clamped=True), Motion()
    region.quasi_static_limit = 0.0

    def call() -> tuple[int, Array]:
        return asked(compiled, "allowed_speed_at", sample, region=region, motion=motion)

    status, out = call()
    assert status == OUT_OF_RANGE
    assert np.isnan(out).all()
    region.clamped = 0
    assert call()[0] == OK
    region.force_limit = -1.0
    assert call()[0] == OUT_OF_RANGE
