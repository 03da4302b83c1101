# SPDX-License-Identifier: BSD-3-Clause
"""Customisation changes the expressions and nothing else."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from oracles import Pinocchio, assert_near, configurations, example_urdf
from random_robots import robots, vectors

from softimpact.symbolic import (
    Frame,
    Joint,
    JointKind,
    Robot,
    bias_torques,
    frame_pose,
    gravity_torques,
    load_robot,
    mass_matrix,
)
from softimpact.symbolic.dynamics.equations_of_motion import (
    _bias_torques,
    _mass_matrix,
    _potential_gradient,
)
from softimpact.symbolic.dynamics.kinematics import _frame_pose
from softimpact.symbolic.matrices import on_scalars
from softimpact.symbolic.robot.joint_frames import NEARLY_PARALLEL, customised
from softimpact.symbolic.robot.rigid import Array, Inertia, Placement, rotation_from_axis

GRAVITY = (1.0, -2.0, -9.0)


def assert_same(robot: Robot, q: Array, velocity: Array) -> None:
    """Compare the recursions over the customised robot with those over the robot as it is."""
    assert_near(mass_matrix(robot, q), on_scalars(_mass_matrix, (robot,), q))
    plain = on_scalars(_potential_gradient, (robot, GRAVITY), q)
    assert_near(gravity_torques(robot, q, GRAVITY), plain)
    plain = on_scalars(_bias_torques, (robot, GRAVITY), q, velocity)
    assert_near(bias_torques(robot, q, velocity, GRAVITY), plain)
    for name in list(robot.frames)[::5]:
        ours = frame_pose(robot, name, q)
        plain = np.array(on_scalars(_frame_pose, (robot, name), q))
        assert_near(np.hstack([np.array(ours.rotation), np.array(ours.position)]), plain)


@pytest.mark.parametrize(
    "name", ["panda.urdf", "xarm7.urdf", "tiago_pro.urdf", "talos_left_arm.urdf"]
)
def test_customisation_of_real_robots_changes_nothing(name: str) -> None:
    robot = load_robot(example_urdf(name))
    q, velocity = configurations(robot, 2)
    assert_same(robot, q, velocity)


@settings(max_examples=60)
@given(robots(), vectors(5), vectors(5))
def test_customisation_of_random_trees_changes_nothing(
    robot: Robot, q: Array, velocity: Array
) -> None:
    assert_same(robot, q[: robot.n], velocity[: robot.n])


@settings(max_examples=20)
@given(robots(), vectors(5), vectors(5))
def test_customising_twice_changes_nothing(robot: Robot, q: Array, velocity: Array) -> None:
    assert_same(customised(robot), q[: robot.n], velocity[: robot.n])


@pytest.mark.parametrize("sine", [1.0, 0.3, 1.05 * NEARLY_PARALLEL, 0.95 * NEARLY_PARALLEL, 1e-6])
def test_nearly_parallel_axes_cost_no_accuracy(sine: float) -> None:
    """The common normal of nearly parallel axes is far away; seven of them add up."""
    random = np.random.default_rng(2)
    for _ in range(10):
        joints = []
        for i in range(7):
            heading = random.uniform(-np.pi, np.pi)
            about = np.array([np.cos(heading), np.sin(heading), 0.0])
            turn = rotation_from_axis(about, np.arcsin(sine))
            body = Inertia.from_center_of_mass(1.0, random.uniform(-0.3, 0.3, 3), 0.01 * np.eye(3))
            place = Placement(turn, random.uniform(-0.5, 0.5, 3))
            joints.append(Joint(f"j{i}", JointKind.HINGE, i - 1, place, body))
        robot = Robot("r", tuple(joints), {"tip": Frame("tip", 6, Placement.identity())})
        q = random.uniform(-3, 3, 7)
        assert_near(mass_matrix(robot, q), Pinocchio.of_robot(robot).mass_matrix(q))


def test_names_limits_and_drives_stay() -> None:
    robot = load_robot("panda")
    other = customised(robot)
    assert other.joint_names == robot.joint_names
    assert_near(other.limits, robot.limits)
    assert_near(other.armature, robot.armature)
    assert other.actuated == robot.actuated
    assert other.rotor_inertia_sets == robot.rotor_inertia_sets
    assert list(other.frames) == list(robot.frames)


def test_the_panda_keeps_few_constants() -> None:
    """Denavit-Hartenberg frames and base parameters: what makes the expressions short."""
    joints = customised(load_robot("panda")).joints
    rotations = np.concatenate([joint.placement.rotation.ravel() for joint in joints])
    assert set(np.unique(rotations)) <= {-1.0, 0.0, 1.0}
    lengths = np.concatenate([joint.placement.translation for joint in joints])
    assert np.count_nonzero(lengths) <= 6  # d3, a4, a5, d5, a7 and the shoulder's height
    for joint in joints:
        assert joint.inertia.first_moment[2] == 0.0
        assert joint.inertia.mass == 0.0
        assert joint.inertia.about_origin[1, 1] == 0.0
