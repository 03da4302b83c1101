# SPDX-License-Identifier: BSD-3-Clause
"""m_c, k_r and m_a against the paper's formulas with an explicit nullspace."""

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from linear_models import dense, linear_models, nullspace, random_linear_model, with_nullspace
from oracles import assert_near
from scipy.optimize import minimize_scalar
from symbol_kinds import KINDS

from softimpact.symbolic import (
    LinearModel,
    Matrix,
    impact_model,
    load_robot,
    reduce_to_two_masses,
    reflected_mass,
    static_stiffness,
)
from softimpact.symbolic.impact.elastic import DenseMass
from softimpact.symbolic.impact.reduction import contact_mode


@settings(max_examples=60)
@given(linear_models(), st.integers(0, 1000))
def test_reduction_is_the_papers_for_every_orthonormal_nullspace(
    model: LinearModel, seed: int
) -> None:
    ours = reduce_to_two_masses(model)
    m_c, k_r, m_a = with_nullspace(model, nullspace(model, seed))
    assert_near([float(ours.m_c), float(ours.k_r)], [m_c, k_r])
    assert float(ours.m_c) == pytest.approx(m_c, rel=1e-10)
    assert float(ours.m_a) == pytest.approx(m_a, rel=1e-9)


def test_m_a_minimises_the_norm_of_equation_38() -> None:
    model = random_linear_model(5, 6)
    M, K, _ = dense(model)
    J_a = nullspace(model, 0)
    M_inverse = np.linalg.inv(M)
    M_a = np.linalg.inv(J_a @ M_inverse @ J_a.T)
    J_a_sharp = M_inverse @ J_a.T @ M_a
    K_a = J_a_sharp.T @ K @ J_a_sharp
    ours = reduce_to_two_masses(model)
    k_r = float(ours.k_r)
    best = minimize_scalar(lambda m: np.linalg.norm(k_r * M_a - m * K_a), tol=1e-12)
    assert float(ours.m_a) == pytest.approx(best.x, rel=1e-6)


@given(linear_models())
def test_contact_mode_is_the_dynamically_consistent_inverse(model: LinearModel) -> None:
    mode = contact_mode(model)
    M, _, j = dense(model)
    direction = np.array(mode.direction).ravel()
    assert j @ direction == pytest.approx(1)  # Eq. 8
    assert direction @ M @ direction == pytest.approx(float(mode.m_c))


@given(linear_models())
def test_reflected_mass_and_static_stiffness(model: LinearModel) -> None:
    M, K, j = dense(model)
    assert_near(reflected_mass(ca.DM(M), model.jacobian), 1 / (j @ np.linalg.solve(M, j)))
    k_c = 1 / (j @ np.linalg.solve(K, j))
    assert float(static_stiffness(model)) == pytest.approx(k_c, rel=1e-9)
    assert k_c <= float(reduce_to_two_masses(model).k_r) * (1 + 1e-12)  # a slow push meets less


def test_two_masses_are_found_exactly() -> None:
    """A mass, a spring and a mass are their own reduction, whatever the coordinates' scale."""
    M, K = np.diag([0.7, 3.0]), 2e4 * np.array([[1, -1], [-1, 1.0]])
    model = LinearModel(DenseMass(ca.DM(M)), ca.DM(K), ca.DM([[1.0, 0.0]]))
    reduced = reduce_to_two_masses(model)
    found = [float(x) for x in (reduced.m_c, reduced.k_r, reduced.m_a)]
    assert found == pytest.approx([0.7, 2e4, 3.0], rel=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_symbols_give_the_same_numbers(kind: Matrix) -> None:
    model = random_linear_model(7, 5)
    M, K, J = (
        kind.sym(name, *shape) for name, shape in (("M", (5, 5)), ("K", (5, 5)), ("J", (1, 5)))
    )
    symbolic = LinearModel(DenseMass(M), K, J)
    reduced = reduce_to_two_masses(symbolic)
    outputs = [reduced.m_c, reduced.k_r, reduced.m_a, static_stiffness(symbolic)]
    found = ca.Function("f", [M, K, J], outputs)(model.mass.matrix, model.stiffness, model.jacobian)
    ours = reduce_to_two_masses(model)
    expected = [ours.m_c, ours.k_r, ours.m_a, static_stiffness(model)]
    assert_near([float(x) for x in found], [float(x) for x in expected], 1e-13)


def test_a_rigid_robot_without_gains_has_no_spring() -> None:
    """Nothing holds it: k_r is zero and m_a is not defined."""
    robot = load_robot("panda")
    model = impact_model(robot)
    q = np.array([0.1, 0.3, -0.2, -2.0, 0.4, 1.8, 0.6])
    reduced = model.reduced(q, np.array([0, 1.0, 0]))
    assert float(reduced.m_c) > 0
    assert float(reduced.k_r) == 0
    assert np.isnan(float(reduced.m_a))
