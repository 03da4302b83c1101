# SPDX-License-Identifier: BSD-3-Clause
"""Laws of reflected masses, chains and impact factors, on random arms."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from hypothesis import assume, given, settings
from linear_models import linear_models, modes, random_linear_model, transformed
from oracles import assert_near
from random_robots import arms, placements, seeds, unit_vector, vectors

from softimpact.symbolic import (
    ContactMobility,
    ImpactModel,
    LinearModel,
    Robot,
    chain,
    directional_giaf,
    drives,
    giaf,
    giif,
    impact_model,
    least_velocity,
    reduce_to_two_masses,
    static_stiffness,
)
from softimpact.symbolic.impact.reduction import contact_mode
from softimpact.symbolic.robot.rigid import Array, Inertia, Placement, rotation_about_z

LAWS = settings(max_examples=40)


def mobilities(model: ImpactModel, q: Array) -> tuple[ContactMobility, ContactMobility]:
    """Free and real mobility; the laws are told only where the tip moves in every direction."""
    free, real = model.free_mobility(q), model.mobility(q)
    assume(np.linalg.cond(np.array(free.matrix)) < 1e6)
    return free, real


@LAWS
@given(arms(), vectors(5))
def test_rotors_add_inertia_in_every_direction(robot: Robot, q: Array) -> None:
    """Λ ≻ 0 and Λ ⪰ Λ_F."""
    free, real = mobilities(impact_model(robot), q[: robot.n])
    L, L_F = np.array(real.inertia), np.array(free.inertia)
    assert_near(L, L.T, 1e-12)
    assert np.linalg.eigvalsh(L_F).min() > 0
    assert np.linalg.eigvalsh(L - L_F).min() > -1e-8 * abs(L).max()


@LAWS
@given(arms(), vectors(5), seeds)
def test_impact_factors_are_shares(robot: Robot, q: Array, seed: int) -> None:
    """0 ≤ ζ, ζ_x ≤ 1 and 0 ≤ GIIF ≤ 1."""
    free, real = mobilities(impact_model(robot), q[: robot.n])
    x = unit_vector(seed)
    for factor in (giaf(free, real), directional_giaf(free, real, x), giif(free, real)):
        assert -1e-9 <= float(factor) <= 1 + 1e-9


@LAWS
@given(arms(), vectors(5), seeds)
def test_without_rotors_everything_is_absorbed(robot: Robot, q: Array, seed: int) -> None:
    model = impact_model(robot.with_armature(np.zeros(robot.n)))
    free, real = mobilities(model, q[: robot.n])
    assert float(giaf(free, real)) == pytest.approx(1, rel=1e-9)
    assert float(directional_giaf(free, real, unit_vector(seed))) == pytest.approx(1, rel=1e-9)
    assert float(giif(free, real)) == pytest.approx(0, abs=1e-9)


@LAWS
@given(arms(), vectors(5), seeds)
def test_giaf_falls_as_any_rotor_grows(robot: Robot, q: Array, seed: int) -> None:
    q = q[: robot.n]
    bigger = robot.armature.copy()
    bigger[seed % robot.n] *= 2
    free, real = mobilities(impact_model(robot), q)
    heavy = impact_model(robot.with_armature(bigger)).mobility(q)
    x = unit_vector(seed)
    assert float(giaf(free, heavy)) <= float(giaf(free, real)) * (1 + 1e-9)
    before, after = (float(directional_giaf(free, m, x)) for m in (real, heavy))
    assert after <= before * (1 + 1e-9)


@LAWS
@given(arms(), vectors(5), seeds)
def test_directional_factors_lie_between_the_extremes(robot: Robot, q: Array, seed: int) -> None:
    """ζ is the product of the three principal directional factors."""
    free, real = mobilities(impact_model(robot), q[: robot.n])
    shares = np.linalg.eigvals(np.linalg.solve(np.array(real.inertia), np.array(free.inertia))).real
    assert np.prod(shares) == pytest.approx(float(giaf(free, real)), rel=1e-6)
    along = float(directional_giaf(free, real, unit_vector(seed)))
    assert shares.min() - 1e-7 <= along <= shares.max() + 1e-7


@LAWS
@given(arms(), vectors(5), seeds, placements())
def test_the_base_may_stand_anywhere(robot: Robot, q: Array, seed: int, place: Placement) -> None:
    """GIAF and m_c do not change when base, robot and direction are moved together."""
    q, n = q[: robot.n], unit_vector(seed)
    first = replace(robot.joints[0], placement=place @ robot.joints[0].placement)
    moved = replace(robot, joints=(first, *robot.joints[1:]))
    here, there = impact_model(robot), impact_model(moved)
    free, real = mobilities(here, q)
    expected = float(giaf(free, real))
    assert float(giaf(there.free_mobility(q), there.mobility(q))) == pytest.approx(
        expected, rel=1e-7
    )
    m_c = float(here.reflected_mass(q, n))
    assert float(there.reflected_mass(q, place.rotation @ n)) == pytest.approx(m_c, rel=1e-9)


@LAWS
@given(arms(), vectors(5), seeds)
def test_the_first_joint_turns_base_and_direction_alike(robot: Robot, q: Array, seed: int) -> None:
    """GIAF does not depend on q1, nor does m_c along a direction that turns with it."""
    q, n = q[: robot.n], unit_vector(seed)
    turned = q.copy()
    turned[0] += 0.31
    model = impact_model(robot)
    free, real = mobilities(model, q)
    expected = float(giaf(free, real))
    other = giaf(model.free_mobility(turned), model.mobility(turned))
    assert float(other) == pytest.approx(expected, rel=1e-7)
    axis = robot.joints[0].placement
    R = axis.rotation @ rotation_about_z(0.31) @ axis.rotation.T
    m_c = float(model.reflected_mass(q, n))
    assert float(model.reflected_mass(turned, R @ n)) == pytest.approx(m_c, rel=1e-9)


@LAWS
@given(arms(), vectors(5), seeds)
def test_elastic_robots_hit_with_their_links_alone(robot: Robot, q: Array, seed: int) -> None:
    """m_c of the elastic robot is (nᵀΛ_F⁻¹n)⁻¹, whatever its rotors, springs and gains."""
    q, n = q[: robot.n], unit_vector(seed)
    elastic = impact_model(
        robot, drives=drives(robot, joint_stiffness=1e3, computed_torque_gain=77.0)
    )
    expected = 1 / (n @ np.array(elastic.free_mobility(q).matrix) @ n)
    assert float(elastic.reflected_mass(q, n)) == pytest.approx(expected, rel=1e-9)
    reduced = elastic.reduced(q, ca.DM(n))
    assert float(reduced.m_c) == pytest.approx(expected, rel=1e-8)
    assert min(float(x) for x in (reduced.m_c, reduced.k_r, reduced.m_a)) > 0


@LAWS
@given(arms(), vectors(5), seeds)
def test_rigid_robots_hit_with_their_rotors_too(robot: Robot, q: Array, seed: int) -> None:
    """m_c of the rigid robot is (nᵀΛ⁻¹n)⁻¹, and never less than the elastic robot's."""
    q, n = q[: robot.n], unit_vector(seed)
    rigid = impact_model(robot)
    expected = 1 / (n @ np.array(rigid.mobility(q).matrix) @ n)
    m_c = float(rigid.reflected_mass(q, n))
    assert m_c == pytest.approx(expected, rel=1e-9)
    elastic = impact_model(robot, drives=drives(robot, joint_stiffness=1e3))
    assert m_c >= float(elastic.reflected_mass(q, n)) * (1 - 1e-9)


