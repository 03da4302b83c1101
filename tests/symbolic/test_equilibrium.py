# SPDX-License-Identifier: BSD-3-Clause
"""Static equilibrium of springs and gravity."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from oracles import assert_near
from random_robots import arms, vectors

from softimpact.symbolic import (
    InvalidValue,
    NoEquilibrium,
    Robot,
    WrongLength,
    gravity_torques,
    link_angles_at_rest,
    load_robot,
    lock_joints,
    motor_angles_at_rest,
    potential_energy,
)
from softimpact.symbolic.robot.rigid import Array

POSE = np.array([0.1, 0.3, -0.2, -2.0, 0.4, 1.8, 0.6])


@pytest.mark.parametrize("k_s", [300.0, 1e4, 1e6])
def test_springs_balance_gravity(k_s: float) -> None:
    robot = load_robot("panda")
    q = link_angles_at_rest(robot, POSE, np.full(7, k_s))
    left = k_s * (q - POSE) + np.array(gravity_torques(robot, q)).ravel()
    assert abs(left).max() < 1e-9 * k_s
    assert_near(motor_angles_at_rest(robot, q, np.full(7, k_s)), POSE, 1e-9)
    assert (q != POSE).any()


def test_the_balance_is_a_minimum_of_the_energy() -> None:
    robot = load_robot("panda")
    k_s = np.full(7, 500.0)
    q = link_angles_at_rest(robot, POSE, k_s)

    def energy(x: Array) -> float:
        return float(potential_energy(robot, x) + 0.5 * k_s @ (x - POSE) ** 2)

    random = np.random.default_rng(0)
    for _ in range(20):
        assert energy(q + 1e-2 * random.normal(size=7)) > energy(q)


@settings(max_examples=15)
@given(arms(), vectors(5))
def test_there_and_back(robot: Robot, q: Array) -> None:
    q, k_s = q[: robot.n], np.full(robot.n, 1e5)
    theta = motor_angles_at_rest(robot, q, k_s)
    assert_near(link_angles_at_rest(robot, theta, k_s), q, 1e-9)


def test_without_gravity_springs_rest() -> None:
    robot = load_robot("panda")
    assert_near(link_angles_at_rest(robot, POSE, np.full(7, 1e3), (0, 0, 0)), POSE)


def test_sagging_shrinks_as_springs_stiffen() -> None:
    robot = load_robot("panda")
    sag = [
        abs(link_angles_at_rest(robot, POSE, np.full(7, k)) - POSE).max() for k in (1e3, 1e4, 1e5)
    ]
    assert sag[0] > 9 * sag[1] > 80 * sag[2] > 0


def test_too_soft_springs_are_told() -> None:
    """An upright pendulum on a spring softer than m g l cannot stand."""
    robot = load_robot("panda")
    upright = np.zeros(7)
    with pytest.raises(NoEquilibrium, match=r"no static equilibrium under gravity.*stiffness") as e:
        link_angles_at_rest(robot, upright, np.full(7, 1.0))
    assert np.isfinite(e.value.residual)
    assert "N·m" in str(e.value)


def test_vectors_must_fit() -> None:
    robot = load_robot("panda")
    with pytest.raises(WrongLength, match="motor_angles: has 2 values, but 7"):
        link_angles_at_rest(robot, [0.0, 0.0], np.ones(7))
    with pytest.raises(WrongLength, match="joint_stiffness"):
        link_angles_at_rest(robot, POSE, [1.0])
    with pytest.raises(WrongLength, match="link_angles"):
        motor_angles_at_rest(robot, [0.0], np.ones(7))


def test_rigid_joints_do_not_sag() -> None:
    """As if they were welded."""
    robot = load_robot("panda")
    springs = np.array([np.inf, 2e3, np.inf, 1e3, 3e3, np.inf, 1e3])
    rigid = np.isinf(springs)
    q = link_angles_at_rest(robot, POSE, springs)
    assert np.array_equal(q[rigid], POSE[rigid])
    names = np.array(robot.joint_names)[rigid]
    welded = lock_joints(robot, dict(zip(names, POSE[rigid], strict=True)))
    assert_near(q[~rigid], link_angles_at_rest(welded, POSE[~rigid], springs[~rigid]))
    assert_near(motor_angles_at_rest(robot, q, springs), POSE)


@pytest.mark.parametrize("spring", [0.0, -1e3, np.nan])
def test_springs_that_cannot_be(spring: float) -> None:
    robot = load_robot("panda")
    springs = np.full(7, 1e3)
    springs[3] = spring
    for at_rest in (link_angles_at_rest, motor_angles_at_rest):
        with pytest.raises(InvalidValue, match="joint_stiffness: must be greater than 0"):
            at_rest(robot, POSE, springs)
    with pytest.raises(InvalidValue, match="motor_angles: must hold finite"):
        link_angles_at_rest(robot, POSE * np.nan, np.full(7, 1e3))


def test_a_search_that_does_not_end_tells_the_torque_that_is_left() -> None:
    robot, k_s = load_robot("panda"), np.array([20.0] * 6 + [np.inf])
    with pytest.raises(NoEquilibrium, match=r"residual torque .* too low") as e:
        link_angles_at_rest(robot, POSE, k_s)
    heaviest = abs(np.array(gravity_torques(robot, [0, np.pi / 2, 0, 0, 0, 0, 0]))).max()
    assert 1e-2 < e.value.residual < 2 * heaviest
