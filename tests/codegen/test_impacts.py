# SPDX-License-Identifier: BSD-3-Clause
"""Peak forces and safe speeds in C: right, on the safe side, and bounded."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from compiled_impacts import (
    NOT_FINITE,
    OK,
    OUT_OF_RANGE,
    SINGULAR,
    UNRESOLVED,
    ZERO_DIRECTION,
    Impacts,
    record_of,
)
from compiled_packages import Generated, parameter

from softimpact.codegen import impact
from softimpact.codegen.impact_error import Impact, draw_impacts
from softimpact.codegen.inputs import is_elastic, parameters_of
from softimpact.codegen.samples import Sample
from softimpact.simulate import Approach, Fidelity, ImpactHistory, simulate_impact
from softimpact.symbolic import (
    REGIONS,
    Contact,
    Drives,
    ImpactModel,
    Robot,
    body_region,
    closed_chain,
    closed_near,
    configuration_at_rest,
    impact_model,
)
from softimpact.symbolic.impact.chain import ChainEnd
from softimpact.symbolic.robot.rigid import Array

GRAVITY = (0.0, 0.0, -9.81)

AXES = {"rr": [0, 1], "rmin": [0, 2]}
"""Base axes along which a contact point moves that does not move along all."""


def sundials(package: Generated, case: Impact, tolerance: float = 1e-9) -> tuple[float, float]:
    """Return the first contact's peak force of the same chain, and its time."""
    order = record_of(package).order
    found = simulated(package, case, "chain", order, tolerance)
    return found.first_contact, found.time_of_first_contact_peak


def simulated(
    package: Generated, case: Impact, fidelity: Fidelity, order: int, tolerance: float
) -> ImpactHistory:
    """Simulate an impact of a package's robot."""
    robot, sample = package.robot, case.sample
    elastic = is_elastic(robot)
    springs = parameter(package, sample, "joint_stiffness") if elastic else np.zeros(robot.n)
    drives = Drives(
        ca.DM(parameter(package, sample, "rotor_inertia")),
        ca.DM(springs),
        (elastic,) * robot.n,
        ca.DM(parameter(package, sample, "position_gain") * np.array(robot.actuated)),
    )
    x, y, z = package.manifest.gravity
    model = ImpactModel(robot, package.tip, drives, (x, y, z))
    approach = Approach(closed(robot, np.array(sample.q)), np.array(sample.n), case.speed)
    contact = Contact(case.region, case.clamped)
    end: ChainEnd | None = "grounded" if order == model.size else None
    return simulate_impact(
        model, approach, contact, fidelity, order=order, end=end, tolerance=tolerance
    )


def closed(robot: Robot, q: Array) -> Array:
    """Close loops that a configuration's rounding to float left open by a micrometre."""
    independent = q[list(closed_chain(robot).independent)]
    return np.array(closed_near(robot, ca.DM(independent), ca.DM(q)), dtype=float).ravel()


def impacts(package: Generated, count: int, seed: int) -> list[Impact]:
    """Return random impacts."""
    directions = np.eye(3)[AXES.get(package.manifest.name, [0, 1, 2])]
    return draw_impacts(package.robot, parameters_of(package.robot), directions, count, seed)


@pytest.mark.parametrize(("robot", "count"), [("panda", 90), ("rr", 40), ("rmin", 40)])
def test_peak_force_and_safe_speed_agree_with_sundials(
    package: Callable[[str], Generated], robot: str, count: int
) -> None:
    check_against_sundials(package(robot), count, seed=21)


@pytest.mark.slow
def test_many_peak_forces_agree_with_sundials(package: Callable[[str], Generated]) -> None:
    check_against_sundials(package("panda"), 600, seed=22)


def check_against_sundials(package: Generated, count: int, seed: int) -> None:
    """Compare random impacts of both builds; 0.1 % and the safe side are the design's numbers."""
    double, single = (Impacts(package, real) for real in ("double", "float"))
    record, compared = record_of(package), 0
    for case in impacts(package, count, seed):
        status, (force, time) = double.peak_force(case)
        if status == SINGULAR:
            continue
        assert status == OK, case
        right, when = sundials(package, case)
        assert force == pytest.approx(right, rel=1e-3), case
        assert time == pytest.approx(when, rel=0.1, abs=1e-4), case
        status, (narrow, _) = single.peak_force(case)
        assert status == OK
        assert narrow == pytest.approx(right, rel=record.float_error + 2e-4), case
        status, (speed, reached) = double.safe_speed(case, right)
        assert status == OK
        assert reached <= right
        if speed < (1 - 5e-3) * case.speed:  # the peak jumps below the limit
            faster = replace(case, speed=1.001 * speed)
            assert double.peak_force(faster)[1][0] > right, case
        else:
            assert sundials(package, replace(case, speed=speed))[0] <= right * (1 + 1e-6), case
        compared += 1
    assert compared > 0.9 * count


