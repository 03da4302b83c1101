# SPDX-License-Identifier: BSD-3-Clause
"""The error of the linearised robot's forces: estimated, and measured against the full model."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from impact_cases import ALONG_Y, CHEST, FREE_HEAD, POSE
from mechanisms import FIVE_BAR, robot_of
from oracles import Pinocchio, configurations

from softimpact.simulate import (
    Approach,
    ForceLimits,
    assess_impact,
    largest_safe_speed,
    simulate_impact,
)
from softimpact.simulate.linear_error import UNSEEN, linear_error
from softimpact.simulate.trust import TRUSTED, nonlinear_safe_speed, not_trusted
from softimpact.symbolic import (
    Contact,
    InvalidValue,
    Motors,
    Robot,
    approach_velocity,
    body_region,
    drives,
    impact_model,
    unit_direction,
)

SPEED_LIMITS = np.array([2.175] * 4 + [2.61] * 3)
"""Of the Panda's joints [rad/s] (Franka Emika)."""


def test_it_is_the_change_along_the_motion(panda: Robot) -> None:
    """Against Pinocchio: the path's bend by differences, h, M and J."""
    model, oracle = impact_model(panda, drives=drives(panda, 1e4)), Pinocchio.of_robot(panda)
    n, speed, duration, step = unit_direction([0.4, 1.0, -0.3]), 0.7, 0.03, 1e-4
    rates = speed * approach_velocity(model, POSE, n)
    x = [n @ oracle.pose(model.tip, POSE + k * step * rates).translation for k in (-1, 0, 1)]
    kept = (x[0] - 2 * x[1] + x[2]) / step**2
    mobility = np.linalg.inv(oracle.mass_matrix(POSE))
    row = n @ oracle.jacobian(model.tip, POSE)[:3]
    unheld = kept - row @ mobility @ oracle.bias(POSE, rates, np.zeros(3))
    later = POSE + duration * rates
    after = n @ oracle.jacobian(model.tip, later)[:3]
    masses = row @ mobility @ row, after @ np.linalg.inv(oracle.mass_matrix(later)) @ after
    expected = (abs(kept) + abs(unheld)) * duration / (2 * speed)
    expected += abs(np.sqrt(masses[0] / masses[1]) - 1)
    found = linear_error(model, Approach(POSE, n, speed), duration)
    assert found == pytest.approx(expected, rel=1e-4)


def test_it_vanishes_with_speed_and_duration(panda: Robot) -> None:
    model, approach = impact_model(panda, drives=drives(panda, 1e4)), Approach(POSE, ALONG_Y, 1.0)
    assert linear_error(model, approach, 0.0) == 0
    whole = linear_error(model, approach, 1e-3)
    assert whole > 0
    assert linear_error(model, replace(approach, speed=0.5), 1e-3) < 0.51 * whole
    assert linear_error(model, approach, 5e-4) < 0.51 * whole


@pytest.mark.parametrize(("count", "seed"), [(4, 0), pytest.param(60, 7, marks=pytest.mark.slow)])
def test_it_bounds_the_error_of_reachable_impacts(panda: Robot, count: int, seed: int) -> None:
    """Errors above 1 % occur; the unsafe ones are all within the estimate."""
    random, errors, estimates = np.random.default_rng(seed), [], []
    for q in configurations(panda, count, seed):
        kind = ("free", "servo", "driven")[random.integers(3)]
        gain = 10 ** random.uniform(2.5, 4.5)
        given = drives(
            panda, 10 ** random.uniform(3, 5), None, gain, damping_gain=0.5 * np.sqrt(gain)
        )
        model, n = impact_model(panda, drives=given), unit_direction(random.normal(size=3))
        fastest = float(1 / (abs(approach_velocity(model, q, n)) / SPEED_LIMITS).max())
        approach = Approach(q, n, min(random.uniform(0.1, 1.5), fastest))
        contact = (CHEST, FREE_HEAD)[random.integers(2)]
        motors = Motors(kind, (0.02, 0.05)[random.integers(2)])  # type: ignore[arg-type]
        full, linear = (
            simulate_impact(model, approach, contact, f, motors=motors, horizon=0.1, tolerance=1e-8)
            for f in ("full", "linearised")
        )
        errors.append(full.peak / linear.peak - 1)
        until = max(linear.time_of_peak, motors.reaction_time)
        estimates.append(linear_error(model, approach, until))
    found, bound = np.array(errors), np.array(estimates) + UNSEEN
    assert not (found > bound).any()  # too low a force by linearised
    assert (abs(found) > bound).mean() <= 0.05  # on the safe side: 2 of the 60
    if count > 10:
        assert np.median(estimates) < 0.1
        assert np.mean(abs(found) > 0.01) > 0.05  # else nothing was bounded


