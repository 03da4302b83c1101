# SPDX-License-Identifier: BSD-3-Clause
"""Peak forces and safe speeds in C: right, on the safe side, and bounded."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from adversarial.cases import Cases, stacked
from adversarial.draw import Draw
from adversarial.impacts import Robot
from adversarial.plain import plain_forces
from compiled_impacts import (
    BOUNDED,
    DRIVEN,
    FREE,
    FREE_OR_DRIVEN,
    OK,
    SERVO,
    SINGULAR,
    Impacts,
    Motion,
    impacts,
    packed_params,
)
from compiled_packages import KINDS, Generated

from softimpact.codegen.inputs.parameters import parameters_of
from softimpact.symbolic import REGIONS, Contact, body_region
from softimpact.symbolic.robot.rigid import Array

ACCURACY = 2e-3
"""The design's bound of a peak force's error."""

HARD = 100.0
"""Damping of a body [N·s/m] that feels modes of which float keeps no digits."""

CHATTERS = 8e-3
"""Most that a force is off after many contacts, each of which doubles small errors."""


def drawn(robot: Robot, random: np.random.Generator, count: int, **fields: Any) -> Cases:
    """Return random inputs whose forces count for 0.1 s, some fields alike."""
    cases = Draw(robot, random, wide=False).cases(count)
    alike = {"horizon": 0.1, "steps": 100_000} | fields
    return replace(
        cases, **{k: np.full(count, v, getattr(cases, k).dtype) for k, v in alike.items()}
    )


def errors(robot: Robot, count: int, seed: int) -> Array:
    """Return the errors of random peak forces of both builds against Runge and Kutta's method."""
    random = np.random.default_rng(seed)
    cases = drawn(robot, random, count)
    speeds = (10 ** random.uniform(-1.3, 0.3, count)).astype(np.float32).astype(float)
    found = {real: robot.peaks(cases, speeds, real) for real in KINDS}
    regular = np.all([status != SINGULAR for status, _ in found.values()], axis=0)
    right = plain_forces(robot, cases, speeds)
    off = []
    for real, (status, force) in found.items():
        bounded = regular & (status == BOUNDED)  # too few digits: stiff springs, a hard damper
        assert real == "float" or not bounded.any()
        assert ((cases.motors == SERVO) | (cases.damping > HARD))[bounded].all()
        assert (force >= right)[bounded].all()
        assert (status[regular & ~bounded] == OK).all()
        off.append((force / right - 1)[regular & ~bounded])
    return np.concatenate(off)


@pytest.mark.parametrize("name", ["panda", pytest.param("ur5", marks=pytest.mark.slow)])
def test_peak_forces_are_right_whatever_motors_do(
    package: Callable[[str], Generated], name: str, tmp_path: Path
) -> None:
    off = abs(errors(Robot(package(name), tmp_path), 60, seed=31))
    assert len(off) > 100
    assert off.mean() < 3e-4
    assert np.quantile(off, 0.98) < ACCURACY
    assert off.max() < CHATTERS


@pytest.mark.slow
@pytest.mark.parametrize("name", ["panda", "ur5", "ur5e"])
def test_many_peak_forces_are_right(
    package: Callable[[str], Generated], name: str, tmp_path: Path
) -> None:
    off = abs(errors(Robot(package(name), tmp_path), 1000, seed=32))
    assert off.mean() < 3e-4
    assert np.quantile(off, 0.98) < ACCURACY
    assert off.max() < 2 * CHATTERS


@pytest.mark.parametrize("name", ["panda", "ur5"])
@pytest.mark.parametrize("real", KINDS)
def test_no_speed_up_to_the_safe_one_exceeds_the_limit(
    package: Callable[[str], Generated], name: str, real: str, tmp_path: Path
) -> None:
    robot, random = Robot(package(name), tmp_path), np.random.default_rng(33)
    cases = drawn(robot, random, 30)
    status, speeds = robot.speeds(cases, real)
    kept = (status == OK) | (status == BOUNDED)
    cases, speeds = cases.take(kept), speeds[kept]
    shares = [np.ones(len(cases)), *random.uniform(0.5, 1, (2, len(cases)))]
    found = [plain_forces(robot, cases, speeds * share) / cases.limit for share in shares]
    assert np.max(found) <= 1
    assert np.median(found[0]) > 0.98  # and no slower than need be


def test_bracket_is_the_worse_of_free_and_driven(package: Callable[[str], Generated]) -> None:
    compiled, seen = Impacts(package("panda"), "double"), set()
    for case in impacts(compiled.package, 24, seed=5):
        ends = [compiled.peak_force(replace(case, motors=m)) for m in ("free", "driven")]
        status, (both, _) = compiled.peak_force(replace(case, motors="free_or_driven"))
        if status == SINGULAR:
            continue
        forces = [out[0] for _, out in ends]
        assert both == max(forces)
        seen.add(int(np.argmax(forces)))
        limit = REGIONS["chest"].force_limit
        speeds = [
            compiled.safe_speed(replace(case, motors=m), limit)[1][0]
            for m in ("free", "driven", "free_or_driven")
        ]
        assert speeds[2] <= 1.02 * min(speeds[:2])
    assert 1 in seen


