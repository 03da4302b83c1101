# SPDX-License-Identifier: BSD-3-Clause
"""Single-joint factors and sensitivities against their definitions and CasADi's derivatives."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from hypothesis import assume, given, settings
from oracles import column
from random_robots import arms, vectors

from softimpact.symbolic import (
    ImpactModel,
    Matrix,
    Robot,
    contact_mobility,
    giaf,
    giaf_by_gear,
    giaf_by_rotor,
    impact_model,
    single_joint_giaf,
)
from softimpact.symbolic.robot.rigid import Array


def parts(robot: Robot, q: Array) -> tuple[ImpactModel, Matrix, Matrix, Matrix]:
    model = impact_model(robot)
    free = np.array(model.free_mobility(q).matrix)
    assume(np.linalg.cond(free) < 1e5)
    return model, ca.DM(model.mass_matrix(q)), ca.DM(robot.armature), model.jacobian(q)


@settings(max_examples=15)
@given(arms(), vectors(5))
def test_one_rotor_at_a_time(robot: Robot, q: Array) -> None:
    q = q[: robot.n]
    model, M, b, J = parts(robot, q)
    found = column(single_joint_giaf(M, b, J))
    for i in range(robot.n):
        alone = impact_model(robot.with_armature(robot.armature * np.eye(robot.n)[i]))
        expected = float(giaf(model.free_mobility(q), alone.mobility(q)))
        assert found[i] == pytest.approx(expected, rel=1e-7)
    assert ((found >= 0) & (found <= 1 + 1e-12)).all()
    assert float(giaf(model.free_mobility(q), model.mobility(q))) <= found.min() * (1 + 1e-9)


@settings(max_examples=15)
@given(arms(), vectors(5))
def test_sensitivities_are_the_derivatives(robot: Robot, q: Array) -> None:
    q = q[: robot.n]
    model, M, b, J = parts(robot, q)
    rotors = ca.SX.sym("b", robot.n)
    symbolic = replace(model, drives=replace(model.drives, rotors=rotors))
    zeta = giaf(model.free_mobility(q), symbolic.mobility(q))
    slope = column(ca.Function("slope", [rotors], [ca.gradient(zeta, rotors)])(b))
    found = column(giaf_by_rotor(M, b, J))
    np.testing.assert_allclose(found, slope, rtol=1e-6, atol=1e-9 * abs(slope).max())
    assert (found <= 0).all()
    ratios = ca.SX.sym("N", robot.n)
    motors = robot.armature / 100.0**2
    geared = replace(model, drives=replace(model.drives, rotors=ratios**2 * motors))
    zeta = giaf(model.free_mobility(q), geared.mobility(q))
    slope = column(ca.Function("slope", [ratios], [ca.gradient(zeta, ratios)])(100))
    np.testing.assert_allclose(
        column(giaf_by_gear(M, b, J)) / 100, slope, rtol=1e-6, atol=1e-9 * abs(slope).max()
    )


def test_rotors_of_a_closed_chain() -> None:
    """Rotors of seven joints that move with four, against G_iᵀ b_i G_i added one at a time."""
    random = np.random.default_rng(2)
    half, J, G = (random.normal(size=shape) for shape in ((4, 4), (3, 4), (7, 4)))
    M, b = half @ half.T + np.eye(4), random.uniform(0.1, 1.0, 7)

    def zeta(rotors: Array) -> float:
        geared = contact_mobility(ca.DM(M + G.T @ np.diag(rotors) @ G), ca.DM(J))
        return float(giaf(contact_mobility(ca.DM(M), ca.DM(J)), geared))

    chain = (ca.DM(M), ca.DM(b), ca.DM(J), ca.DM(G))
    alone = [zeta(b * one) for one in np.eye(7)]
    np.testing.assert_allclose(column(single_joint_giaf(*chain)), alone, rtol=1e-10)
    slopes = np.array([zeta(b + 1e-5 * one) - zeta(b - 1e-5 * one) for one in np.eye(7)]) / 2e-5
    np.testing.assert_allclose(column(giaf_by_rotor(*chain)), slopes, rtol=1e-6)
    np.testing.assert_allclose(column(giaf_by_gear(*chain)), 2 * b * slopes, rtol=1e-6)