@LAWS
@given(arms(), vectors(5), seeds)
def test_stiff_springs_make_the_rigid_robot(robot: Robot, q: Array, seed: int) -> None:
    """What a slow enough force feels of the masses: with k_s → ∞ the rigid reflected mass.

    Rigid motions are the model's slow modes: the mobility they leave at the contact is J(M+B)⁻¹Jᵀ.
    """
    q, n = q[: robot.n], unit_vector(seed)
    stiff = impact_model(robot, drives=drives(robot, joint_stiffness=1e9)).linear(q, ca.DM(n))
    squares, shares = modes(stiff)
    slow = np.argsort(squares)[: robot.n]
    rigid = float(impact_model(robot).reflected_mass(q, n))
    assert 1 / np.sum(shares[slow] ** 2) == pytest.approx(rigid, rel=1e-6)


@LAWS
@given(linear_models(), seeds)
def test_no_change_of_coordinates_moves_the_physics(model: LinearModel, seed: int) -> None:
    """m_c, k_r, k_c and the chain are of the robot, not of the coordinates."""
    size = model.stiffness.shape[0]
    T = np.random.default_rng(seed).normal(size=(size, size))
    assume(np.linalg.cond(T) < 30)
    other = transformed(model, T)
    ours, theirs = reduce_to_two_masses(model), reduce_to_two_masses(other)
    assert float(theirs.m_c) == pytest.approx(float(ours.m_c), rel=1e-9)
    assert float(theirs.k_r) == pytest.approx(float(ours.k_r), rel=1e-8)
    assert float(static_stiffness(other)) == pytest.approx(float(static_stiffness(model)), rel=1e-7)
    here, there = chain(model, 3), chain(other, 3)
    for a, b in zip([*here.mass, *here.stiffness], [*there.mass, *there.stiffness], strict=True):
        assert float(b) == pytest.approx(float(a), rel=1e-5)