def test_safe_speeds_are_asked_of_the_nonlinear_robot_too(panda: Robot) -> None:
    """Where the linear model is trusted at the impact's speed, yet not at the safe one."""
    given = drives(panda, 3e3, 0.3)
    model, n = impact_model(panda, drives=given), unit_direction([-1, 0.4, -2])
    contact, motors = Contact(body_region("thigh"), clamped=False), Motors("free")
    q = np.array([-0.15, 0.67, 0.06, -0.45, -0.05, 1.2, 0.19])
    slow = assess_impact(model, Approach(q, n, 0.2), contact, motors=motors, safe_speed=True)
    speed = slow.safe_speed
    assert speed is not None
    assert slow.linear_error is not None
    assert slow.linear_error < TRUSTED
    at = assess_impact(model, Approach(q, n, speed), contact, motors=motors)
    assert at.linear_error is not None
    assert at.linear_error > TRUSTED
    assert at.verdict.share <= 1 + 1e-6
    assert any(line.startswith("at the safe speed the linear model") for line in slow.warnings)


def test_small_errors_do_not_make_a_safe_speed_too_high(panda: Robot) -> None:
    model = impact_model(panda, drives=drives(panda, 3e3, 0.3))
    n, contact = unit_direction([-0.002, 0.689, 0.725]), Contact(body_region("hand"), clamped=False)
    q, limits = np.array([-1.02, 0.54, -1.15, -0.84, -1.75, 2.65, -1.34]), ForceLimits(40.0)
    free = Motors("free")
    linear = largest_safe_speed(model, Approach(q, n, 0.3), contact, limits, motors=free)
    at = Approach(q, n, linear)
    speed, error = nonlinear_safe_speed(model, at, contact, limits, free, {})
    assert error is not None
    assert error < 0.01
    assert 0.995 * linear < speed < linear
    true = simulate_impact(model, replace(at, speed=speed), contact, "full", motors=free)
    assert true.peak == pytest.approx(40.0, rel=1e-6)


@pytest.mark.parametrize("duration", [-1e-9, np.nan, np.inf])
def test_bad_durations_are_refused(panda: Robot, duration: float) -> None:
    with pytest.raises(InvalidValue, match="duration"):
        linear_error(impact_model(panda), Approach(POSE, ALONG_Y, 1.0), duration)


def test_closed_chains_are_refused(tmp_path: Path) -> None:
    model = impact_model(robot_of(tmp_path, FIVE_BAR))
    with pytest.raises(InvalidValue, match="closed chains"):
        linear_error(model, Approach(np.zeros(4), ALONG_Y, 1.0), 0.01)


def test_a_verdict_that_may_flip_is_asked_of_the_nonlinear_robot_too() -> None:
    assert not_trusted(0.2, 0.0)
    assert not not_trusted(0.05, 0.5)
    assert not_trusted(0.05, 0.96)
    assert not not_trusted(0.05, 1.2)  # it is exceeded anyway
    assert not_trusted(0.005, 0.999)
    assert not not_trusted(None, 0.999)
