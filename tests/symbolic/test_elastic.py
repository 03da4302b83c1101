# SPDX-License-Identifier: BSD-3-Clause
"""M0, K0 and J_c of elastic joints: the structured against the dense, and some joints rigid."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from oracles import assert_near
from symbol_kinds import KINDS

from softimpact.symbolic import (
    Matrix,
    Robot,
    direction_jacobian,
    drives,
    impact_model,
    load_robot,
    mass_matrix,
    stiffness_of_potential,
)
from softimpact.symbolic.impact.elastic import (
    DenseMass,
    ElasticMass,
    elastic_jacobian,
    elastic_mass,
    elastic_stiffness,
)
from softimpact.symbolic.robot.rigid import Array

POSE = np.array([0.1, 0.3, -0.2, -2.0, 0.4, 1.8, 0.6])
ALONG_Y = np.array([0.0, 1.0, 0.0])
GRAVITY = (0.0, 0.0, -9.81)


@pytest.fixture(scope="module")
def robot() -> Robot:
    return load_robot("panda")


def test_structured_mass_is_the_dense_one(robot: Robot) -> None:
    M, B = ca.DM(mass_matrix(robot, POSE)), ca.DM(robot.armature)
    mass = ElasticMass(M, B)
    links, rotors = np.array(M), np.diag(robot.armature)
    assert_near(mass.matrix, np.block([[links + rotors, links], [links, links]]))
    x = ca.DM(np.random.default_rng(0).normal(size=(14, 2)))
    assert_near(mass.apply(x), np.array(mass.matrix) @ np.array(x))
    assert_near(mass.solve(x), np.linalg.solve(np.array(mass.matrix), np.array(x)))
    assert_near(mass.solve(mass.apply(x)), x)


@pytest.mark.parametrize("kind", KINDS)
def test_symbols_give_the_same_numbers(robot: Robot, kind: Matrix) -> None:
    M, B = ca.DM(mass_matrix(robot, POSE)), ca.DM(robot.armature)
    x = ca.DM(np.random.default_rng(0).normal(size=14))
    links, rotors, column = kind.sym("M", 7, 7), kind.sym("B", 7), kind.sym("x", 14)
    for build in (ElasticMass, lambda m, b: DenseMass(ElasticMass(m, b).matrix)):
        symbolic, numeric = build(links, rotors), build(M, B)
        outputs = [symbolic.matrix, symbolic.apply(column), symbolic.solve(column)]
        found = ca.Function("f", [links, rotors, column], outputs)(M, B, x)
        expected = [numeric.matrix, numeric.apply(x), numeric.solve(x)]
        for ours, theirs in zip(found, expected, strict=True):
            assert_near(ours, theirs, 1e-12)


@pytest.mark.parametrize("rigid", [(), (0,), (2, 5), (0, 1, 2, 3, 4, 5), tuple(range(7))])
def test_rigid_joints_lose_their_deflection(robot: Robot, rigid: list[int]) -> None:
    """The model with rigid joints is the elastic one with those deflections struck out."""
    k_s = np.linspace(1e3, 7e3, 7)
    k_s[list(rigid)] = np.inf
    some = impact_model(
        robot, drives=drives(robot, joint_stiffness=k_s, position_gain=50.0), gravity=GRAVITY
    )
    all_ = impact_model(
        robot,
        drives=drives(robot, joint_stiffness=np.linspace(1e3, 7e3, 7), position_gain=50.0),
        gravity=GRAVITY,
    )
    keep = [i for i in range(14) if i < 7 or i - 7 not in rigid]
    assert some.size == len(keep)
    ours, full = some.linear(POSE, ALONG_Y), all_.linear(POSE, ALONG_Y)
    assert_near(ours.mass.matrix, np.array(full.mass.matrix)[np.ix_(keep, keep)])
    assert_near(ours.stiffness, np.array(full.stiffness)[np.ix_(keep, keep)])
    assert_near(ours.jacobian, np.array(full.jacobian)[:, keep])


def test_stiffness_is_springs_gains_and_gravity(robot: Robot) -> None:
    k_s, gains = np.linspace(1e3, 7e3, 7), np.linspace(10, 70, 7)
    model = impact_model(
        robot, drives=drives(robot, joint_stiffness=k_s, position_gain=gains), gravity=GRAVITY
    )
    H = np.array(stiffness_of_potential(robot, POSE, GRAVITY))
    expected = np.block([[np.diag(gains) + H, H], [H, np.diag(k_s) + H]])
    assert_near(model.generalised_stiffness(POSE), expected)
    weightless = impact_model(robot, drives=drives(robot, joint_stiffness=k_s))
    expected = np.diag(np.concatenate([np.zeros(7), k_s]))
    assert_near(weightless.generalised_stiffness(POSE), expected)


def test_the_hessian_of_the_energy_is_the_stiffness(robot: Robot) -> None:
    """K0 by finite differences of V(θ + δ) + ½ δᵀ k_s δ + ½ θᵀ K_p θ."""
    from softimpact.symbolic import gravity_torques

    k_s, gain = 2e3, 30.0
    model = impact_model(
        robot, drives=drives(robot, joint_stiffness=k_s, position_gain=gain), gravity=GRAVITY
    )

    def gradient(z: Array) -> Array:
        theta, delta = z[:7], z[7:]
        g = np.array(gravity_torques(robot, POSE + theta + delta, GRAVITY)).ravel()
        return np.concatenate([g + gain * theta, g + k_s * delta])

    h = 1e-5
    columns = [(gradient(h * e) - gradient(-h * e)) / (2 * h) for e in np.eye(14)]
    assert_near(model.generalised_stiffness(POSE), np.array(columns).T, 1e-8)


def test_computed_torque_gain_weighs_the_motors_inertia(robot: Robot) -> None:
    model = impact_model(
        robot, drives=drives(robot, joint_stiffness=1e4, computed_torque_gain=6050.0)
    )
    block = np.array(model.generalised_stiffness(POSE))[:7, :7]
    expected = 6050 * (np.array(mass_matrix(robot, POSE)) + np.diag(robot.armature))
    assert_near(block, expected)


def test_passive_joints_have_no_controller() -> None:
    """RR's deflections are joints of its file: only q1 and q3 have motors."""
    robot = load_robot("rr")
    model = impact_model(robot, drives=drives(robot, computed_torque_gain=100.0))
    q = np.array([0.0, 0.0, 1.0, 0.0])
    M = np.array(mass_matrix(robot, q))
    motors = np.diag([1.0, 0, 1, 0])
    expected = 100 * motors @ M @ motors + np.diag([0, 1e4, 0, 1e4])
    assert_near(model.generalised_stiffness(q), expected)
    gains = impact_model(robot, drives=drives(robot, position_gain=5.0))
    assert_near(gains.generalised_stiffness(q), np.diag([5, 1e4, 5, 1e4]))


