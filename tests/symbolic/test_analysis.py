# SPDX-License-Identifier: BSD-3-Clause
"""``analyse``: laws on random robots, and what does not apply."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from random_robots import arms, robots, unit_vector

from softimpact.symbolic import (
    Frame,
    InvalidValue,
    Joint,
    JointKind,
    Robot,
    SingularDirection,
    WrongLength,
    analyse,
    chain_to,
    drives,
    impact_model,
)
from softimpact.symbolic.robot.rigid import Inertia, Placement, rotation_from_axis


def crank(kind: JointKind = JointKind.HINGE, arm: float = 0.5, height: float = 0.0) -> Robot:
    """One joint about z with 2 kg at its tip, and a rotor of 0.3 kg m²."""
    place = Placement(np.eye(3), np.array([arm, 0.0, height]))
    body = Inertia.from_center_of_mass(2.0, [arm, 0.0, 0.0], 1e-9 * np.eye(3))
    joint = Joint("j", kind, -1, Placement.identity(), body, armature=0.3)
    return Robot("crank", (joint,), {"tip": Frame("tip", 0, place)}, "tip")


@settings(max_examples=15)
@given(arms(), st.integers(0, 999), st.floats(1e2, 1e5))
def test_laws_of_elastic_arms(robot: Robot, seed: int, stiffness: float) -> None:
    model = impact_model(robot, drives=drives(robot, stiffness))
    q, n = np.random.default_rng(seed).uniform(-2, 2, robot.n), unit_vector(seed)
    a = analyse(model, q, n, order=4)
    assume(a.giaf is not None)
    assert a.giaf is not None
    assert a.giif is not None
    assert a.directional_giaf is not None
    assert a.osim is not None
    assert a.osim_free is not None
    assert 0 < a.m_c <= a.reflected_mass_rigid * (1 + 1e-9)
    assert 0 < a.giaf <= 1
    assert 0 <= a.giif <= 1
    assert 0 < a.directional_giaf <= 1
    assert a.m_c == pytest.approx(a.chain.mass[0], rel=1e-12)
    assert a.k_r == pytest.approx(a.chain.stiffness[0], rel=1e-12)
    assert min(a.chain.mass) > 0
    assert 1 / a.m_c == pytest.approx(n @ np.linalg.inv(a.osim_free) @ n, rel=1e-6)
    assert np.linalg.eigvalsh(a.osim - a.osim_free).min() > -1e-6 * np.linalg.norm(a.osim)


@settings(max_examples=25)
@given(robots(), st.integers(0, 999))
def test_any_tree_of_hinges_and_slides_has_an_answer(robot: Robot, seed: int) -> None:
    chain = chain_to(robot, "tip")
    model = impact_model(chain, drives=drives(chain, 1e3, position_gain=1e2))
    q, n = np.random.default_rng(seed).uniform(-2, 2, chain.n), unit_vector(seed)
    try:
        a = analyse(model, q, n)
    except SingularDirection:
        assert np.linalg.norm(n @ np.array(model.jacobian(q))) < 1e-4
        return
    numbers = [a.m_c, a.k_r, a.static_stiffness, *a.chain.mass, *a.chain.stiffness]
    assert all(x is not None and np.isfinite(x) for x in numbers)
    if chain.n < 3:
        assert a.giaf is None
    elif np.linalg.svd(a.jacobian, compute_uv=False)[2] > 1e-3:
        assert a.giaf is not None


def test_one_held_joint_is_a_mass_on_a_spring() -> None:
    model = impact_model(crank(), drives=drives(crank(), position_gain=50.0))
    a = analyse(model, [0.0], [0, 2, 0], order=5)
    mass = (2 * 0.5**2 + 0.3) / 0.5**2
    assert a.m_c == pytest.approx(mass)
    assert a.k_r == a.static_stiffness == pytest.approx(50 / 0.5**2)
    assert a.m_a is None
    assert a.chain.mass == pytest.approx((mass,))
    assert a.chain.stiffness == pytest.approx((50 / 0.5**2,))
    assert (a.giaf, a.giif, a.directional_giaf, a.osim, a.osim_free) == (None,) * 5


def test_one_elastic_joint_is_two_masses() -> None:
    a = analyse(impact_model(crank(), drives=drives(crank(), 80.0)), [0.0], [0, 1, 0])
    assert a.m_c == pytest.approx(2.0, rel=1e-6)
    assert a.k_r == pytest.approx(80 / 0.5**2)
    assert a.chain.mass == pytest.approx((2.0, 0.3 / 0.5**2), rel=1e-6)
    assert a.static_stiffness is None  # the motor gives way


def test_rigid_joint_without_gains_has_only_a_mass() -> None:
    a = analyse(impact_model(crank(JointKind.SLIDE)), [0.4], [0, 0, 1])
    assert a.m_c == a.reflected_mass_rigid == pytest.approx(2.3)
    assert (a.k_r, a.m_a, a.static_stiffness) == (None, None, None)
    assert a.chain.mass == pytest.approx((2.3,))
    assert a.chain.stiffness == (0.0,)


@pytest.mark.parametrize(
    ("robot", "direction"),
    [
        (crank(), [1, 0, 0]),
        (crank(), [0, 0, 1]),
        (crank(), [1, 1e-9, 0]),
        (crank(arm=0.0, height=0.7), [0, 1, 0]),
        (crank(JointKind.SLIDE), [0, 1, 0]),
    ],
)
def test_singular_directions(robot: Robot, direction: list[float]) -> None:
    with pytest.raises(SingularDirection) as caught:
        analyse(impact_model(robot), [0.0], direction)
    length = np.linalg.norm(direction)
    assert caught.value.direction == pytest.approx(tuple(x / length for x in direction))


def test_bad_arguments() -> None:
    model = impact_model(crank())
    with pytest.raises(WrongLength, match="q: has 2 values"):
        analyse(model, [0.0, 0.0], [0, 1, 0])
    with pytest.raises(InvalidValue, match="q: needs finite"):
        analyse(model, [np.nan], [0, 1, 0])
    with pytest.raises(InvalidValue, match="direction: must not be zero"):
        analyse(model, [0.0], [0, 0, 0])
    with pytest.raises(InvalidValue, match="order: must be at least 1"):
        analyse(model, [0.0], [0, 1, 0], order=0)


def test_slides_without_length_span_a_plane() -> None:
    """Three slides in a plane; the size of their J is no length of links."""
    turns = [rotation_from_axis(np.array([1.0, 0, 0]), angle) for angle in (0.3, 1.1, 2.3)]
    ball = Inertia.from_center_of_mass(1.0, np.zeros(3), 0.1 * np.eye(3))
    joints, before = [], np.eye(3)
    for i, turn in enumerate(turns):
        place = Placement(before.T @ turn, np.zeros(3))
        joints.append(Joint(f"s{i}", JointKind.SLIDE, i - 1, place, ball, armature=0.1))
        before = turn
    tip = Frame("tip", 2, Placement.identity())
    robot = Robot("plane", tuple(joints), {"tip": tip}, "tip")
    found = analyse(impact_model(robot), [0.0] * 3, [0, 1, 0])
    assert found.osim is None
    assert found.giaf is None
