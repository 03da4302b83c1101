# SPDX-License-Identifier: BSD-3-Clause
"""How a robot arrives at a contact."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from oracles import assert_near, configurations
from random_robots import unit_vector
from symbol_kinds import KINDS

from softimpact.symbolic import (
    ImpactModel,
    InvalidValue,
    SingularDirection,
    WrongLength,
    approach_velocity,
    drives,
    generalised_velocity,
    impact_model,
    least_velocity,
    load_robot,
    unit_direction,
)


@pytest.fixture(scope="module")
def model() -> ImpactModel:
    return impact_model(load_robot("panda"))


def test_approach_moves_the_point_along_the_direction_with_least_effort(model: ImpactModel) -> None:
    for q in configurations(model.robot, 3):
        n = unit_vector(1)
        velocity = approach_velocity(model, q, n)
        J = np.array(model.jacobian(q))
        assert_near(J @ velocity, n)
        rest = np.eye(7) - np.linalg.pinv(J) @ J
        assert abs(rest @ velocity).max() < 1e-9 * abs(velocity).max()  # no self-motion in it


def test_least_velocity_is_the_same_in_every_kind_of_matrix(model: ImpactModel) -> None:
    q, n = next(configurations(model.robot, 1)), unit_vector(2)
    J = model.jacobian(q)
    expected = approach_velocity(model, q, n)
    assert_near(least_velocity(J, ca.DM(n)), expected, 1e-9)
    for kind in KINDS:
        symbol, d = kind.sym("J", 3, 7), kind.sym("n", 3)
        f = ca.Function("f", [symbol, d], [least_velocity(symbol, d)])
        assert_near(f(J, n), expected, 1e-9)


def test_springs_do_not_move_before_the_impact() -> None:
    robot = load_robot("rr")
    model = impact_model(robot)
    q = np.array([0.2, 0, 0.9, 0])
    velocity = approach_velocity(model, q, np.array([0, 1.0, 0]))
    assert velocity[[1, 3]] == pytest.approx(0)
    assert abs(velocity[[0, 2]]).min() > 0


def test_generalised_velocity_appends_resting_deflections(model: ImpactModel) -> None:
    v = np.arange(7.0)
    elastic = impact_model(model.robot, drives=drives(model.robot, joint_stiffness=1e4))
    assert_near(generalised_velocity(elastic, v), np.concatenate([v, np.zeros(7)]))
    assert_near(generalised_velocity(model, v), v)
    with pytest.raises(WrongLength, match="joint_velocity"):
        generalised_velocity(model, [1.0])


def test_a_direction_in_which_the_robot_cannot_move() -> None:
    model = impact_model(load_robot("rr"))  # moves in the xy plane
    with pytest.raises(SingularDirection, match=r"direction \[0, 0, 1\]: choose another") as caught:
        approach_velocity(model, [0.1, 0, 0.5, 0], [0, 0, 1])
    assert caught.value.direction == (0.0, 0.0, 1.0)


def test_a_stretched_arm_cannot_move_along_itself() -> None:
    model = impact_model(load_robot("rr"))
    with pytest.raises(SingularDirection, match="cannot move"):
        approach_velocity(model, [0.0, 0, 0.0, 0], [1, 0, 0])
    velocity = approach_velocity(model, [0.0, 0, 0.0, 0], [0, 1, 0])
    assert_near(np.array(model.jacobian(np.zeros(4))) @ velocity, [0, 1, 0])


def test_a_hair_off_a_singular_pose_is_singular_too() -> None:
    """Joints would have to turn at 1e11 rad/s."""
    model = impact_model(load_robot("rr"), "P")
    with pytest.raises(SingularDirection):
        approach_velocity(model, [0.0, 0.0, 1e-11, 0.0], [1, 0, 0])


def test_unit_direction() -> None:
    assert_near(unit_direction([0, 3, 4]), [0, 0.6, 0.8])
    assert_near(unit_direction([0, 0, 1e-100]), [0, 0, 1])
    for length in (1e-200, 1e200):
        assert_near(unit_direction(np.array([0, 3, 4]) * length), [0, 0.6, 0.8])


@pytest.mark.parametrize(
    ("direction", "message"),
    [
        ([0, 0, 0], "direction: must not be zero"),
        ([0, float("nan"), 1], r"direction: needs three finite numbers \[x, y, z\]"),
        ([0, float("inf"), 1], "direction: needs three finite numbers"),
        ([1, 0], "direction: needs three finite numbers"),
        (1.0, "direction: needs three finite numbers"),
        ([[1, 0, 0]], "direction: needs three finite numbers"),
    ],
)
def test_directions_that_are_none(direction: list[float], message: str) -> None:
    with pytest.raises(InvalidValue, match=message) as caught:
        unit_direction(direction)
    assert caught.value.field == "direction"
