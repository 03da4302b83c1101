# SPDX-License-Identifier: BSD-3-Clause
"""Laws of rigid-body dynamics, on random robots."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from hypothesis import assume, given, settings
from oracles import assert_near
from random_robots import robots, vectors

from softimpact.symbolic import (
    Frame,
    JointKind,
    Matrix,
    Robot,
    bias_acceleration,
    bias_torques,
    frame_jacobian,
    frame_pose,
    gravity_torques,
    mass_matrix,
    potential_energy,
    stiffness_of_potential,
)
from softimpact.symbolic.robot.rigid import Array, Placement
from softimpact.symbolic.robot.robot import BASE

GRAVITY = (0.7, -1.1, -9.81)
STEP = 1e-5
LAWS = settings(max_examples=40)


def slope(quantity: Callable[[Array], Matrix], q: Array, along: Array) -> Array:
    """Derivative of a quantity along a direction, by central differences."""
    ahead, behind = quantity(q + STEP * along), quantity(q - STEP * along)
    return np.asarray((np.array(ahead) - np.array(behind)) / (2 * STEP))


@LAWS
@given(robots(), vectors(5))
def test_mass_matrix_is_symmetric_and_positive_definite(robot: Robot, q: Array) -> None:
    M = np.array(mass_matrix(robot, q[: robot.n]))
    assert np.array_equal(M, M.T)
    assert np.linalg.eigvalsh(M).min() > 0


@LAWS
@given(robots(), vectors(5), vectors(5))
def test_kinetic_energy_is_that_of_the_moving_masses(
    robot: Robot, q: Array, velocity: Array
) -> None:
    """½ q̇ᵀ M q̇ = Σ ½ (m |v_c|² + ωᵀ I ω), body by body."""
    q, velocity = q[: robot.n], velocity[: robot.n]
    frames = {}
    for i, joint in enumerate(robot.joints):
        com = joint.inertia.first_moment / joint.inertia.mass
        frames[f"c{i}"] = Frame(f"c{i}", i, Placement(np.eye(3), com))
    seen = replace(robot, frames=frames)
    energy = 0.0
    for i, joint in enumerate(robot.joints):
        v, w = np.split(np.array(frame_jacobian(seen, f"c{i}", q)) @ velocity, 2)
        c = joint.inertia.first_moment / joint.inertia.mass
        steiner = joint.inertia.mass * (c @ c * np.eye(3) - np.outer(c, c))
        R = np.array(frame_pose(seen, f"c{i}", q).rotation)
        I = R @ (joint.inertia.about_origin - steiner) @ R.T  # noqa: E741 - the field's symbol
        energy += 0.5 * (joint.inertia.mass * v @ v + w @ I @ w)
    M = np.array(mass_matrix(robot, q))
    assert 0.5 * velocity @ M @ velocity == pytest.approx(energy, rel=1e-9, abs=1e-12)


@LAWS
@given(robots(), vectors(5), vectors(5))
def test_a_coasting_frame_accelerates_as_its_path_bends(
    robot: Robot, q: Array, velocity: Array
) -> None:
    """J̇ q̇ = d²p/dt² along q + q̇ t."""
    q, v, tip = q[: robot.n], velocity[: robot.n], str(robot.tip)
    t = ca.SX.sym("t")
    path = frame_pose(robot, tip, ca.SX(q) + t * ca.SX(v)).position
    bent = ca.Function("bent", [t], [ca.jacobian(ca.jacobian(path, t), t)])(0)
    assert_near(bias_acceleration(robot, tip, q, v), bent, 1e-9)


@LAWS
@given(robots(), vectors(5), vectors(5))
def test_coriolis_forces_do_no_work(robot: Robot, q: Array, velocity: Array) -> None:
    """q̇ᵀ(Ṁ q̇ − 2 h) = 0: what they take from one joint they give to another."""
    q, v = q[: robot.n], velocity[: robot.n]
    M_dot = slope(lambda x: mass_matrix(robot, x), q, v)
    h = np.array(bias_torques(robot, q, v, (0, 0, 0))).ravel()
    scale = abs(v) @ abs(M_dot) @ abs(v) + 1
    assert abs(v @ M_dot @ v - 2 * v @ h) < 1e-7 * scale


@LAWS
@given(robots(max_joints=4), vectors(4), vectors(4))
def test_coriolis_forces_follow_from_the_mass_matrix(
    robot: Robot, q: Array, velocity: Array
) -> None:
    """h = Ṁ q̇ − ½ ∂(q̇ᵀ M q̇)/∂q (Lagrange)."""
    q, v = q[: robot.n], velocity[: robot.n]
    x = ca.SX.sym("x", robot.n)
    M = mass_matrix(robot, x)
    momentum, energy = ca.mtimes(M, v), 0.5 * ca.bilin(M, v, v)
    lagrange = ca.jtimes(momentum, x, ca.DM(v)) - ca.gradient(energy, x)
    expected = ca.Function("h", [x], [lagrange])(q)
    assert_near(bias_torques(robot, q, v, (0, 0, 0)), expected, 1e-9)


@LAWS
@given(robots(), vectors(5), vectors(5))
def test_gravity_torques_are_the_work_gravity_takes(robot: Robot, q: Array, along: Array) -> None:
    q, d = q[: robot.n], along[: robot.n]
    work = slope(lambda x: potential_energy(robot, x, GRAVITY), q, d).item()
    torques = np.array(gravity_torques(robot, q, GRAVITY)).ravel()
    assert torques @ d == pytest.approx(work, rel=1e-6, abs=1e-5)
    still = bias_torques(robot, q, 0 * q, GRAVITY)
    assert_near(still, torques, 1e-9)


@LAWS
@given(robots(), vectors(5), vectors(5))
def test_gravity_hessian_is_the_slope_of_gravity_torques(
    robot: Robot, q: Array, along: Array
) -> None:
    q, d = q[: robot.n], along[: robot.n]
    H = np.array(stiffness_of_potential(robot, q, GRAVITY))
    assert_near(H, H.T, 1e-12)
    expected = slope(lambda x: gravity_torques(robot, x, GRAVITY), q, d).ravel()
    np.testing.assert_allclose(H @ d, expected, atol=1e-5 * (1 + abs(H).max()))


@LAWS
@given(robots(), vectors(5))
def test_the_only_joint_at_the_base_changes_no_inertia(robot: Robot, q: Array) -> None:
    """M does not see where all that moves has been taken together."""
    q = q[: robot.n]
    moved = q.copy()
    assume(sum(joint.parent == BASE for joint in robot.joints) == 1)
    moved[0] += 0.7
    assert_near(mass_matrix(robot, moved), mass_matrix(robot, q), 1e-9)


@LAWS
@given(robots(kinds=(JointKind.HINGE,)), vectors(5))
def test_hinges_come_back_after_a_turn(robot: Robot, q: Array) -> None:
    q = q[: robot.n]
    assert_near(mass_matrix(robot, q + 2 * np.pi), mass_matrix(robot, q), 1e-9)
