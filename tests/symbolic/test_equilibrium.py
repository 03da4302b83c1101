# SPDX-License-Identifier: BSD-3-Clause
"""Static equilibrium of springs and gravity."""

import numpy as np
import pytest
from hypothesis import given, settings
from oracles import assert_near
from random_robots import arms, vectors

from softimpact.symbolic import (
    NoEquilibrium,
    WrongLength,
    gravity_torques,
    link_angles_at_rest,
    load_robot,
    motor_angles_at_rest,
    potential_energy,
)

POSE = np.array([0.1, 0.3, -0.2, -2.0, 0.4, 1.8, 0.6])


@pytest.mark.parametrize("k_s", [300.0, 1e4, 1e6])
def test_springs_balance_gravity(k_s):
    robot = load_robot("panda")
    q = link_angles_at_rest(robot, POSE, np.full(7, k_s))
    left = k_s * (q - POSE) + np.array(gravity_torques(robot, q)).ravel()
    assert abs(left).max() < 1e-9 * k_s
    assert_near(motor_angles_at_rest(robot, q, np.full(7, k_s)), POSE, 1e-9)
    assert (q != POSE).any()


def test_the_balance_is_a_minimum_of_the_energy():
    robot = load_robot("panda")
    k_s = np.full(7, 500.0)
    q = link_angles_at_rest(robot, POSE, k_s)

    def energy(x):
        return float(potential_energy(robot, x)) + 0.5 * k_s @ (x - POSE) ** 2

    random = np.random.default_rng(0)
    for _ in range(20):
        assert energy(q + 1e-2 * random.normal(size=7)) > energy(q)


@settings(max_examples=15)
@given(arms(), vectors(5))
def test_there_and_back(robot, q):
    q, k_s = q[: robot.n], np.full(robot.n, 1e5)
    theta = motor_angles_at_rest(robot, q, k_s)
    assert_near(link_angles_at_rest(robot, theta, k_s), q, 1e-9)


def test_without_gravity_springs_rest():
    robot = load_robot("panda")
    assert_near(link_angles_at_rest(robot, POSE, np.full(7, 1e3), (0, 0, 0)), POSE)


def test_sagging_shrinks_as_springs_stiffen():
    robot = load_robot("panda")
    sag = [
        abs(link_angles_at_rest(robot, POSE, np.full(7, k)) - POSE).max() for k in (1e3, 1e4, 1e5)
    ]
    assert sag[0] > 9 * sag[1] > 80 * sag[2] > 0


def test_too_soft_springs_are_told():
    """An upright pendulum on a spring softer than m g l cannot stand."""
    robot = load_robot("panda")
    upright = np.zeros(7)
    with pytest.raises(NoEquilibrium, match=r"no static equilibrium under gravity.*stiffness") as e:
        link_angles_at_rest(robot, upright, np.full(7, 1.0))
    assert np.isfinite(e.value.residual)
    assert "N·m" in str(e.value)


def test_vectors_must_fit():
    robot = load_robot("panda")
    with pytest.raises(WrongLength, match="motor_angles: has 2 values, but 7"):
        link_angles_at_rest(robot, [0.0, 0.0], np.ones(7))
    with pytest.raises(WrongLength, match="joint_stiffness"):
        link_angles_at_rest(robot, POSE, [1.0])
    with pytest.raises(WrongLength, match="link_angles"):
        motor_angles_at_rest(robot, [0.0], np.ones(7))