@pytest.mark.parametrize("real", ["double", "float"])
@pytest.mark.parametrize("limit", [5.0, 65.0, 280.0, 1000.0])
def test_force_at_the_safe_speed_is_just_below_the_limit(
    package: Callable[[str], Generated], real: str, limit: float
) -> None:
    generated = package("panda")
    compiled, found = Impacts(generated, real), 0
    for case in impacts(generated, 60, seed=5):
        status, (speed, force) = compiled.safe_speed(case, limit)
        if status == SINGULAR:
            continue
        assert status == OK, case
        again = compiled.peak_force(replace(case, speed=speed))[1][0]
        assert max(again, force) < limit
        if force < 0.995 * limit:  # the peak jumps
            faster = replace(case, speed=speed * (1 + 2 * impact.NEAR))
            assert compiled.peak_force(faster)[1][0] > (1 - 1e-3) * limit, case
        else:
            assert force / limit == pytest.approx(impact.AIM, abs=1e-6)
            assert again == pytest.approx(force, rel=5e-4), case
        found += 1
    assert found > 50


def test_safe_speeds_of_long_contacts_are_found_in_rough_steps_and_a_little_lower(
    package: Callable[[str], Generated],
) -> None:
    generated = package("panda")
    compiled, aims = Impacts(generated, "double"), set()
    for case in impacts(generated, 40, seed=23):
        region = compiled.region("chest", clamped=True)
        region.stiffness, region.damping = 3e6, 30.0
        status, (speed, force) = compiled.call("safe_speed", case.sample, 400.0, region)
        if status == SINGULAR:
            continue
        assert status == OK
        again = compiled.call("peak_force", case.sample, speed, region)[1][0]
        assert 0.994 * 400 < again < 400
        aims.add(round(force / 400, 6))
    assert aims >= {impact.AIM, impact.AIM_IF_LONG}


def test_chain_of_a_closed_chain_is_as_near_to_the_linear_robot_as_it_says(
    package: Callable[[str], Generated],
) -> None:
    rmin = package("rmin")
    compiled, record = Impacts(rmin, "double"), record_of(rmin)
    off = []
    for case in impacts(rmin, 40, seed=17):
        status, (force, _) = compiled.peak_force(case)
        assert status == OK, case
        whole = simulated(rmin, case, "linearised", record.order, 1e-9)
        off.append(abs(force / whole.first_contact - 1))
    assert np.mean(off) < 2 * record.chain_error_mean + 1e-3
    assert np.quantile(off, 0.9) < record.chain_error_usual + 1e-3
    assert max(off) < record.chain_error_worst + 1e-3


def test_impacts_of_a_closed_chain_at_rest_are_near_the_nonlinear_robots(
    package: Callable[[str], Generated],
) -> None:
    rmin = package("rmin")
    compiled, model = Impacts(rmin, "double"), impact_model(rmin.robot, gravity=GRAVITY)
    motors = np.random.default_rng(5).uniform([-2.7, -1.3], [-1.9, -0.4], (12, 2))
    off = []
    for case, angles in zip(impacts(rmin, 12, seed=98), motors, strict=True):
        q = tuple(configuration_at_rest(model, angles).tolist())
        resting = replace(case, sample=replace(case.sample, q=q))
        status, (force, _) = compiled.peak_force(resting)
        assert status == OK, resting
        whole = simulated(rmin, resting, "full", 1, 1e-8)
        off.append(abs(force / whole.first_contact - 1))
    assert np.mean(off) < 0.01
    assert max(off) < 0.06


