# SPDX-License-Identifier: BSD-3-Clause
"""Contact points given at run time, and the direction in which a point hits hardest."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from compiled_impacts import (
    AXES,
    DRIVEN,
    FREE,
    NOT_FINITE,
    OK,
    OUT_OF_RANGE,
    SINGULAR,
    Impacts,
    Motion,
    impacts,
    packed_params,
)
from compiled_packages import KINDS, Generated
from impact_models import model_of

from softimpact.codegen.verification.impacts import draw_impacts
from softimpact.simulate import Approach
from softimpact.simulate.many import many_peaks
from softimpact.symbolic import Contact, ImpactModel, Motors, body_region
from softimpact.symbolic.impact.motors import MotorKind
from softimpact.symbolic.robot.rigid import Array


def call(
    compiled: Impacts,
    function: str,
    sample: Any,
    frame: int,
    place: Array,
    *more: Any,
    size: int = 2,
) -> tuple[int, Array]:
    """Return the status of a function of a place, and the numbers written."""
    kind = KINDS[compiled.real][1]
    out = np.full(size, np.nan, dtype=kind)
    q, at = (np.array(v, dtype=kind) for v in (sample.q, place))
    given = [
        ctypes.c_void_p(x.ctypes.data) if isinstance(x, np.ndarray)
        else KINDS[compiled.real][0](x) if isinstance(x, float) else x for x in more
    ]  # fmt: skip
    status = compiled.entry(function)(
        ctypes.c_void_p(q.ctypes.data), frame, ctypes.c_void_p(at.ctypes.data), *given,
        ctypes.c_void_p(out.ctypes.data),
    )  # fmt: skip
    return status, out.astype(float)


@pytest.mark.parametrize(
    ("robot", "frames", "real"),
    [
        ("panda", ("link5", "hand", "link4"), "double"),
        pytest.param("panda", ("hand_tcp", "link6"), "float", marks=pytest.mark.slow),
        pytest.param("gantry", ("tip", "probe"), "double", marks=pytest.mark.slow),
    ],
)
def test_a_place_on_any_link_is_as_if_it_were_the_tip(
    package: Callable[[str], Generated], robot: str, frames: Sequence[str], real: str
) -> None:
    compiled, random = Impacts(package(robot), real), np.random.default_rng(3)
    numbers, contact = compiled.package.interface.enums["frame"], Contact(body_region("chest"))
    region, seen = compiled.region("chest", clamped=True), 0
    drawn = draw_impacts(compiled.package.robot, compiled.package.parameters, np.eye(3), 4, 7)
    for k, case in enumerate(drawn):
        name, place = frames[k % len(frames)], random.uniform(-0.2, 0.2, 3).round(3)
        kind: MotorKind = ("free", "driven")[k % 2]
        number = (FREE, DRIVEN)[k % 2]
        motion = Motion(number, 0.02, 0.1, 100_000)
        p = packed_params(compiled.package, case.sample.parameters, motion, real)
        n = np.array(case.sample.n, dtype=KINDS[real][1])
        at = (case.sample, numbers[f"FRAME_{name.upper()}"], place, n)
        status, (force, _) = call(compiled, "peak_force_on", *at, 0.4, ctypes.byref(region), p)
        if status == SINGULAR:
            continue
        model = model_of(compiled, case.sample)
        x, y, z = place.tolist()
        there = ImpactModel(
            model.robot, model.robot.frame(f"{name}@{x},{y},{z}").name, model.drives
        )
        approach, motors = Approach(case.sample.q, case.sample.n, 0.4), Motors(kind, 0.02)
        right = many_peaks(there, approach, contact, [0.4], motors=motors, horizon=0.1).peak[0]
        assert status == OK
        assert force == pytest.approx(right, rel=4e-3)
        status, (speed, at_it) = call(
            compiled, "safe_speed_on", *at, float(force), ctypes.byref(region), p
        )
        assert status == OK
        assert 0.96 * 0.4 < speed <= 0.4
        assert at_it <= force
        seen += 1
    assert seen >= 2


def test_no_direction_is_much_harder_than_the_worst(package: Callable[[str], Generated]) -> None:
    compiled, random = Impacts(package("panda"), "double"), np.random.default_rng(5)
    frame = compiled.package.interface.enums["frame"]["FRAME_LINK6"]
    region, place = compiled.region("hand", clamped=False), np.array([0.02, 0.0, -0.03])
    drawn = draw_impacts(compiled.package.robot, compiled.package.parameters, np.eye(3), 2, 8)
    for case in drawn:
        motion = Motion(FREE, 0.02, 0.05, 100_000)
        p = packed_params(compiled.package, case.sample.parameters, motion, "double")
        more, at = (0.4, ctypes.byref(region), p), (case.sample, frame, place)
        status, found = call(compiled, "worst_direction_on", *at, *more, size=5)
        assert status == OK
        assert np.linalg.norm(found[:3]) == pytest.approx(1)
        n = np.ascontiguousarray(found[:3])
        _, (again, _) = call(compiled, "peak_force_on", *at, n, *more)
        assert again == pytest.approx(found[3], rel=1e-9)
        tried = [
            call(compiled, "peak_force_on", *at, random.normal(size=3), *more) for _ in range(800)
        ]
        hardest = max(out[0] for status, out in tried if status == OK)
        assert 0.9 * found[3] < hardest <= found[3] * (1 + found[4])


@pytest.mark.parametrize("robot", ["rr", "rmin"])
def test_the_worst_direction_of_a_plane_lies_in_it(
    package: Callable[[str], Generated], robot: str
) -> None:
    """Of the package's own point, whose directions are a circle's."""
    compiled = Impacts(package(robot), "double")
    case, region = impacts(compiled.package, 1, seed=10)[0], compiled.region("hand", clamped=True)
    motion, q = Motion(FREE, 0.02, 0.05, 100_000), np.array(case.sample.q)
    out = np.full(5, np.nan)
    status = compiled.entry("worst_direction_at")(
        ctypes.c_void_p(q.ctypes.data), 0, ctypes.c_double(0.4), ctypes.byref(region),
        packed_params(compiled.package, case.sample.parameters, motion, "double"),
        ctypes.c_void_p(out.ctypes.data),
    )  # fmt: skip
    assert status == OK
    assert out[({*range(3)} - {*AXES[robot]}).pop()] == 0
    angles = np.linspace(0, np.pi, 60)
    forces = []
    for angle in angles:
        n = np.zeros(3)
        n[AXES[robot]] = np.cos(angle), np.sin(angle)
        sample = replace(case.sample, n=tuple(n.tolist()))
        status, (force, _) = compiled.call("peak_force", sample, 0.4, region, motion)
        forces += [force] if status == OK else []
    assert 0.97 * out[3] < max(forces) <= out[3] * (1 + out[4])


def test_places_that_are_none_are_refused(package: Callable[[str], Generated]) -> None:
    compiled = Impacts(package("panda"), "double")
    case = draw_impacts(compiled.package.robot, compiled.package.parameters, np.eye(3), 1, 9)[0]
    region = compiled.region("hand", clamped=True)
    p = packed_params(compiled.package, case.sample.parameters, Motion(), "double")
    more = (np.array(case.sample.n), 0.4, ctypes.byref(region), p)
    count = len(compiled.package.interface.enums["frame"])
    for frame, place, expected in (
        (count, np.zeros(3), OUT_OF_RANGE),
        (-1, np.zeros(3), OUT_OF_RANGE),
        (0, np.array([0, np.nan, 0]), NOT_FINITE),
    ):
        status, out = call(compiled, "peak_force_on", case.sample, frame, place, *more)
        assert status == expected
        assert np.isnan(out).all()


def test_closed_chains_have_no_such_places(package: Callable[[str], Generated]) -> None:
    assert "peak_force_on" not in package("rmin").interface.entries
