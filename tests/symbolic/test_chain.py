# SPDX-License-Identifier: BSD-3-Clause
"""The chain against a dense Lanczos recurrence, SciPy's eigenvalues and the paper's J_x."""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st
from linear_models import (
    dense,
    lanczos,
    linear_models,
    modes,
    nullspace,
    random_linear_model,
    second_mass,
    transformed,
)
from oracles import assert_near
from symbol_kinds import KINDS

from softimpact.symbolic import (
    Chain,
    InvalidValue,
    LinearModel,
    Matrix,
    chain,
    drives,
    free_end,
    impact_model,
    load_robot,
    reduce_to_two_masses,
)
from softimpact.symbolic.impact.elastic import DenseMass
from softimpact.symbolic.robot.rigid import Array

POSE = np.array([0.1, 0.3, -0.2, -2.0, 0.4, 1.8, 0.6])
ALONG_Y = np.array([0.0, 1.0, 0.0])


def numbers(found: Chain) -> tuple[Array, Array]:
    """Masses and springs of a numeric chain."""
    return np.array([float(m) for m in found.mass]), np.array([float(k) for k in found.stiffness])


def matrices(mass: Array, stiffness: Array) -> tuple[Array, Array]:
    """M and K of a chain, by hand: spring i joins masses i and i+1, the last one the ground."""
    n = len(mass)
    K = np.zeros((n, n))
    for i, k in enumerate(stiffness):
        K[i, i] += k
        if i + 1 < n:
            K[i + 1, i + 1] += k
            K[i, i + 1] -= k
            K[i + 1, i] -= k
    return np.diag(mass), K


@settings(max_examples=50)
@given(linear_models(6), st.integers(1, 4))
def test_chain_is_the_dense_lanczos_recurrence(model: LinearModel, order: int) -> None:
    order = min(order, model.stiffness.shape[0])
    diagonal, beside, _ = lanczos(model, order)
    m, k = numbers(chain(model, order))
    mass, stiffness = matrices(m, k)
    root = np.sqrt(np.diag(mass))
    T = stiffness / np.outer(root, root)
    expected = np.diag(diagonal) - np.diag(beside, 1) - np.diag(beside, -1)
    assert_near(T, expected, 1e-7)


@given(linear_models())
def test_first_mass_and_spring_are_those_of_the_paper(model: LinearModel) -> None:
    m, k = numbers(chain(model, 2))
    reduced = reduce_to_two_masses(model)
    assert m[0] == pytest.approx(float(reduced.m_c), rel=1e-12)
    assert k[0] == pytest.approx(float(reduced.k_r), rel=1e-12)


@given(linear_models(), st.integers(0, 1000))
def test_second_mass_is_the_inertia_of_the_papers_coordinate(model: LinearModel, seed: int) -> None:
    """m_2 = (J_x M_a⁻¹ J_xᵀ)⁻¹ for every nullspace."""
    m, _ = numbers(chain(model, 2, "free"))
    assert m[1] == pytest.approx(second_mass(model, nullspace(model, seed)), rel=1e-9)


@pytest.mark.parametrize("size", [2, 3, 5, 8])
def test_full_chain_has_the_models_frequencies(size: int) -> None:
    model = random_linear_model(size, size)
    found = chain(model, size, reorthogonalise=True)
    mass, stiffness = matrices(*numbers(found))
    squares, shares = modes(model)
    ours, shapes = scipy.linalg.eigh(stiffness, mass)
    assert_near(ours, squares, 1e-9)
    assert_near(abs(shapes[0]), abs(shares), 1e-8)  # and the contact point's part in each


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_chain_of_order_r_keeps_2r_moments(order: int) -> None:
    """J_c (M0⁻¹K0)^k M0⁻¹ J_cᵀ for k < 2r: the response to a push, in powers of time."""
    model = random_linear_model(11, 7)
    M, K, j = dense(model)
    mass, stiffness = matrices(*numbers(chain(model, order)))
    first = np.eye(order)[0]
    x, y = np.linalg.solve(M, j), np.linalg.solve(mass, first)
    for _ in range(2 * order):
        assert first @ y == pytest.approx(j @ x, rel=1e-8)
        x, y = np.linalg.solve(M, K @ x), np.linalg.solve(mass, stiffness @ y)
    assert first @ y != pytest.approx(j @ x, rel=1e-6)  # and no further


