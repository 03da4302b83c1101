# SPDX-License-Identifier: BSD-3-Clause
"""GIAF over the 24 redundant poses of the Panda (Relano et al., Table I, §III).

No value of GIAF is printed, and no reflected inertia; the statement that joints 5 and 6 matter most
is checked for the three sets of rotor inertias that are in use, and for flange and hand.
"""

from __future__ import annotations

import tomllib
from dataclasses import replace
from functools import cache

import casadi as ca
import numpy as np
import pytest

from softimpact.robots import FOLDER
from softimpact.symbolic import Robot, frame_pose, giaf, impact_model, load_robot
from softimpact.symbolic.robot.rigid import Array

STUDY = tomllib.loads((FOLDER / "studies" / "panda_24_poses.toml").read_text())
POSES = {pose["name"]: np.array(pose["q"]) for pose in STUDY["poses"]}
TURNED = ("q22", "q23", "q24")
BASE_TURN = 0.31
SETS = ("drake_fr3", "menagerie_fr3", "menagerie_panda")


@pytest.fixture(scope="module")
def robot() -> Robot:
    return load_robot("panda")


@cache
def factor_function(tip: str) -> ca.Function:
    """Return ζ(q, B) with the tip as contact point."""
    q, B = ca.SX.sym("q", 7), ca.SX.sym("B", 7)
    model = impact_model(load_robot("panda"), tip)
    model = replace(model, drives=replace(model.drives, rotors=B))
    return ca.Function("zeta", [q, B], [giaf(model.free_mobility(q), model.mobility(q))])


@cache
def single_joint_factors(tip: str, set_name: str) -> Array:
    """ζ_i of every pose with the rotor of joint i alone, shape (poses, joints)."""
    zeta = factor_function(tip)
    rotors = np.diag(load_robot("panda").rotor_inertia_set(set_name))
    return np.array([[float(zeta(q, rotor)) for rotor in rotors] for q in POSES.values()])


def test_there_are_24_poses_within_the_limits(robot: Robot) -> None:
    assert list(POSES) == [f"q{i}" for i in range(1, 25)]
    lower, upper = robot.limits
    for q in POSES.values():
        assert ((lower < q) & (q < upper)).all()


def test_the_poses_hold_the_flange_at_one_place_but_for_a_turn_of_the_base(robot: Robot) -> None:
    """Two decimals of seven angles leave a centimetre."""
    for name, q in POSES.items():
        seen = q.copy()
        if name in TURNED:
            seen[0] -= BASE_TURN
        flange = np.array(frame_pose(robot, "flange", seen).position).ravel()
        assert flange == pytest.approx([0.37, -0.055, 0.08], abs=0.012)
        if name in TURNED:
            assert float(frame_pose(robot, "flange", q).position[1]) == pytest.approx(
                0.062, abs=0.003
            )


def test_giaf_is_blind_to_a_turn_of_the_base(robot: Robot) -> None:
    zeta = factor_function("hand_tcp")
    for name in TURNED:
        turned = POSES[name] - BASE_TURN * np.eye(7)[0]
        expected = float(zeta(POSES[name], robot.armature))
        assert float(zeta(turned, robot.armature)) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("set_name", SETS)
@pytest.mark.parametrize("tip", ["flange", "hand_tcp"])
def test_joints_5_and_6_matter_most_over_the_poses(tip: str, set_name: str) -> None:
    mean = single_joint_factors(tip, set_name).mean(axis=0)
    assert set(np.argsort(mean)[:2] + 1) == {5, 6}


LOWEST_TWO_ARE_5_AND_6 = {
    ("hand_tcp", "drake_fr3"): 24,
    ("hand_tcp", "menagerie_fr3"): 24,
    ("hand_tcp", "menagerie_panda"): 24,
    ("flange", "drake_fr3"): 18,  # in the others joint 3 comes before joint 5
    ("flange", "menagerie_fr3"): 21,
    ("flange", "menagerie_panda"): 24,
}


@pytest.mark.parametrize(("tip", "set_name"), LOWEST_TWO_ARE_5_AND_6)
def test_in_how_many_poses_joints_5_and_6_matter_most(tip: str, set_name: str) -> None:
    """Joint 6 always comes first; whether joint 5 is second depends on the unpublished rotors."""
    table = single_joint_factors(tip, set_name)
    order = np.argsort(table, axis=1) + 1
    assert (order[:, 0] == 6).all()
    both = sum(set(row[:2]) == {5, 6} for row in order)
    assert both == LOWEST_TWO_ARE_5_AND_6[tip, set_name]


def test_all_rotors_together_absorb_less_than_any_one(robot: Robot) -> None:
    alone = single_joint_factors("hand_tcp", "drake_fr3")
    zeta = factor_function("hand_tcp")
    for q, row in zip(POSES.values(), alone, strict=True):
        assert float(zeta(q, robot.armature)) < row.min()
