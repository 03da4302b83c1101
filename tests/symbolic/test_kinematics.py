# SPDX-License-Identifier: BSD-3-Clause
"""Poses and Jacobians of any frame, against Pinocchio."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from oracles import Pinocchio, assert_near, configurations, example_urdf
from random_robots import robots, unit_vector, vectors
from symbol_kinds import KINDS

from softimpact.symbolic import (
    FrameNotFound,
    Robot,
    WrongLength,
    contact_point_jacobian,
    direction_jacobian,
    frame_jacobian,
    frame_pose,
    load_robot,
)
from softimpact.symbolic.robot.rigid import Array
from softimpact.symbolic.robot.robot import BASE

EXAMPLES = ("panda.urdf", "ur5_robot.urdf", "kinova.urdf", "baxter.urdf", "simple_humanoid.urdf")


@pytest.mark.parametrize("name", EXAMPLES)
def test_frames_of_files_agree_with_pinocchio(name: str) -> None:
    path = example_urdf(name)
    robot = load_robot(path)
    oracle = Pinocchio.of_urdf(path, robot)
    for q in configurations(robot, 2):
        for frame in list(robot.frames)[::3]:
            if not oracle.model.existFrame(frame, pin.FrameType.BODY):
                continue
            assert_near(frame_jacobian(robot, frame, q), oracle.jacobian(frame, q))
            pose, theirs = frame_pose(robot, frame, q), oracle.pose(frame, q)
            assert_near(pose.rotation, theirs.rotation)
            assert_near(pose.position, theirs.translation)


@settings(max_examples=40)
@given(robots(), vectors(5))
def test_frames_of_random_trees_agree_with_pinocchio(robot: Robot, q: Array) -> None:
    q = q[: robot.n]
    oracle = Pinocchio.of_robot(robot)
    assert_near(frame_jacobian(robot, "tip", q), oracle.jacobian("tip", q))
    assert_near(frame_pose(robot, "tip", q).position, oracle.pose("tip", q).translation)
    assert_near(frame_pose(robot, "tip", q).rotation, oracle.pose("tip", q).rotation)


@settings(max_examples=40)
@given(robots(), vectors(5))
def test_direction_row_is_the_projected_jacobian(robot: Robot, q: Array) -> None:
    q, n = q[: robot.n], unit_vector(3)
    J = np.array(contact_point_jacobian(robot, "tip", q))
    assert_near(direction_jacobian(robot, "tip", q, n), (n @ J)[None])
    assert_near(J, np.array(frame_jacobian(robot, "tip", q))[:3])


@settings(max_examples=40)
@given(robots(), vectors(5))
def test_axes_of_a_joint_only_turn_the_jacobian(robot: Robot, q: Array) -> None:
    q = q[: robot.n]
    J = np.array(contact_point_jacobian(robot, "tip", q))
    for axes_of in range(BASE, robot.n):
        other = np.array(contact_point_jacobian(robot, "tip", q, axes_of))
        assert_near(other.T @ other, J.T @ J)
        same = np.linalg.matrix_rank(J, 1e-6) < 3 or np.linalg.det(J @ J.T) < 1e-6
        if not same:
            R = J @ np.linalg.pinv(other)
            assert_near(R @ R.T, np.eye(3), 1e-8)
            assert np.linalg.det(R) > 0


def test_the_jacobian_is_the_derivative_of_the_position() -> None:
    robot = load_robot("panda")
    q = next(configurations(robot, 1))
    x = ca.SX.sym("x", robot.n)
    position = frame_pose(robot, "hand_tcp", x).position
    derivative = ca.Function("J", [x], [ca.jacobian(position, x)])
    assert_near(contact_point_jacobian(robot, "hand_tcp", q), derivative(q))


def test_every_kind_of_matrix_gives_the_same_numbers() -> None:
    robot = load_robot("panda")
    q, n = next(configurations(robot, 1)), unit_vector(5)
    for kind in KINDS:
        x, d = kind.sym("x", robot.n), kind.sym("d", 3)
        pose = frame_pose(robot, "flange", x)
        for build, number in (
            (pose.rotation, frame_pose(robot, "flange", q).rotation),
            (pose.position, frame_pose(robot, "flange", q).position),
            (frame_jacobian(robot, "flange", x), frame_jacobian(robot, "flange", q)),
            (
                contact_point_jacobian(robot, "flange", x),
                contact_point_jacobian(robot, "flange", q),
            ),
        ):
            assert_near(ca.Function("f", [x], [build])(q), number, 1e-14)
        row = direction_jacobian(robot, "flange", x, d)
        assert_near(
            ca.Function("f", [x, d], [row])(q, n), direction_jacobian(robot, "flange", q, n), 1e-14
        )
        row = direction_jacobian(robot, "flange", x, n)
        assert_near(
            ca.Function("f", [x], [row])(q), direction_jacobian(robot, "flange", q, n), 1e-14
        )


@pytest.mark.parametrize("n", [6, 8])
def test_configurations_must_fit_the_robot(n: int) -> None:
    robot = load_robot("panda")
    for quantity in (frame_pose, frame_jacobian, contact_point_jacobian):
        with pytest.raises(WrongLength, match=f"q: has {n} values, but 7 are needed"):
            quantity(robot, "flange", np.zeros(n))
    with pytest.raises(WrongLength, match="q: "):
        direction_jacobian(robot, "flange", np.zeros(n), [0, 1, 0])


def test_frames_of_the_base_do_not_move() -> None:
    robot = load_robot("panda")
    q = next(configurations(robot, 1))
    assert not np.array(frame_jacobian(robot, "link0", q)).any()
    assert not np.array(direction_jacobian(robot, "link0", q, [0, 1, 0])).any()
    assert_near(frame_pose(robot, "link0", q).position, np.zeros(3))


@pytest.mark.parametrize("quantity", [frame_pose, frame_jacobian, contact_point_jacobian])
def test_unknown_frame_lists_the_known_ones(
    quantity: Callable[[Robot, str, Array], object],
) -> None:
    robot = load_robot("panda")
    with pytest.raises(FrameNotFound, match=r"unknown frame 'hnad'.*known:.*hand_tcp") as caught:
        quantity(robot, "hnad", np.zeros(7))
    assert caught.value.name == "hnad"
    assert "flange" in caught.value.known
