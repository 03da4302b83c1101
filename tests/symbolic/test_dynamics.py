# SPDX-License-Identifier: BSD-3-Clause
"""M, bias, gravity and their Hessian against Pinocchio, over real and random robots."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from oracles import Pinocchio, assert_near, configurations, example_urdf
from random_robots import robots, vectors

from softimpact.symbolic import (
    STANDARD_GRAVITY,
    Matrix,
    Robot,
    WrongLength,
    bias_torques,
    gravity_torques,
    load_robot,
    mass_matrix,
    potential_energy,
    stiffness_of_potential,
)
from softimpact.symbolic.robot.rigid import Array

GRAVITY = (1.3, -2.1, -9.0)
EXAMPLES = (
    "panda.urdf",  # seven hinges, two sliding fingers
    "ur5_robot.urdf",
    "ur10_robot.urdf",
    "xarm7.urdf",
    "kinova.urdf",  # continuous joints, axes off the right angle by rounded digits
    "baxter.urdf",  # two arms, four slides
    "talos_reduced.urdf",  # humanoid on a fixed base
    "simple_humanoid.urdf",
    "tiago_pro.urdf",  # lift, two arms
    "so101.urdf",
    "double_pendulum.urdf",
    "double_pendulum_continuous.urdf",
)


@pytest.mark.parametrize("name", EXAMPLES)
def test_dynamics_agree_with_pinocchio(name: str) -> None:
    path = example_urdf(name)
    robot = load_robot(path)
    oracle = Pinocchio.of_urdf(path, robot)
    random = np.random.default_rng(1)
    for q in configurations(robot, 3):
        velocity = random.normal(size=robot.n)
        assert_near(mass_matrix(robot, q), oracle.mass_matrix(q))
        assert_near(bias_torques(robot, q, velocity, GRAVITY), oracle.bias(q, velocity, GRAVITY))
        assert_near(gravity_torques(robot, q, GRAVITY), oracle.bias(q, 0 * q, GRAVITY))


@settings(max_examples=60)
@given(robots(), vectors(5), vectors(5))
def test_dynamics_of_random_trees_agree_with_pinocchio(
    robot: Robot, q: Array, velocity: Array
) -> None:
    q, velocity = q[: robot.n], velocity[: robot.n]
    oracle = Pinocchio.of_robot(robot)
    assert_near(mass_matrix(robot, q), oracle.mass_matrix(q))
    assert_near(bias_torques(robot, q, velocity, GRAVITY), oracle.bias(q, velocity, GRAVITY))
    assert_near(gravity_torques(robot, q, GRAVITY), oracle.bias(q, 0 * q, GRAVITY))


def test_gravity_defaults_to_standard_gravity() -> None:
    robot = load_robot("panda")
    q = next(configurations(robot, 1))
    assert_near(gravity_torques(robot, q), gravity_torques(robot, q, STANDARD_GRAVITY))
    assert STANDARD_GRAVITY == (0.0, 0.0, -9.81)


def test_without_gravity_nothing_pulls() -> None:
    robot = load_robot("panda")
    q = next(configurations(robot, 1))
    assert not np.array(gravity_torques(robot, q, (0, 0, 0))).any()
    assert not np.array(bias_torques(robot, q, 0 * q, (0, 0, 0))).any()
    assert not np.array(stiffness_of_potential(robot, q, (0, 0, 0))).any()


def test_every_kind_of_matrix_gives_the_same_numbers() -> None:
    robot = load_robot("panda")
    q, velocity = configurations(robot, 2)
    x, v = ca.SX.sym("x", robot.n), ca.SX.sym("v", robot.n)
    X, V = ca.MX.sym("x", robot.n), ca.MX.sym("v", robot.n)
    for quantity in (mass_matrix, gravity_torques, potential_energy, stiffness_of_potential):
        scalar = ca.Function("f", [x], [quantity(robot, x)])(q)
        graph = ca.Function("f", [X], [quantity(robot, X)])(q)
        assert_near(scalar, quantity(robot, q), 1e-14)
        assert_near(graph, quantity(robot, q), 1e-14)
        assert_near(quantity(robot, list(q)), quantity(robot, q), 0)
    bias = bias_torques(robot, q, velocity)
    assert_near(ca.Function("f", [x, v], [bias_torques(robot, x, v)])(q, velocity), bias, 1e-14)
    assert_near(ca.Function("f", [X, V], [bias_torques(robot, X, V)])(q, velocity), bias, 1e-14)
    mixed = ca.Function("f", [x], [bias_torques(robot, x, velocity)])(q)
    assert_near(mixed, bias, 1e-14)
    mixed = ca.Function("f", [V], [bias_torques(robot, q, V)])(velocity)
    assert_near(mixed, bias, 1e-14)


@pytest.mark.parametrize("n", [6, 8])
@pytest.mark.parametrize(
    "make", [np.zeros, lambda n: ca.SX.sym("q", n), lambda n: ca.MX.sym("q", n)]
)
def test_vectors_must_fit_the_robot(make: Callable[..., Matrix], n: int) -> None:
    robot = load_robot("panda")
    for quantity in (mass_matrix, potential_energy, gravity_torques, stiffness_of_potential):
        with pytest.raises(WrongLength, match=f"q: has {n} values, but 7 are needed.*joint1") as e:
            quantity(robot, make(n))
        assert (e.value.found, e.value.expected) == (n, 7)
    with pytest.raises(WrongLength, match="q: "):
        bias_torques(robot, make(n), np.zeros(7))
    with pytest.raises(WrongLength, match="velocity: "):
        bias_torques(robot, np.zeros(7), make(n))


def test_springs_of_the_file_store_energy() -> None:
    robot = load_robot("rr")
    q = np.array([0.3, 0.01, -0.4, -0.02])
    assert_near(potential_energy(robot, q), 0.5 * 1e4 * (0.01**2 + 0.02**2))
    assert_near(stiffness_of_potential(robot, q), np.diag([0, 1e4, 0, 1e4]))
    assert_near(gravity_torques(robot, q), [0, 100.0, 0, -200.0])
