# SPDX-License-Identifier: BSD-3-Clause
"""The impact model puts the parts together."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from linear_models import nullspace, with_nullspace
from oracles import assert_near, configurations, example_urdf
from random_robots import unit_vector
from symbol_kinds import KINDS

from softimpact.symbolic import (
    FrameNotFound,
    ImpactModel,
    InvalidValue,
    Matrix,
    Robot,
    WrongLength,
    drives,
    frame_jacobian,
    impact_model,
    load_robot,
)


@pytest.fixture(scope="module")
def model() -> ImpactModel:
    robot = load_robot("panda")
    return impact_model(
        robot, drives=drives(robot, joint_stiffness=5e3, computed_torque_gain=100.0)
    )


def test_size_counts_motors_and_deflections(model: ImpactModel) -> None:
    assert model.size == 14
    k_s = [1e3, np.inf, 1e3, 1e3, 1e3, 1e3, 1e3]
    assert impact_model(model.robot, drives=drives(model.robot, k_s)).size == 13
    assert impact_model(model.robot).size == 7


def test_tip_is_the_robots_own_unless_named(model: ImpactModel) -> None:
    assert model.tip == "hand_tcp"
    other = impact_model(model.robot, "link4")
    q = next(configurations(model.robot, 1))
    assert_near(other.jacobian(q), np.array(frame_jacobian(model.robot, "link4", q))[:3])
    with pytest.raises(FrameNotFound, match=r"'elbow'.*link4"):
        impact_model(model.robot, "elbow")


def test_a_robot_without_tip_asks_for_one() -> None:
    robot = load_robot(example_urdf("ur5_robot.urdf"))
    with pytest.raises(InvalidValue, match=r"tip: robot 'ur5' has none of its own.*tool0"):
        impact_model(robot)


@pytest.mark.parametrize("gravity", [(0.0, -9.81), (0.0, 0.0, np.nan), (0.0, 0.0, np.inf)])
def test_gravity_is_three_finite_numbers(panda: Robot, gravity: tuple[float, ...]) -> None:
    with pytest.raises(InvalidValue, match="gravity: needs three finite numbers"):
        impact_model(panda, gravity=gravity)


def test_drives_must_be_the_robots(panda: Robot) -> None:
    with pytest.raises(WrongLength, match="drives: has 4 values, but 7"):
        impact_model(panda, drives=drives(load_robot("rr")))


def test_reduction_of_the_panda_is_the_papers(model: ImpactModel) -> None:
    q, n = next(configurations(model.robot, 1)), unit_vector(1)
    linear, ours = model.linear(q, ca.DM(n)), model.reduced(q, ca.DM(n))
    m_c, k_r, m_a = with_nullspace(linear, nullspace(linear, 0))
    assert float(ours.m_c) == pytest.approx(m_c, rel=1e-10)
    assert float(ours.k_r) == pytest.approx(k_r, rel=1e-9)
    assert float(ours.m_a) == pytest.approx(m_a, rel=1e-8)
    assert float(model.reflected_mass(q, ca.DM(n))) == pytest.approx(m_c, rel=1e-10)


def test_with_springs_replaces_only_them(model: ImpactModel) -> None:
    q = next(configurations(model.robot, 1))
    k_s = np.linspace(1e3, 2e3, 7)
    expected = drives(model.robot, k_s, computed_torque_gain=100.0)
    other = impact_model(model.robot, drives=expected)
    found = model.with_springs(ca.DM(k_s))
    assert_near(found.generalised_stiffness(q), other.generalised_stiffness(q), 0)
    assert_near(found.generalised_mass(q).matrix, model.generalised_mass(q).matrix, 0)


@pytest.mark.parametrize("kind", KINDS)
def test_symbols_give_the_same_numbers(model: ImpactModel, kind: Matrix) -> None:
    q, n, k_s = next(configurations(model.robot, 1)), unit_vector(3), np.linspace(1e3, 2e3, 7)
    x, d, k = kind.sym("q", 7), kind.sym("n", 3), kind.sym("k", 7)

    def all_of(q: Matrix, n: Matrix, k: Matrix) -> list[Matrix]:
        m = model.with_springs(k)
        reduced, masses = m.reduced(q, n), m.chain(q, n, 3)
        parts = [reduced.m_c, reduced.k_r, reduced.m_a, m.reflected_mass(q, n)]
        parts += [ca.vertcat(*masses.mass), ca.vertcat(*masses.stiffness)]
        linear = m.linear(q, n)
        return [*parts, linear.mass.matrix, linear.stiffness, linear.jacobian, m.jacobian(q)]

    found = ca.Function("f", [x, d, k], all_of(x, d, k))(q, n, k_s)
    for ours, theirs in zip(found, all_of(ca.DM(q), ca.DM(n), ca.DM(k_s)), strict=True):
        assert_near(ours, theirs, 1e-11)


def test_programs_for_0_1_0_still_name_drives_as_they_did(panda: Robot) -> None:
    given = drives(panda, 3e3)
    with pytest.warns(DeprecationWarning, match=r"impact_model\(drives_=…\) is drives= now"):
        former = impact_model(panda, **{"drives_": given})  # type: ignore[arg-type]
    assert former == impact_model(panda, drives=given)
