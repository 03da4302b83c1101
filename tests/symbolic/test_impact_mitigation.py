# SPDX-License-Identifier: BSD-3-Clause
"""IMF by its definition, on legged robots and on an arm whose base grows heavy."""

from __future__ import annotations

import tomllib
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from hypothesis import assume, given, settings
from oracles import FreeFlyer, assert_near, example_urdf
from random_robots import arms, inertias, placements, seeds, unit_vector, vectors
from symbol_kinds import KINDS

from softimpact.robots import FOLDER
from softimpact.symbolic import (
    ImpactMitigation,
    Matrix,
    Robot,
    drives,
    floating_model,
    floating_robot,
    giaf,
    impact_mitigation,
    impact_model,
    load_robot,
)
from softimpact.symbolic.robot.rigid import Array, Inertia, Placement

STUDY = tomllib.loads((FOLDER / "studies" / "panda_24_poses.toml").read_text())
POSES = [pose["q"] for pose in STUDY["poses"]]
LAWS = settings(max_examples=15)


def mitigation(
    robot: Robot, base: Inertia | None, q: Array, rotors: Array | float | None = None
) -> tuple[ImpactMitigation, Array, Array]:
    """Return the impact mitigation of a robot on a base, and its H and J."""
    free = floating_robot(robot, base)
    given = None if rotors is None else drives(robot, rotor_inertia=rotors)
    model = floating_model(free, drives=given)
    x = free.coordinates(ca.DM(q))
    H, J = model.rotor_mass_matrix(x), model.jacobian(x)
    return impact_mitigation(H, J), np.array(H), np.array(J)


def ball(mass: float) -> Inertia:
    """A base of a given mass, with the inertia of a solid ball of radius 0.3 m."""
    return Inertia.from_center_of_mass(mass, np.zeros(3), 0.4 * mass * 0.3**2 * np.eye(3))


@LAWS
@given(arms(), inertias(), vectors(5), seeds)
def test_definition(robot: Robot, base: Inertia, q: Array, seed: int) -> None:
    """Λ_L of the base with all joints locked, Ξ = I − Λ Λ_L⁻¹ and ξ = det Ξ (GIAF Eq. 18-21)."""
    found, H, J = mitigation(robot, base, q[: robot.n])
    G = J @ np.linalg.solve(H, J.T)
    locked = J[:, :6] @ np.linalg.solve(H[:6, :6], J[:, :6].T)
    assume(np.linalg.cond(G) < 1e5)
    assert_near(found.locked.matrix, locked, 1e-9)
    assert_near(found.real.matrix, G, 1e-9)
    assert_near(found.locked.inertia, np.linalg.inv(locked), 1e-7)
    Xi = np.eye(3) - np.linalg.solve(G, locked)
    assert_near(found.matrix, Xi, 1e-7)
    assert float(found.factor) == pytest.approx(np.linalg.det(Xi), rel=1e-6, abs=1e-9)
    n = unit_vector(seed)
    expected = 1 - (n @ locked @ n) / (n @ G @ n)
    assert float(found.directional(n)) == pytest.approx(expected, rel=1e-7, abs=1e-9)


@LAWS
@given(arms(), inertias(), vectors(5), seeds)
def test_factors_are_shares(robot: Robot, base: Inertia, q: Array, seed: int) -> None:
    """0 ≤ ξ ≤ 1, along every direction too, and Λ_L ⪰ Λ."""
    found, *_ = mitigation(robot, base, q[: robot.n])
    assert 0 <= float(found.factor) <= 1
    assert 0 <= float(found.directional(unit_vector(seed))) <= 1
    yielding = np.array(found.yielding.matrix)
    assert np.linalg.eigvalsh(yielding).min() > -1e-12 * abs(yielding).max()


@LAWS
@given(arms(), inertias(), vectors(5), seeds)
def test_falls_as_any_rotor_grows(robot: Robot, base: Inertia, q: Array, seed: int) -> None:
    more = robot.armature * (1 + np.eye(robot.n)[seed % robot.n])
    light, *_ = mitigation(robot, base, q[: robot.n])
    heavy, *_ = mitigation(robot, base, q[: robot.n], more)
    assert float(heavy.factor) <= float(light.factor) * (1 + 1e-9) + 1e-12


@LAWS
@given(arms(), inertias(), vectors(5))
def test_huge_rotors_lock_the_joints(robot: Robot, base: Inertia, q: Array) -> None:
    found, *_ = mitigation(robot, base, q[: robot.n], 1e9)
    assert 0 <= float(found.factor) < 1e-9


