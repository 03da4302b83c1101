# SPDX-License-Identifier: BSD-3-Clause
"""Floating robots against Pinocchio's free-flyer and MuJoCo's free joint."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from oracles import FreeFlyer, Mujoco, assert_near, example_urdf
from random_robots import inertias, robots, seeds

from softimpact.symbolic import (
    FloatingRobot,
    MasslessBase,
    Robot,
    UnsupportedModel,
    drives,
    floating_model,
    floating_robot,
    load_robot,
    lock_joints,
    mass_matrix,
)
from softimpact.symbolic.impact.floating import rotation_of
from softimpact.symbolic.robot.rigid import Array, Inertia

LEGGED = {
    "go2.urdf": "FL_foot",
    "solo12.urdf": "HR_FOOT",
    "laikago.urdf": "RL_calf",
    "talos_reduced.urdf": "gripper_left_base_link",
    "simple_humanoid.urdf": "l_wrist",
}
"""Quadrupeds and humanoids, with a frame far from the base."""

Pair = tuple[FloatingRobot, FreeFlyer, str]
"""A robot, Pinocchio's model of it, and a frame."""


@pytest.fixture(scope="module", params=LEGGED)
def pair(request: pytest.FixtureRequest) -> Pair:
    robot = load_robot(example_urdf(request.param))
    return (
        floating_robot(robot),
        FreeFlyer(example_urdf(request.param), robot),
        LEGGED[request.param],
    )


def state(robot: Robot | FloatingRobot, seed: int) -> tuple[Array, Array]:
    """Random configuration and velocity."""
    random = np.random.default_rng(seed)
    quaternion = random.normal(size=4)
    quaternion /= np.linalg.norm(quaternion)
    configuration = np.concatenate(
        [random.normal(size=3), quaternion, random.uniform(-1, 1, robot.n)]
    )
    return configuration, random.normal(size=6 + robot.n)


@pytest.mark.parametrize("seed", range(3))
def test_mass_matrix(pair: Pair, seed: int) -> None:
    robot, oracle, _ = pair
    q, _ = state(robot, seed)
    assert_near(robot.mass_matrix(q[7:]), oracle.mass_matrix(q))


@pytest.mark.parametrize("seed", range(3))
def test_bias(pair: Pair, seed: int) -> None:
    robot, oracle, _ = pair
    gravity = (0.3, -0.7, -9.81)
    q, v = state(robot, seed)
    assert_near(robot.bias_torques(q, v, gravity), oracle.bias(q, v, gravity))


@pytest.mark.parametrize("seed", range(3))
def test_jacobian_and_pose(pair: Pair, seed: int) -> None:
    robot, oracle, frame = pair
    q, _ = state(robot, seed)
    assert_near(robot.frame_jacobian(frame, q), oracle.jacobian(frame, q))
    ours, theirs = robot.frame_pose(frame, q), oracle.pose(frame, q)
    assert_near(ours.position, theirs.translation)
    assert_near(ours.rotation, theirs.rotation)


def test_rate_is_what_pinocchio_integrates(pair: Pair) -> None:
    robot, oracle, _ = pair
    q, v = state(robot, 7)
    step = 1e-6
    start, way = oracle.configuration(q), oracle.velocity(v)
    ahead, behind = (pin.integrate(oracle.model, start, s * step * way) for s in (1, -1))
    slope = ((ahead - behind) / (2 * step))[oracle.q_order]
    np.testing.assert_allclose(np.array(robot.rate(q, v)).ravel(), slope, atol=1e-7)


@settings(max_examples=10)
@given(robots(max_joints=4), inertias(), seeds)
def test_jacobian_is_the_slope_of_the_pose(robot: Robot, base: Inertia, seed: int) -> None:
    """J (v, ω, q̇) is the velocity of the frame as the configuration moves by its rate."""
    free = floating_robot(robot, base)
    q, v = state(free, seed)
    symbol = ca.SX.sym("q", 7 + free.n)
    position = free.frame_pose("tip", symbol).position
    slope = ca.Function("slope", [symbol], [ca.jtimes(position, symbol, free.rate(symbol, v))])
    J = np.array(free.frame_jacobian("tip", q))
    np.testing.assert_allclose(J[:3] @ v, np.array(slope(q)).ravel(), atol=1e-12)


@settings(max_examples=10)
@given(robots(max_joints=4), inertias(), seeds)
def test_energy_is_kept_in_free_fall(robot: Robot, base: Inertia, seed: int) -> None:
    """With M a + h = 0 the sum of kinetic and potential energy does not change."""
    free = floating_robot(robot, base)
    q, v = state(free, seed)
    gravity = np.array([0.4, 0.0, -9.81])
    symbol, rate = ca.SX.sym("q", 7 + free.n), ca.SX.sym("v", 6 + free.n)
    M = free.mass_matrix(symbol[7:])
    kinetic = ca.bilin(M, rate, rate) / 2
    acceleration = ca.SX.sym("a", 6 + free.n)
    power = ca.jtimes(kinetic, symbol, free.rate(symbol, rate)) + ca.dot(
        ca.mtimes(M, rate), acceleration
    )
    of = ca.Function("power", [symbol, rate, acceleration], [power])
    a = -np.linalg.solve(
        np.array(free.mass_matrix(q[7:])), np.array(free.bias_torques(q, v, gravity)).ravel()
    )
    still = np.array(free.bias_torques(q, 0 * v, gravity)).ravel()  # gradient of the potential
    expected = -still @ v
    assert float(of(q, v, a)) == pytest.approx(expected, rel=1e-8, abs=1e-8)