def test_motors_released_at_once_are_free_ones(package: Callable[[str], Generated]) -> None:
    compiled = Impacts(package("panda"), "double")
    for case in impacts(compiled.package, 6, seed=6):
        at_once = replace(case, motors="driven", reaction_time=0.0)
        assert (
            compiled.peak_force(at_once)[1][0]
            == compiled.peak_force(replace(case, motors="free"))[1][0]
        )


def test_a_stiff_servo_is_a_motor_that_drives_on(package: Callable[[str], Generated]) -> None:
    compiled = Impacts(package("panda"), "double")
    for case in impacts(compiled.package, 6, seed=7):
        names = [p.name for p in parameters_of(compiled.package.robot)]
        stiff = list(case.sample.parameters)
        stiff[names.index("position_gain")] = (1e8,) * 7
        stiff[names.index("damping_gain")] = (0.0,) * 7
        servo = replace(case, sample=replace(case.sample, parameters=tuple(stiff)))
        found = [
            compiled.peak_force(replace(servo, motors=m, reaction_time=1.0), 1_000_000)[1][0]
            for m in ("servo", "driven")
        ]
        assert found[0] == pytest.approx(found[1], rel=5e-3)


@pytest.mark.parametrize("real", ["double", "float"])
def test_bound_holds_where_the_budget_ends(
    package: Callable[[str], Generated], real: str, tmp_path: Path
) -> None:
    robot, random, count = Robot(package("panda"), tmp_path), np.random.default_rng(35), 20
    steps = (10 ** random.uniform(0, 2.3, count)).astype(np.int32)
    cases = replace(drawn(robot, random, count), steps=steps)
    speeds = (10 ** random.uniform(-1.3, 0.3, count)).astype(np.float32).astype(float)
    status, force = robot.peaks(cases, speeds, real)
    found, safe = robot.speeds(cases, real)
    for one in (status, found):
        assert set(one) <= {OK, BOUNDED, SINGULAR}
        assert BOUNDED in one
    kept = np.where(status == OK, 1 - CHATTERS, 1.0)
    regular = status != SINGULAR
    right = plain_forces(robot, cases, speeds)
    assert (force >= right * kept)[regular].all()
    assert (plain_forces(robot, cases, safe) <= cases.limit)[found != SINGULAR].all()


def test_more_steps_than_its_budget_no_call_takes(package: Callable[[str], Generated]) -> None:
    """By its clock: a call of any input takes little longer for each step it may."""
    compiled = Impacts(package("panda"), "float")
    case = impacts(compiled.package, 1, seed=3)[0]
    long = replace(case, horizon=1e3, motors="servo", reaction_time=1e3)
    assert compiled.safe_speed(long, 50.0, 100)[0] == BOUNDED
    assert compiled.peak_force(long, 100)[0] == BOUNDED


@pytest.mark.slow
def test_float_is_as_right_as_double_where_rotors_are_heavy_and_springs_stiff(
    package: Callable[[str], Generated], tmp_path: Path
) -> None:
    """An arm whose last links weigh next to nothing beside their rotors."""
    robot = Robot(package("ur5e"), tmp_path)
    rotors = np.array(robot.package.robot.armature)
    usual = {
        "q": [-0.12, 1.13, 0.91, -1.85, -0.01, -1.87], "n": [-0.99, -0.79, 0.96],
        "rotors": np.where(rotors > 0, rotors, 0.3), "gains": [0.0] * 6, "damping_gains": [0.0] * 6,
        "reaction": 0.02, "horizon": 0.1, "stiffness": 1e4, "damping": 10.0, "mass": 0.0,
        "limit": 220.0,
    }  # fmt: skip
    cases = stacked([
        {**usual, "springs": [stiffness] * 6, "motors": motors}
        for stiffness in (1e4, 1e5, 1e6) for motors in (FREE, DRIVEN, FREE_OR_DRIVEN)
    ]).rounded()  # fmt: skip
    speeds = []
    for real in KINDS:
        status, found = robot.speeds(cases, real)
        assert (status == OK).all()
        assert (plain_forces(robot, cases, found) <= cases.limit).all()
        speeds.append(found)
    np.testing.assert_allclose(speeds[0], speeds[1], rtol=0.02)


def test_force_grows_with_speed_between_a_linear_and_a_hertz_contact(
    package: Callable[[str], Generated],
) -> None:
    compiled = Impacts(package("panda"), "double")
    sample = impacts(compiled.package, 8, seed=2)[1].sample
    for clamped in (False, True):
        region = compiled.region("chest", clamped)
        (fast, time), (slow, _) = (
            compiled.call("peak_force", sample, speed, region, Motion())[1] for speed in (0.5, 0.25)
        )
        assert 0 < time < 0.1
        assert 2 <= fast / slow <= 2 * 2**0.2


