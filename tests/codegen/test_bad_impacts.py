# SPDX-License-Identifier: BSD-3-Clause
"""Bad impacts in C: a status, nothing written, and no number that is not finite."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from compiled_impacts import (
    AXES,
    BOUNDED,
    NOT_FINITE,
    OK,
    OUT_OF_RANGE,
    SINGULAR,
    ZERO_DIRECTION,
    Impacts,
    Motion,
    impacts,
)
from compiled_packages import Generated

from softimpact.codegen.inputs.parameters import parameters_of
from softimpact.codegen.inputs.samples import Sample


@pytest.mark.parametrize("robot", ["panda", "rmin"])
@pytest.mark.parametrize("function", ["peak_force", "safe_speed"])
def test_bad_impacts_return_a_status_and_write_nothing(
    package: Callable[[str], Generated], function: str, robot: str
) -> None:
    generated = package(robot)
    compiled = Impacts(generated, "double")
    case = impacts(generated, 1, seed=3)[0]
    good, plain = compiled.region("head", clamped=False), Motion()
    nan = float("nan")
    assert compiled.call(function, case.sample, 0.5, good, plain)[0] == OK

    def region(**changes: float) -> Any:
        changed = compiled.region("head", clamped=False)
        for field, value in changes.items():
            setattr(changed, field, value)
        return changed

    cases = [
        (case.sample, 0.0, good, plain, OUT_OF_RANGE),
        (case.sample, -1.0, good, plain, OUT_OF_RANGE),
        (case.sample, nan, good, plain, NOT_FINITE),
        (replace(case.sample, n=(0.0, 0.0, 0.0)), 1.0, good, plain, ZERO_DIRECTION),
        (replace(case.sample, q=(nan,) * generated.robot.n), 1.0, good, plain, NOT_FINITE),
        (case.sample, 1.0, region(stiffness=0), plain, OUT_OF_RANGE),
        (case.sample, 1.0, region(damping=-1), plain, OUT_OF_RANGE),
        (case.sample, 1.0, region(effective_mass=0), plain, OUT_OF_RANGE),
        (case.sample, 1.0, region(hertz_stiffness=nan), plain, NOT_FINITE),
        (case.sample, 1.0, good, replace(plain, motors=4), OUT_OF_RANGE),
        (case.sample, 1.0, good, replace(plain, motors=-1), OUT_OF_RANGE),
        (case.sample, 1.0, good, replace(plain, reaction_time=-1e-3), OUT_OF_RANGE),
        (case.sample, 1.0, good, replace(plain, horizon=nan), NOT_FINITE),
        (case.sample, 1.0, good, replace(plain, horizon=0.0), OUT_OF_RANGE),
        (case.sample, 1.0, good, replace(plain, steps=0), OUT_OF_RANGE),
    ]
    for sample, number, body, motion, expected in cases:
        status, out = compiled.call(function, sample, number, body, motion)
        assert status == expected
        assert np.isnan(out).all()
    clamped = region(effective_mass=0, clamped=1)
    assert compiled.call(function, case.sample, 0.5, clamped, plain)[0] == OK
    undamped = region(damping=0)
    assert compiled.call(function, case.sample, 0.5, undamped, plain)[0] == OK


@pytest.mark.parametrize("robot", ["rr", "rmin"])
def test_impacts_out_of_the_plane_of_motion_are_singular(
    package: Callable[[str], Generated], robot: str
) -> None:
    compiled = Impacts(package(robot), "double")
    case = impacts(compiled.package, 1, seed=3)[0]
    beside = np.where(np.isin(range(3), AXES[robot]), case.sample.n, 0.1)
    tilted = replace(case, sample=replace(case.sample, n=tuple(beside.tolist())))
    assert compiled.peak_force(case)[0] == OK
    assert compiled.peak_force(tilted)[0] == SINGULAR


@pytest.mark.parametrize("real", ["double", "float"])
@pytest.mark.parametrize("robot", ["panda", "rr"])
def test_any_bits_give_finite_impacts_or_a_status(
    package: Callable[[str], Generated], robot: str, real: str
) -> None:
    generated = package(robot)
    compiled = Impacts(generated, real)
    n, fields = generated.robot.n, len(parameters_of(generated.robot))
    kind, bits = (np.float64, np.uint64) if real == "double" else (np.float32, np.uint32)
    random = np.random.default_rng(12)
    seen = set()
    for k in range(400):
        count = n + 3 + fields * n + 9
        numbers = random.integers(0, np.iinfo(bits).max, count, dtype=bits).view(kind)
        numbers = np.where(random.random(count) < 0.95, abs(numbers), numbers)
        numbers = np.where(np.isfinite(numbers), numbers, 1).astype(float)
        if k % 2:  # of a size that lets impacts begin
            numbers = np.exp(np.clip(np.log(abs(numbers) + 1e-30) / (5 + k % 40), -20, 20))
        if robot == "rr":
            numbers[n + 2] = 0
        q, direction, rest = np.split(numbers, [n, n + 3])
        parameters = rest[: fields * n].reshape(-1, n)
        sample = Sample(tuple(q), tuple(direction), tuple(map(tuple, parameters)))
        region = compiled.region("chest", clamped=bool(k % 3))
        names = ("stiffness", "damping", "effective_mass", "hertz_stiffness")
        for name, value in zip(names, rest[fields * n : fields * n + 4], strict=True):
            setattr(region, name, value)
        motion = Motion(k % 4, float(rest[-3]), float(rest[-2]), 300)
        for function in ("peak_force", "safe_speed"):
            status, out = compiled.call(function, sample, rest[-1], region, motion)
            written = status in (OK, BOUNDED)
            assert np.isfinite(out).all() if written else np.isnan(out).all()
            assert not written or (out[0] > 0 and out[1] >= 0)
            seen.add(status)
    assert SINGULAR in seen
    assert {OK, BOUNDED} & seen