FREE_MJCF = """
<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="trunk" pos="1 2 3" euler="0.3 -0.2 0.7">
      <freejoint/>
      <inertial mass="3" pos="0.1 0 0.05" diaginertia="0.05 0.06 0.07"/>
      <body name="thigh" pos="0.2 0.1 0">
        <joint name="hip" axis="0 1 0"/>
        <inertial mass="1" pos="0 0 -0.1" diaginertia="0.01 0.01 0.002"/>
        <body name="shank" pos="0 0 -0.2">
          <joint name="knee" axis="0 1 0"/>
          <inertial mass="0.4" pos="0 0 -0.1" diaginertia="0.004 0.004 0.001"/>
          <site name="foot" pos="0 0 -0.2"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture
def free_file(tmp_path: Path) -> Path:
    path = tmp_path / "legged.xml"
    path.write_text(FREE_MJCF)
    return path


def test_a_free_joint_in_mjcf_is_the_floating_base(free_file: Path) -> None:
    """MuJoCo's v is in the world's axes, ours in the base's; its quaternion begins with w."""
    robot = floating_robot(load_robot(free_file, "foot", floating=True))
    q, v = state(robot, 3)
    R = np.array(rotation_of(ca.DM(q[3:7])))
    theirs = np.concatenate([q[:3], q[6:7], q[3:6], q[7:]])
    turn = np.eye(8)
    turn[:3, :3] = R  # MuJoCo's velocities of ours
    their_v = turn @ v
    mujoco = Mujoco(FREE_MJCF).at(theirs, their_v)
    assert_near(robot.mass_matrix(q[7:]), turn.T @ mujoco.mass_matrix() @ turn)
    assert_near(robot.frame_jacobian("foot", q), mujoco.site_jacobian("foot") @ turn)
    assert_near(robot.frame_pose("foot", q).position, mujoco.site_position("foot"))
    # v̇ = 0 in the base's axes is R(ω × v) in the world's
    spin = np.concatenate([R @ np.cross(v[3:6], v[:3]), np.zeros(5)])
    bias = turn.T @ (mujoco.bias() + mujoco.mass_matrix() @ spin)
    assert_near(robot.bias_torques(q, v), bias)


def test_a_free_joint_needs_a_floating_base(free_file: Path) -> None:
    with pytest.raises(UnsupportedModel, match="free joint"):
        load_robot(free_file)


def test_held_base_leaves_the_fixed_robot() -> None:
    """The joints' block of M is the fixed robot's, whatever the base weighs."""
    robot = load_robot(example_urdf("go2.urdf"))
    free = floating_robot(robot)
    q = np.linspace(-0.5, 0.5, 12)
    assert_near(np.array(free.mass_matrix(q))[6:, 6:], mass_matrix(robot, q))


def test_base_keeps_what_is_welded_to_it() -> None:
    robot = load_robot(example_urdf("go2.urdf"))
    whole = floating_robot(robot)
    total = float(whole.mass_matrix(np.zeros(12))[0, 0])
    legs = {name: 0.0 for name in robot.joint_names if not name.startswith("FL")}
    stiff = floating_robot(lock_joints(robot, legs))
    assert float(stiff.mass_matrix(np.zeros(3))[0, 0]) == pytest.approx(total, rel=1e-12)
    assert stiff.fixed.base_inertia.mass > robot.base_inertia.mass
    frozen = np.zeros(12)
    keep = [*range(6), *(6 + robot.joint_names.index(n) for n in stiff.fixed.joint_names)]
    assert_near(
        stiff.mass_matrix(np.zeros(3)), np.array(whole.mass_matrix(frozen))[np.ix_(keep, keep)]
    )


def test_massless_base_cannot_float() -> None:
    with pytest.raises(MasslessBase, match="'panda'"):
        floating_robot(load_robot("panda"))


def test_impact_model_has_rotors_on_the_joints_alone() -> None:
    robot = load_robot(example_urdf("go2.urdf"))
    free = floating_robot(robot)
    given = drives(robot, rotor_inertia=0.02, joint_stiffness=100.0)
    model = floating_model(free, "FL_foot", drives=given)
    q = np.array(free.coordinates(np.full(12, 0.3))).ravel()
    difference = np.array(model.rotor_mass_matrix(q) - model.mass_matrix(q))
    assert_near(difference, np.diag([0.0] * 6 + [0.02] * 12))
    assert model.drives.elastic == (False,) * 6 + (True,) * 12
    assert model.size == 6 + 24


def test_base_inertia_does_not_matter_to_a_fixed_robot() -> None:
    robot = load_robot(example_urdf("go2.urdf"))
    heavier = replace(robot, base_inertia=robot.base_inertia + robot.base_inertia)
    assert heavier.digest() == robot.digest()
    assert heavier.digest(floating=True) != robot.digest(floating=True)
    q = np.full(12, 0.2)
    assert np.array_equal(np.array(mass_matrix(robot, q)), np.array(mass_matrix(heavier, q)))


def test_computed_torque_turns_the_joints_alone() -> None:
    robot = load_robot("panda")
    free = floating_robot(robot, Inertia.from_center_of_mass(20.0, np.zeros(3), np.eye(3)))
    model = floating_model(free, drives=drives(robot, computed_torque_gain=30.0))
    q = free.coordinates(ca.DM(np.linspace(-0.4, 0.5, 7)))
    expected = np.zeros((13, 13))
    expected[6:, 6:] = 30.0 * np.array(model.rotor_mass_matrix(q))[6:, 6:]
    assert_near(model.position_gains(q), expected)
