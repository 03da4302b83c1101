# SPDX-License-Identifier: BSD-3-Clause
"""The Mini Cheetah on its floating base, whose rotors are published (GIAF Eq. 18-21)."""

from __future__ import annotations

import re
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from softimpact.robots import built_in_robots
from softimpact.symbolic import (
    floating_model,
    floating_robot,
    impact_mitigation,
    load_robot,
)
from softimpact.symbolic.robot.rigid import Array

STANDING = np.array(4 * [0.0, -0.8, 1.6])
GEARS = {"abad": 6.0, "hip": 6.0, "knee": 9.33}
AXES = {"abad": "1 0 0", "hip": "0 1 0", "knee": "0 1 0"}
ROTOR = r'(<body name="(abad|hip|knee)_rotor_(\w\w)"[^>]*>)'


@pytest.fixture(scope="module")
def spinning(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same robot with rotors that turn, instead of armatures."""
    text = built_in_robots()["mini_cheetah"].read_text()

    def with_joint(found: re.Match[str]) -> str:
        body, kind, leg = found.groups()
        return f'{body}<joint name="spin_{kind}_{leg}" axis="{AXES[kind]}"/>'

    text = re.sub(r' armature="[^"]*"', "", re.sub(ROTOR, with_joint, text))
    path = tmp_path_factory.mktemp("robots") / "mini_cheetah.xml"
    path.write_text(text)
    return path


def mitigation(M: Array, J: Array) -> float:
    """ξ as GIAF Eq. 21 prints it."""
    mobility = J @ np.linalg.solve(M, J.T)
    locked = J[:, :6] @ np.linalg.solve(M[:6, :6], J[:, :6].T)
    return float(np.linalg.det(np.eye(3) - np.linalg.solve(mobility, locked)))


def geared(path: Path, q: Array) -> tuple[Array, Array]:
    """M and J of the robot whose rotors turn with their gears, without any approximation."""
    legs, whole = load_robot("mini_cheetah"), load_robot(path)
    angles, G = np.zeros(whole.n), np.zeros((6 + whole.n, 6 + legs.n))
    G[:6, :6] = np.eye(6)
    for j, name in enumerate(legs.joint_names):
        joint, rotor = whole.joint_names.index(name), whole.joint_names.index(f"spin_{name}")
        angles[joint] = q[j]
        G[6 + joint, 6 + j], G[6 + rotor, 6 + j] = 1.0, GEARS[name.split("_")[0]]
    model = floating_model(floating_robot(whole), "foot_fl")
    x = ca.vertcat(ca.DM.zeros(6), angles)
    return G.T @ np.array(model.mass_matrix(x)) @ G, np.array(model.jacobian(x)) @ G


def ours(q: Array) -> tuple[Array, Array]:
    robot = floating_robot(load_robot("mini_cheetah"))
    model, x = floating_model(robot), robot.coordinates(ca.DM(q))
    return np.array(model.rotor_mass_matrix(x)), np.array(model.jacobian(x))


def test_mass() -> None:
    """Trunk, four legs of three links, twelve rotors."""
    robot = load_robot("mini_cheetah")
    moved = sum(joint.inertia.mass for joint in robot.joints)
    assert robot.base_inertia.mass + moved == pytest.approx(
        3.3 + 4 * (0.54 + 0.634 + 0.064) + 12 * 0.055
    )


def test_standing_mitigates_three_quarters() -> None:
    M, J = ours(STANDING)
    found = float(impact_mitigation(ca.DM(M), ca.DM(J)).factor)
    assert found == pytest.approx(mitigation(M, J), rel=1e-9)
    assert found == pytest.approx(0.758, abs=5e-4)


@pytest.mark.parametrize("seed", [None, 0, 1, 2])
def test_armatures_stand_for_rotors_that_turn(spinning: Path, seed: int | None) -> None:
    """What they leave out, rotors carried around by turning links, is a few hundredths of ξ."""
    random = np.random.default_rng(seed or 0)
    q = STANDING if seed is None else random.uniform(-1, 1, 12)
    exact, approximate = mitigation(*geared(spinning, q)), mitigation(*ours(q))
    assert exact != approximate
    assert approximate == pytest.approx(exact, abs=0.03)
    if seed is None:
        assert approximate == pytest.approx(exact, abs=2e-3)