@LAWS
@given(arms(), inertias(), vectors(5), placements())
def test_the_base_frame_is_a_matter_of_taste(
    robot: Robot, base: Inertia, q: Array, place: Placement
) -> None:
    """ξ and ζ do not change when the base's frame is put elsewhere on the base."""
    q = q[: robot.n]
    joints = [robot.joints[0], *robot.joints[1:]]
    joints[0] = replace(joints[0], placement=place @ joints[0].placement)
    moved = replace(robot, joints=tuple(joints))
    here, H, J = mitigation(robot, base, q)
    assume(np.linalg.cond(J @ np.linalg.solve(H, J.T)) < 1e5)
    there, *_ = mitigation(moved, base.seen_from(place), q)
    assert float(there.factor) == pytest.approx(float(here.factor), rel=1e-6, abs=1e-12)
    R = place.rotation
    assert_near(there.real.matrix, R @ np.array(here.real.matrix) @ R.T, 1e-8)


@pytest.mark.parametrize("q", POSES[::6])
def test_an_arm_on_a_heavy_base_mitigates_everything(q: Array) -> None:
    """GIAF's claim: a fixed base as a very heavy floating one has ξ = 1; ζ stays informative."""
    robot = load_robot("panda")
    left = [1 - float(mitigation(robot, ball(m), q)[0].factor) for m in (1e2, 1e4, 1e6, 1e8)]
    assert 0 < left[3] < 1e-6
    assert left[0] > left[1] > left[2] > left[3]
    assert left[2] / left[3] == pytest.approx(100, rel=1e-3)  # 1 − ξ falls as 1/m


def test_on_a_heavy_base_giaf_is_the_fixed_robots() -> None:
    robot, q = load_robot("panda"), POSES[0]
    fixed = impact_model(robot)
    expected = float(giaf(fixed.free_mobility(q), fixed.mobility(q)))
    free = floating_robot(robot, ball(1e8))
    model = floating_model(free)
    x = free.coordinates(ca.DM(q))
    found = float(giaf(model.free_mobility(x), model.mobility(x)))
    assert found == pytest.approx(expected, rel=1e-5)
    assert expected < 0.1


STANCE = np.tile([0.0, 0.9, -1.8], 4)


@pytest.mark.parametrize("foot", ["FL_foot", "FR_foot", "RL_foot", "RR_foot"])
def test_quadruped(foot: str) -> None:
    """The whole of IMF from Pinocchio's mass matrix and Jacobian; gears take of it."""
    path = example_urdf("go2.urdf")
    robot = replace(load_robot(path), tip=foot)
    oracle = FreeFlyer(path, robot)
    at_rest = np.concatenate([np.zeros(3), [0, 0, 0, 1], STANCE])
    J, M = oracle.jacobian(foot, at_rest)[:3], oracle.mass_matrix(at_rest)
    locked = J[:, :6] @ np.linalg.solve(M[:6, :6], J[:, :6].T)
    found = []
    for rotor in (0.0, 0.01):
        H = M + np.diag([0.0] * 6 + [rotor] * 12)
        expected = np.linalg.det(np.eye(3) - np.linalg.solve(J @ np.linalg.solve(H, J.T), locked))
        found.append(float(mitigation(robot, None, STANCE, rotor)[0].factor))
        assert found[-1] == pytest.approx(expected, rel=1e-9)
    assert found[1] < 0.9 * found[0] < 0.9


def test_left_and_right_feet_agree_in_a_symmetric_stance() -> None:
    found = []
    for foot in ("FL_foot", "FR_foot"):
        robot = replace(load_robot(example_urdf("solo12.urdf")), tip=foot.replace("foot", "FOOT"))
        found.append(float(mitigation(robot, None, np.zeros(12) + STANCE, 0.001)[0].factor))
    assert found[0] == pytest.approx(found[1], rel=1e-4)  # the file is no exact mirror


@pytest.mark.parametrize("kind", KINDS)
def test_symbols_give_the_same_numbers(kind: Matrix) -> None:
    robot = load_robot("panda")
    free = floating_robot(robot, ball(50.0))
    model = floating_model(free)
    q = kind.sym("q", 7)

    def factor(q: Matrix) -> Matrix:
        x = free.coordinates(q)
        return impact_mitigation(model.rotor_mass_matrix(x), model.jacobian(x)).factor

    found = float(ca.Function("xi", [q], [factor(q)])(POSES[3]))
    assert found == pytest.approx(float(factor(ca.DM(POSES[3]))), rel=1e-10)
