# SPDX-License-Identifier: BSD-3-Clause
"""Closing loops, and where springs and gravity balance in closed chains."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from mechanisms import FIVE_BAR, SIX_BAR, SPATIAL, four_bar, robot_of
from oracles import Mujoco, assert_near
from scipy.integrate import solve_ivp

from softimpact.robots import built_in_robots
from softimpact.symbolic import (
    InvalidValue,
    LoopCannotClose,
    NoEquilibrium,
    Robot,
    SingularLoop,
    WrongLength,
    analyse,
    close_loops,
    closed_chain,
    closed_near,
    configuration_at_rest,
    drives,
    gravity_torques,
    impact_model,
    link_angles_at_rest,
    load_robot,
    loop_gaps,
    loop_tangent,
    potential_energy,
    require_closed_at,
)
from softimpact.symbolic.robot.rigid import Array

GRAVITY = (0.0, 0.0, -9.81)
MSM = np.radians([-130.6, -50.0])


def rmin(k_s: float = 351.0) -> Robot:
    """Return R-Min with other springs."""
    robot = load_robot("rmin")
    joints = [replace(j, stiffness=k_s if j.stiffness else 0.0) for j in robot.joints]
    return replace(robot, joints=tuple(joints))


def test_four_bar_closes_as_geometry_says(tmp_path: Path) -> None:
    """The crank's end and the rocker's are coupler's length apart, on the branch of home."""
    robot = four_bar(tmp_path)
    for crank in np.linspace(-3.0, 3.0, 13):
        q = close_loops(robot, [crank])
        end = 0.2 * np.array([np.cos(crank), np.sin(crank)])
        eye = np.array([0.6, 0.0]) + 0.4 * np.array([np.cos(q[2]), np.sin(q[2])])
        assert q[0] == crank
        assert np.linalg.norm(eye - end) == pytest.approx(0.5, abs=1e-10)
        assert eye[1] > 0  # the other branch has the rocker below


@pytest.mark.parametrize("text", [FIVE_BAR, SPATIAL])
def test_loops_stay_closed_and_the_way_does_not_matter(text: str, tmp_path: Path) -> None:
    robot = robot_of(tmp_path, text)
    chain = closed_chain(robot)
    u = chain.home[list(chain.independent)] + [-0.1, 0.1]
    q = close_loops(robot, u)
    assert abs(np.array(loop_gaps(robot, q))).max() < 1e-12
    assert_near(q[list(chain.independent)], u)
    detour = replace(robot, home=tuple(close_loops(robot, u + np.array([0.05, 0.05]))))
    assert_near(close_loops(detour, u), q, 1e-9)


def test_an_expression_closes_loops_too() -> None:
    robot = load_robot("rmin")
    chain = closed_chain(robot)
    u = chain.home[list(chain.independent)] + [0.1, -0.05, 0.02, 0.0]
    symbol = ca.SX.sym("u", 4)
    q = closed_near(robot, symbol, ca.DM(chain.home))
    function = ca.Function("q", [symbol], [q, ca.jacobian(q, symbol)])
    found, slope = (np.array(x) for x in function(u))
    assert_near(found, close_loops(robot, u), 1e-9)
    assert_near(slope, loop_tangent(robot, found), 1e-6)
    assert_near(closed_near(robot, ca.DM(u), ca.DM(chain.home)), found)


def test_a_crank_that_cannot_turn_there(tmp_path: Path) -> None:
    """With a coupler of 0.3 m the rocker's end is out of the crank's reach beyond 112°."""
    robot = four_bar(tmp_path, length="0.3")
    with pytest.raises(LoopCannotClose, match=r"'pin' does not close.*other coordinates") as error:
        close_loops(robot, [3.0])
    reach = np.hypot(0.6 - 0.2 * np.cos(3.0), 0.2 * np.sin(3.0)) - 0.7
    assert error.value.gap == pytest.approx(reach, rel=1e-6)
    with pytest.raises(SingularLoop, match="dead point"):
        close_loops(robot, [np.arccos((0.2**2 + 0.6**2 - 0.7**2) / (2 * 0.2 * 0.6))])


def test_open_configurations_are_refused() -> None:
    robot = load_robot("rmin")
    require_closed_at(robot, closed_chain(robot).home)
    with pytest.raises(LoopCannotClose, match=r"end_point.*apart; choose a closed configuration"):
        require_closed_at(robot, np.zeros(6))
    with pytest.raises(LoopCannotClose):
        analyse(impact_model(robot), np.zeros(6), [1.0, 0.0, 0.0])
    with pytest.raises(LoopCannotClose):
        require_closed_at(robot, np.full(6, np.nan))
    with pytest.raises(WrongLength, match=r"independent: has 2 values, but 4.*q11, q21, q13, q23"):
        close_loops(robot, [0.0, 0.0])


@pytest.mark.parametrize("k_s", [5.0, 351.0, 5e4])
def test_springs_and_loops_balance_gravity(k_s: float) -> None:
    """No torque is left along any motion of the joints without motors."""
    robot = rmin(k_s)
    q = configuration_at_rest(impact_model(robot, gravity=GRAVITY), MSM)
    assert_near(q[[0, 3]], MSM)
    require_closed_at(robot, q)
    left = np.array(loop_tangent(robot, q)).T @ np.array(gravity_torques(robot, q)).ravel()
    assert abs(left[2:]).max() < 1e-9 * max(1.0, k_s)
    assert 0 < abs(q[2]) < 0.2