@given(linear_models(6))
def test_masses_move_by_their_displacement(model: LinearModel) -> None:
    """Wᵀ Δq of the contact mass is J_c Δq; W is orthogonal in M0⁻¹, with 1/m on the diagonal."""
    found = chain(model, 3 if model.stiffness.shape[0] > 2 else 2)
    M, _, j = dense(model)
    W = np.array(found.displacement)
    assert_near(W[:, 0], j, 1e-12)
    m, _ = numbers(found)
    gram = W.T @ np.linalg.solve(M, W) * np.sqrt(np.outer(m, m))
    assert_near(gram, np.eye(found.order), 1e-7)


def test_reorthogonalising_changes_nothing_but_rounding() -> None:
    model = random_linear_model(3, 8)
    plain = chain(model, 4)
    for careful in (True, "once"):
        found = chain(model, 4, reorthogonalise=careful)
        for ours, theirs in zip(numbers(plain), numbers(found), strict=True):
            assert_near(ours, theirs, 1e-9)


def test_free_end_drops_the_last_spring() -> None:
    model = random_linear_model(3, 6)
    grounded, free = chain(model, 3), chain(model, 3, "free")
    assert_near(numbers(free)[0], numbers(grounded)[0], 0)
    assert_near(numbers(free)[1], [*numbers(grounded)[1][:-1], 0.0], 0)
    assert_near(numbers(free_end(grounded))[1], numbers(free)[1], 0)


def test_a_chain_is_its_own_chain() -> None:
    mass, stiffness = np.array([0.7, 2.0, 5.0]), np.array([3e4, 1e4, 2e3])
    M, K = matrices(mass, stiffness)
    model = LinearModel(DenseMass(ca.DM(M)), ca.DM(K), ca.DM([[1.0, 0, 0]]))
    m, k = numbers(chain(model, 3))
    assert m == pytest.approx(mass, rel=1e-10)
    assert k == pytest.approx(stiffness, rel=1e-8)


def test_chain_closes_where_springs_reach_no_further() -> None:
    """RR without gains: two springs, so three masses are exact and a fourth does not exist."""
    model = impact_model(load_robot("rr"), drives=drives(load_robot("rr")))
    linear = model.linear(np.array([0, 0, np.pi / 3, 0]), np.array([0.6, 0.8, 0]))
    found = chain(linear, 4, reorthogonalise=True)
    m, k = numbers(found)
    assert found.order == 3
    assert abs(k[-1]) < 1e-9 * k[0]
    squares, _ = modes(linear)
    ours = scipy.linalg.eigvalsh(matrices(m, k)[1], matrices(m, k)[0])
    assert_near(ours[-2:], squares[-2:], 1e-9)


def test_chain_of_a_rigid_robot_without_gains_is_one_free_mass() -> None:
    model = impact_model(load_robot("panda"))
    found = model.chain(POSE, ALONG_Y, 3)
    m, k = numbers(found)
    assert found.order == 1
    assert k[0] == 0
    assert m[0] == pytest.approx(float(model.reflected_mass(POSE, ALONG_Y)))