def test_jacobian_is_felt_by_motors_and_deflections_alike(robot: Robot) -> None:
    row = direction_jacobian(robot, "hand_tcp", POSE, ALONG_Y)
    both = elastic_jacobian(row, (True,) * 7)
    assert_near(both, np.hstack([np.array(row), np.array(row)]))
    assert elastic_jacobian(row, (False,) * 7).shape == (1, 7)


def test_parts_without_elastic_joints() -> None:
    M, B, K_p, H = ca.DM(np.eye(2)), ca.DM([0.1, 0.2]), ca.DM(np.diag([3, 4])), ca.DM(2, 2)
    assert_near(elastic_mass(M, B, (False, False)).matrix, np.diag([1.1, 1.2]))
    assert_near(elastic_stiffness(ca.DM(2, 1), K_p, H, (False, False)), np.diag([3, 4]))


def test_reflected_mass_with_some_rigid_joints_counts_their_rotors(robot: Robot) -> None:
    k_s = np.full(7, 1e4)
    elastic = impact_model(robot, drives=drives(robot, joint_stiffness=k_s))
    k_s[0] = np.inf
    some = impact_model(robot, drives=drives(robot, joint_stiffness=k_s))
    rigid = impact_model(robot)
    masses = [float(m.reflected_mass(POSE, ALONG_Y)) for m in (elastic, some, rigid)]
    assert masses[0] < masses[1] < masses[2]
    M, J = some.generalised_mass(POSE).matrix, some.contact_jacobian(POSE, ALONG_Y)
    j = np.array(J).ravel()
    assert masses[1] == pytest.approx(1 / (j @ np.linalg.solve(np.array(M), j)))
