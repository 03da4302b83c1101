# SPDX-License-Identifier: BSD-3-Clause
"""Mobility, Λ, GIAF, GIIF and their directional kin against dense algebra over Pinocchio."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from oracles import Pinocchio, assert_near, configurations, example_urdf
from random_robots import unit_vector
from symbol_kinds import KINDS

from softimpact.symbolic import (
    Matrix,
    chain_to,
    contact_mobility,
    contact_point_jacobian,
    directional_giaf,
    giaf,
    giif,
    impact_model,
    load_robot,
    mass_matrix,
)

ARMS = {
    "panda.urdf": "panda_hand",
    "ur5_robot.urdf": "tool0",
    "ur10_robot.urdf": "tool0",
    "xarm7.urdf": "link7",
    "talos_left_arm.urdf": "gripper_left_base_link",
}


@pytest.mark.parametrize("name", ARMS)
def test_operational_inertia_agrees_with_pinocchio(name: str) -> None:
    """Λ = (J (M+B)⁻¹ Jᵀ)⁻¹, its free sibling, and every factor made of the two."""
    path, tip = example_urdf(name), ARMS[name]
    whole = load_robot(path)
    oracle = Pinocchio.of_urdf(path, whole)
    robot = chain_to(whole, tip)
    on = [whole.joint_names.index(joint) for joint in robot.joint_names]
    rotors = np.linspace(0.6, 0.1, robot.n)
    model = impact_model(robot.with_armature(rotors))
    for q in configurations(robot, 3, seed=5):
        all_q = np.zeros(whole.n)
        all_q[on] = q
        M = oracle.mass_matrix(all_q)[np.ix_(on, on)]
        J = oracle.jacobian(tip, all_q)[:3, on]
        G_free = J @ np.linalg.solve(M, J.T)
        G_real = J @ np.linalg.solve(M + np.diag(rotors), J.T)
        free, real = model.free_mobility(q), model.mobility(q)
        assert_near(free.matrix, G_free)
        assert_near(real.matrix, G_real)
        cost = np.linalg.cond(G_real)  # inversion loses that many digits, in any library
        L_free, L = np.linalg.inv(G_free), np.linalg.inv(G_real)
        assert_near(free.inertia, L_free, 1e-14 * max(cost, np.linalg.cond(G_free), 1e4))
        assert_near(real.inertia, L, 1e-14 * max(cost, 1e4))
        assert float(giaf(free, real)) == pytest.approx(np.linalg.det(L_free @ G_real), rel=1e-8)
        expected = np.linalg.det(np.eye(3) - L_free @ G_real)
        assert float(giif(free, real)) == pytest.approx(expected, rel=1e-6, abs=1e-12)
        x = unit_vector(1)
        expected = (x @ L_free @ x) / (x @ L @ x)
        assert float(directional_giaf(free, real, x)) == pytest.approx(expected, rel=1e-8)


def test_adjugate_and_determinant() -> None:
    half = np.random.default_rng(0).normal(size=(3, 3))
    G = half @ half.T
    from softimpact.symbolic import ContactMobility

    mobility = ContactMobility(ca.DM(G))
    assert float(mobility.determinant) == pytest.approx(np.linalg.det(G))
    assert_near(mobility.adjugate, np.linalg.det(G) * np.linalg.inv(G))
    assert_near(mobility.inertia, np.linalg.inv(G))


def test_factors_do_not_mind_the_axes() -> None:
    model = impact_model(load_robot("panda"))
    q = next(configurations(model.robot, 1))
    expected = float(giaf(model.free_mobility(q), model.mobility(q)))
    for axes_of in range(7):
        found = giaf(model.free_mobility(q, axes_of), model.mobility(q, axes_of))
        assert float(found) == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("kind", KINDS)
def test_symbols_give_the_same_numbers(kind: Matrix) -> None:
    model = impact_model(load_robot("panda"))
    q, n = next(configurations(model.robot, 1)), unit_vector(2)
    x, d = kind.sym("q", 7), kind.sym("n", 3)

    def all_of(q: Matrix, n: Matrix) -> list[Matrix]:
        free, real = model.free_mobility(q), model.mobility(q)
        along = directional_giaf(free, real, n)
        return [giaf(free, real), giif(free, real), along, real.inertia, free.matrix]

    found = ca.Function("f", [x, d], all_of(x, d))(q, n)
    for ours, theirs in zip(found, all_of(q, ca.DM(n)), strict=True):
        assert_near(ours, theirs, 1e-11)


def test_mobility_of_a_planar_robot_is_singular() -> None:
    robot = load_robot("rr")
    q = np.array([0.1, 0.0, 0.7, 0.0])
    J = contact_point_jacobian(robot, "P", q)
    mobility = contact_mobility(mass_matrix(robot, q), J)
    assert abs(float(mobility.determinant)) < 1e-12
    assert not np.isfinite(np.array(mobility.inertia)).all()