def test_the_papers_second_mass_is_moved_by_coordinates() -> None:
    """m_a is a least-squares fit in the Frobenius norm, which no change of coordinates respects."""
    model = random_linear_model(2, 4)
    random = np.random.default_rng(0)
    found = [
        float(reduce_to_two_masses(transformed(model, random.normal(size=(4, 4)))).m_a)
        for _ in range(10)
    ]
    assert max(found) > 1.2 * min(found)
    physical = [
        float(chain(transformed(model, random.normal(size=(4, 4))), 2).mass[1]) for _ in "ab"
    ]
    assert physical[0] == pytest.approx(physical[1], rel=1e-6)


@LAWS
@given(linear_models())
def test_the_complement_does_not_move_the_contact(model: LinearModel) -> None:
    """S = I − J_c# J_c: J_c S = 0, S J_c# = 0, S² = S, and N = M0 S is symmetric (MSM Eq. 66)."""
    mode = contact_mode(model)
    j = np.array(model.jacobian)
    d, m_c = np.array(mode.direction), float(mode.m_c)
    S = np.eye(j.size) - d @ j
    assert_near(j @ S, 0 * j, 1e-9)
    assert_near(S @ d, 0 * d, 1e-9)
    assert_near(S @ S, S, 1e-9)
    M = np.array(model.mass.matrix)
    assert_near(M @ S, M - m_c * j.T @ j, 1e-9)
    assert_near(S.T @ M @ S, M @ S, 1e-9)


@LAWS
@given(arms(4, 6), vectors(6), seeds)
def test_least_velocity_has_no_part_that_leaves_the_point_at_rest(
    robot: Robot, q: Array, seed: int
) -> None:
    q, n = q[: robot.n], unit_vector(seed)
    J = np.array(impact_model(robot).jacobian(q))
    assume(np.linalg.cond(J) < 1e3)
    v = np.array(least_velocity(ca.DM(J), ca.DM(n))).ravel()
    assert_near(J @ v, n, 1e-9)
    self_motions = np.linalg.svd(J)[2][3:]
    assert abs(self_motions @ v).max() < 1e-9 * abs(v).max()


@LAWS
@given(arms(), vectors(5), seeds)
def test_heavier_is_harder(robot: Robot, q: Array, seed: int) -> None:
    """Mass added to the last body never lowers m_c."""
    q, n = q[: robot.n], unit_vector(seed)
    last = robot.joints[-1]
    load = Inertia.from_center_of_mass(1.0, [0.1, 0.2, 0.0], np.zeros((3, 3)))
    loaded = replace(robot, joints=(*robot.joints[:-1], replace(last, inertia=last.inertia + load)))
    light, heavy = (float(impact_model(r).reflected_mass(q, n)) for r in (robot, loaded))
    assert heavy >= light * (1 - 1e-9)