def test_chain_of_one_joint(tmp_path: Path) -> None:
    path = tmp_path / "one.xml"
    path.write_text(
        '<mujoco><custom><text name="tip" data="p"/></custom><worldbody><body name="b">'
        '<joint name="j" armature="0.5"/><inertial pos="0.5 0 0" mass="2" diaginertia="1 1 1"/>'
        '<site name="p" pos="1 0 0"/></body></worldbody></mujoco>'
    )
    robot = load_robot(path)
    model = impact_model(robot, drives=drives(robot, joint_stiffness=100.0))
    m, k = numbers(model.chain([0.0], ALONG_Y, 2))
    assert m == pytest.approx([1.5, 0.5])  # link and rotor, a metre from the axis
    assert k == pytest.approx([100.0, 0.0], abs=1e-9)
    assert model.chain([0.0], ALONG_Y, 2).order == 2
    rigid = impact_model(robot, drives=drives(robot, position_gain=80.0))
    m, k = numbers(rigid.chain([0.0], ALONG_Y, 1))
    assert (m[0], k[0]) == (pytest.approx(2.0), pytest.approx(80.0))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("careful", [False, True, "once"])
def test_symbols_give_the_same_numbers(kind: Matrix, careful: bool) -> None:
    model = random_linear_model(7, 6)
    M, K, J = kind.sym("M", 6, 6), kind.sym("K", 6, 6), kind.sym("J", 1, 6)
    symbolic = chain(LinearModel(DenseMass(M), K, J), 3, reorthogonalise=careful)
    outputs = [ca.vertcat(*symbolic.mass), ca.vertcat(*symbolic.stiffness), symbolic.displacement]
    found = ca.Function("f", [M, K, J], outputs)(model.mass.matrix, model.stiffness, model.jacobian)
    expected = chain(model, 3, reorthogonalise=careful)
    assert_near(found[0], numbers(expected)[0], 1e-11)
    assert_near(found[1], numbers(expected)[1], 1e-11)
    assert_near(found[2], expected.displacement, 1e-11)


@pytest.mark.parametrize("order", [0, -1])
def test_order_must_be_at_least_one(order: int) -> None:
    with pytest.raises(InvalidValue, match=f"order: must be at least 1, but is {order}") as caught:
        chain(random_linear_model(1, 3), order)
    assert caught.value.field == "order"


@pytest.mark.parametrize("seed", range(5))
def test_order_beyond_the_coordinates_adds_no_noise(seed: int) -> None:
    model = random_linear_model(seed, 3)
    full, more = chain(model, 3), chain(model, 9)
    assert more.order == 3
    assert_near(numbers(more)[0], numbers(full)[0], 0)
    J = ca.SX.sym("J", 1, 3)
    assert chain(LinearModel(model.mass, model.stiffness, J), 5).order == 3


def test_elastic_and_dense_mass_give_the_same_chain() -> None:
    robot = load_robot("panda")
    model = impact_model(robot, drives=drives(robot, joint_stiffness=1e4, position_gain=500.0))
    linear = model.linear(POSE, ALONG_Y)
    plain = LinearModel(DenseMass(linear.mass.matrix), linear.stiffness, linear.jacobian)
    for ours, theirs in zip(numbers(chain(linear, 3)), numbers(chain(plain, 3)), strict=True):
        assert_near(ours, theirs, 1e-8)


def test_change_of_coordinates_moves_nothing() -> None:
    model = random_linear_model(9, 6)
    T = np.random.default_rng(1).normal(size=(6, 6))
    for ours, theirs in zip(
        numbers(chain(transformed(model, T), 4)), numbers(chain(model, 4)), strict=True
    ):
        assert_near(ours, theirs, 1e-8)


@pytest.mark.parametrize("unit", [1e-15, 1.0, 1e15])
def test_where_a_chain_closes_does_not_depend_on_the_unit_of_mass(unit: float) -> None:
    """Of eight coordinates the contact point sees five: the others stand apart."""
    seen, apart = random_linear_model(3, 5), random_linear_model(4, 3)
    M, K = (scipy.linalg.block_diag(dense(seen)[i], dense(apart)[i]) for i in range(2))
    along = np.append(dense(seen)[2], np.zeros(3))
    model = LinearModel(DenseMass(ca.DM(unit * M)), ca.DM(unit * K), ca.DM(along).T)
    found = chain(model, 8, reorthogonalise=True)
    assert len(found.mass) == 5
    assert float(found.mass[0]) / unit == pytest.approx(float(chain(seen, 1).mass[0]))