def test_mujoco_needs_no_torque_to_stay_at_rest() -> None:
    """Constraint forces alone balance the passive joints in MuJoCo."""
    q = configuration_at_rest(impact_model(load_robot("rmin"), gravity=GRAVITY), MSM)
    oracle = Mujoco(built_in_robots()["rmin"]).at(q)
    G = np.array(loop_tangent(load_robot("rmin"), q))
    left = G.T @ (oracle.bias() - oracle.spring_torques())
    assert abs(left[2:]).max() < 1e-8
    assert abs(left[:2]).min() > 0.5  # the motors do need torques


def test_rest_is_a_minimum_of_the_energy() -> None:
    robot = rmin(20.0)
    q = configuration_at_rest(impact_model(robot, gravity=GRAVITY), MSM)
    u = q[list(closed_chain(robot).independent)]
    least = float(potential_energy(robot, q))
    random = np.random.default_rng(0)
    for _ in range(10):
        aside = close_loops(robot, u + np.array([0, 0, *1e-2 * random.normal(size=2)]))
        assert float(potential_energy(robot, aside)) > least


def test_springs_too_soft_to_hold_the_arm() -> None:
    """Upside down the distal links stand on their springs, which must exceed what gravity asks."""
    upside_down = (0.0, 0.0, 9.81)
    with pytest.raises(NoEquilibrium, match=r"q13, q23 are too soft.*gives way") as error:
        configuration_at_rest(impact_model(rmin(0.5), gravity=upside_down), MSM)
    assert error.value.residual > 0.01
    standing = configuration_at_rest(impact_model(rmin(1.0), gravity=upside_down), MSM)
    hanging = configuration_at_rest(impact_model(rmin(1.0), gravity=GRAVITY), MSM)
    assert standing[2] < -0.3 < 0.1 < hanging[2]


def test_a_joint_that_nothing_holds(tmp_path: Path) -> None:
    robot = robot_of(tmp_path, FIVE_BAR.replace('<motor joint="b1"/>', ""))
    loose = tuple(replace(joint, stiffness=0.0) for joint in robot.joints)
    with pytest.raises(NoEquilibrium, match="nothing holds"):
        configuration_at_rest(impact_model(replace(robot, joints=loose)), [0.0])


def test_drives_with_springs_sag_as_in_open_chains() -> None:
    """Without loops it is the same equilibrium as of link_angles_at_rest."""
    robot = load_robot("panda")
    theta = np.array([0.1, 0.3, -0.2, -2.0, 0.4, 1.8, 0.6])
    given = drives(robot, joint_stiffness=2e3)
    q = configuration_at_rest(impact_model(robot, drives=given, gravity=GRAVITY), theta)
    assert_near(q, link_angles_at_rest(robot, theta, np.full(7, 2e3)), 1e-9)
    assert abs(q - theta).max() > 1e-4


def test_without_gravity_springs_of_rmin_stay_unloaded() -> None:
    q = configuration_at_rest(impact_model(load_robot("rmin")), MSM)
    assert abs(q[[2, 5]]).max() < 1e-12


def test_four_bar_has_nothing_to_balance(tmp_path: Path) -> None:
    robot = four_bar(tmp_path)
    q = configuration_at_rest(impact_model(robot, gravity=GRAVITY), [0.5])
    assert_near(q, close_loops(robot, [0.5]))


def test_motor_angles_must_fit() -> None:
    model = impact_model(load_robot("rmin"), gravity=GRAVITY)
    with pytest.raises(WrongLength, match=r"motor_angles: has 3 values, but 2.*q11, q21"):
        configuration_at_rest(model, [0.0, 0.0, 0.0])
    with pytest.raises(InvalidValue, match="motor_angles: must hold finite numbers"):
        configuration_at_rest(model, [np.nan, 0.0])
    with pytest.raises(LoopCannotClose):
        configuration_at_rest(model, [np.pi, 0.0])


def test_motors_must_lead(tmp_path: Path) -> None:
    robot = four_bar(tmp_path)
    everywhere = tuple(replace(joint, actuated=True) for joint in robot.joints)
    with pytest.raises(InvalidValue, match="follows from the others"):
        configuration_at_rest(impact_model(replace(robot, joints=everywhere)), [1.0, -0.4, 1.7])


@pytest.mark.parametrize("linkage", ["six_bar", "rmin"])
def test_far_goals_are_reached_along_the_branch(linkage: str, tmp_path: Path) -> None:
    """Against q̇ = G u̇, integrated from home in small steps that cannot leave the branch."""
    robot = load_robot("rmin") if linkage == "rmin" else four_bar(tmp_path, **SIX_BAR)
    known, random, reached = closed_chain(robot), np.random.default_rng(0), 0
    home = known.home[list(known.independent)]
    for way in random.uniform(-2.5, 2.5, (8, len(home))):
        try:
            found = close_loops(robot, home + way)
        except (SingularLoop, LoopCannotClose):
            continue
        follow = partial(along_tangent, robot, way)
        whole = solve_ivp(follow, (0, 1), known.home, rtol=1e-8, atol=1e-8)
        np.testing.assert_allclose(found, whole.y[:, -1], atol=1e-5)
        reached += 1
    assert reached >= 4


def along_tangent(robot: Robot, way: Array, _: float, q: Array) -> Array:
    return np.array(loop_tangent(robot, q)) @ way


def test_the_other_way_to_assemble_is_no_answer() -> None:
    """On the way there R-Min passes a dead point, beyond which Newton's method finds a closure."""
    beyond = [-0.02872547, -3.22000509, -2.16889207, -2.36148097]
    with pytest.raises(SingularLoop, match="passes a dead point"):
        close_loops(load_robot("rmin"), beyond)