def test_regions_are_those_of_the_model(package: Callable[[str], Generated]) -> None:
    compiled = Impacts(package("rr"), "double")
    for name in REGIONS:
        ours, theirs = compiled.region(name, clamped=True), body_region(name)
        assert ours.clamped == 1
        assert ours.stiffness == theirs.stiffness
        assert ours.damping == theirs.damping
        assert ours.effective_mass == theirs.effective_mass
        assert ours.force_limit == theirs.force_limit
        assert ours.quasi_static_limit == theirs.quasi_static_limit
        assert ours.hertz_stiffness == Contact(theirs).hertz_stiffness


def test_impacts_on_bodies_of_any_stiffness_are_right(
    package: Callable[[str], Generated], tmp_path: Path
) -> None:
    robot, count = Robot(package("panda"), tmp_path), 9
    cases = drawn(robot, np.random.default_rng(3), count, damping=0.0, mass=0.0, reaction=0.02)
    kinds = np.array([FREE, DRIVEN, SERVO] * 3, np.int32)
    cases = replace(cases, stiffness=np.repeat([1e3, 1e5, 1e8], 3), motors=kinds)
    speeds = np.full(count, 0.5)
    status, force = robot.peaks(cases, speeds, "double")
    assert (status == OK).all()
    np.testing.assert_allclose(force, plain_forces(robot, cases, speeds), rtol=ACCURACY)


@pytest.mark.parametrize("real", ["double", "float"])
def test_speed_factor_is_the_safe_speed_over_the_speed_there_is(
    package: Callable[[str], Generated], real: str
) -> None:
    compiled = Impacts(package("panda"), real)
    c_real, kind = KINDS[real]
    random, factors = np.random.default_rng(8), []
    region = compiled.region("chest", clamped=True)
    limit = region.force_limit
    for case in impacts(compiled.package, 16, seed=9):
        q = np.array(case.sample.q, dtype=kind)
        dq = (random.normal(size=7) * 10 ** random.uniform(-1.5, 0.3)).astype(kind)
        J = np.zeros((3, 7), dtype=kind)
        compiled.entry("jacobian")(ctypes.c_void_p(q.ctypes.data), ctypes.c_void_p(J.ctypes.data))
        velocity = J.astype(float) @ dq.astype(float)
        speed = float(np.linalg.norm(velocity))
        motion = Motion(FREE_OR_DRIVEN, 0.02, 0.1)
        sample = replace(case.sample, n=tuple(velocity.tolist()))
        status, (safe, _) = compiled.call("safe_speed", sample, limit, region, motion)
        if status != OK:
            continue
        out = _Factor(real)
        p = packed_params(compiled.package, case.sample.parameters, motion, real)
        vectors = [ctypes.c_void_p(v.ctypes.data) for v in (q, dq)]
        status = compiled.entry("speed_factor")(
            *vectors, c_real(limit), ctypes.byref(region), p, ctypes.byref(out.struct)
        )
        assert status == OK
        assert out.struct.point == 0
        assert out.struct.factor == pytest.approx(min(1.0, safe / speed), rel=0.02)
        factors.append(out.struct.factor)
        still = np.zeros(7, dtype=kind)
        rest = [ctypes.c_void_p(v.ctypes.data) for v in (q, still)]
        assert compiled.entry("speed_factor")(
            *rest, c_real(limit), ctypes.byref(region), p, ctypes.byref(out.struct)
        ) == OK  # fmt: skip
        assert (out.struct.factor, out.struct.point) == (1.0, -1)
    assert min(factors) < 0.5 < max(factors)
    assert 1.0 in factors


class _Factor:
    """The result of ``speed_factor``."""

    def __init__(self, real: str) -> None:
        kind = KINDS[real][0]
        fields = [("factor", kind), ("point", ctypes.c_int), ("speed", kind), ("force", kind)]
        self.struct: Any = type("Factor", (ctypes.Structure,), {"_fields_": fields})()


def test_undamped_springs_alone_obey_the_energy(package: Callable[[str], Generated]) -> None:
    """The force on the softest bodies goes with the root of their stiffness."""
    compiled = Impacts(package("panda"), "double")
    sample = impacts(compiled.package, 2, seed=3)[1].sample
    soft = compiled.region("abdomen", clamped=True)
    forces = []
    for soft.stiffness in (1e-1, 1e-3):
        soft.damping = 0.0
        motion = Motion(FREE, 0.02, 40 / math.sqrt(soft.stiffness), 100_000)
        forces.append(compiled.call("peak_force", sample, 0.5, soft, motion)[1][0])
    assert forces[0] / forces[1] == pytest.approx(10, rel=1e-2)