def test_force_grows_with_speed_between_a_linear_and_a_hertz_contact(
    package: Callable[[str], Generated],
) -> None:
    compiled = Impacts(package("panda"), "double")
    sample = impacts(compiled.package, 8, seed=2)[1].sample
    for clamped in (False, True):
        region = compiled.region("chest", clamped)
        (fast, time), (slow, _) = (
            compiled.call("peak_force", sample, speed, region)[1] for speed in (0.5, 0.25)
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


@pytest.mark.parametrize("robot", ["panda", "rmin"])
@pytest.mark.parametrize("function", ["peak_force", "safe_speed"])
def test_bad_impacts_return_a_status_and_write_nothing(
    package: Callable[[str], Generated], function: str, robot: str
) -> None:
    generated = package(robot)
    compiled = Impacts(generated, "double")
    case = impacts(generated, 1, seed=3)[0]
    good = compiled.region("head", clamped=False)
    nan = float("nan")
    assert compiled.call(function, case.sample, 0.5, good)[0] == OK

    def region(**changes: float) -> Any:
        changed = compiled.region("head", clamped=False)
        for field, value in changes.items():
            setattr(changed, field, value)
        return changed

    cases = [
        (case.sample, 0.0, good, OUT_OF_RANGE),
        (case.sample, -1.0, good, OUT_OF_RANGE),
        (case.sample, nan, good, NOT_FINITE),
        (replace(case.sample, n=(0.0, 0.0, 0.0)), 1.0, good, ZERO_DIRECTION),
        (replace(case.sample, q=(nan,) * generated.robot.n), 1.0, good, NOT_FINITE),
        (case.sample, 1.0, region(stiffness=0), OUT_OF_RANGE),
        (case.sample, 1.0, region(damping=-1), OUT_OF_RANGE),
        (case.sample, 1.0, region(effective_mass=0), OUT_OF_RANGE),
        (case.sample, 1.0, region(hertz_stiffness=nan), NOT_FINITE),
    ]
    for sample, number, body, expected in cases:
        status, out = compiled.call(function, sample, number, body)
        assert status == expected
        assert np.isnan(out).all()
    clamped = region(effective_mass=0, clamped=1)
    assert compiled.call(function, case.sample, 0.5, clamped)[0] == OK
    undamped = region(damping=0)
    assert compiled.call(function, case.sample, 0.5, undamped)[0] == OK


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
    for k in range(600):
        count = n + 3 + fields * n + 7
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
        for function in ("peak_force", "safe_speed"):
            status, out = compiled.call(function, sample, rest[-1], region)
            assert np.isfinite(out).all() if status == OK else np.isnan(out).all()
            assert status != OK or (out > 0).all()
            seen.add(status)
    assert {OK, SINGULAR} <= seen


def test_impact_that_outlasts_its_steps_is_unresolved(
    package: Callable[[str], Generated], tmp_path: Path
) -> None:
    generated = package("rr")
    shutil.copytree(generated.folder, tmp_path / "rr")
    source = tmp_path / "rr/src/rr_impact.c"
    steps, few = f"? {impact.STEPS} :", "? 4 :"
    assert steps in source.read_text()
    source.write_text(source.read_text().replace(steps, few))
    compiled = Impacts(replace(generated, folder=tmp_path / "rr"), "double")
    case = impacts(generated, 1, seed=3)[0]
    assert compiled.peak_force(case)[0] == UNRESOLVED
    assert compiled.safe_speed(case, 50.0)[0] == UNRESOLVED


@pytest.mark.parametrize("stiffness", [1e3, 1e5, 1e8])
def test_impacts_on_bodies_of_any_stiffness_are_right(
    package: Callable[[str], Generated], stiffness: float
) -> None:
    compiled = Impacts(package("panda"), "double")
    case = impacts(compiled.package, 2, seed=3)[1]
    region = replace(case.region, stiffness=stiffness, damping=0.0)
    body = compiled.region(region.name, clamped=True)
    body.stiffness, body.damping = stiffness, 0.0
    status, (force, _) = compiled.call("peak_force", case.sample, 0.5, body)
    right, _ = sundials(
        compiled.package, replace(case, region=region, clamped=True, speed=0.5), 1e-10
    )
    assert status == OK
    assert force == pytest.approx(right, rel=1e-3)


def test_force_on_the_softest_bodies_goes_with_the_root_of_their_stiffness(
    package: Callable[[str], Generated],
) -> None:
    compiled = Impacts(package("panda"), "double")
    case = impacts(compiled.package, 2, seed=3)[1]
    soft = compiled.region("abdomen", clamped=True)
    forces = []
    for soft.stiffness in (1e-3, 1e-5):
        soft.damping = 0.0
        forces.append(compiled.call("peak_force", case.sample, 0.5, soft)[1][0])
    assert forces[0] / forces[1] == pytest.approx(10, rel=1e-3)


def test_a_fast_mode_without_a_motion_of_its_own_stands() -> None:
    body = impact.Body(25e3, 0.0, None, 1.9e7)
    slow = [np.array(x) for x in ([0.0, 60.0**2], [0.2, 0.1], [1.0, 0.0])]
    fast = [np.array([x]) for x in (2e3**2, 0.6, 0.0)]
    both = impact.Modes(*(np.append(a, b) for a, b in zip(slow, fast, strict=True)))
    found, exact = impact.peak_force(both, 0.5, body), impact.peak_force(both, 0.5, body, 8.0)
    assert found.force == pytest.approx(exact.force, rel=3e-4)
    assert found.nodes < 40 < exact.nodes / 5
    alone = impact.peak_force(impact.Modes(*slow), 0.5, body, 8.0)
    assert alone.force > (1 + 1e-3) * exact.force  # so that it counts as a spring
