# SPDX-License-Identifier: BSD-3-Clause
"""A payload against Pinocchio, which gets it as one more inertia of the last link."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import Pinocchio, assert_near
from random_robots import robots, seeds

from softimpact.symbolic import (
    FrameNotFound,
    InvalidValue,
    bias_torques,
    load_robot,
    mass_matrix,
    with_load,
)
from softimpact.symbolic.robot.rigid import Array
from softimpact.symbolic.robot.robot import Robot

GRAVITY = (0.3, -0.2, -9.81)


def with_mass(
    robot: Robot, frame: str, mass: float, com: Array, tensor: Array | None = None
) -> Pinocchio:
    oracle = Pinocchio.of_robot(robot)
    held = oracle.model.frames[oracle.model.getFrameId(frame, pin.FrameType.BODY)]
    load = pin.Inertia(mass, com, np.zeros((3, 3)) if tensor is None else tensor)
    oracle.model.appendBodyToJoint(held.parentJoint, load, held.placement)
    oracle.data = oracle.model.createData()
    return oracle


@settings(max_examples=20)
@given(robots(max_joints=5), seeds, st.floats(0, 20))
def test_any_robot(robot: Robot, seed: int, mass: float) -> None:
    random = np.random.default_rng(seed)
    com, q, v = random.normal(size=3), random.uniform(-2, 2, robot.n), random.normal(size=robot.n)
    loaded, oracle = robot.with_payload("tip", mass, tuple(com)), with_mass(robot, "tip", mass, com)
    assert_near(mass_matrix(loaded, ca.DM(q)), oracle.mass_matrix(q))
    assert_near(
        bias_torques(loaded, ca.DM(q), ca.DM(v), GRAVITY), oracle.bias(q, v, np.array(GRAVITY))
    )


@settings(max_examples=10)
@given(robots(max_joints=5), seeds)
def test_any_tool(robot: Robot, seed: int) -> None:
    """As an inertia that some body has: of three point masses at least."""
    random = np.random.default_rng(seed)
    com, q, points = (
        random.normal(size=3),
        random.uniform(-2, 2, robot.n),
        random.normal(size=(4, 3)),
    )
    tensor = np.trace(points @ points.T) * np.eye(3) - points.T @ points
    xx, yy, zz, xy, xz, yz = tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    loaded = with_load(robot, "tip", 2.0, com, (xx, yy, zz, xy, xz, yz))
    oracle = with_mass(robot, "tip", 2.0, com, tensor)
    assert_near(mass_matrix(loaded, ca.DM(q)), oracle.mass_matrix(q))


@pytest.mark.parametrize(
    "inertia", [(-1e-3, 1, 1, 0, 0, 0), (1, 1, 2.1, 0, 0, 0), (1, 1, 1, 1.1, 0, 0), (np.nan,) * 6]
)
def test_inertias_that_no_body_has_are_refused(panda: Robot, inertia: tuple[float, ...]) -> None:
    with pytest.raises(InvalidValue, match="inertia that no body can have"):
        with_load(panda, "flange", 1.0, inertia=inertia)


def test_symbols_stand_for_any_payload() -> None:
    panda = load_robot("panda")
    mass, com, q = ca.SX.sym("m"), ca.SX.sym("c", 3), ca.SX.sym("q", 7)
    M = ca.Function(
        "M", [q, mass, com], [mass_matrix(panda.with_payload("hand_tcp", mass, com), q)]
    )
    for seed in range(3):
        random = np.random.default_rng(seed)
        m, c, x = random.uniform(0, 8), random.normal(size=3) / 10, random.uniform(-1, 1, 7)
        assert_near(M(x, m, c), with_mass(panda, "hand_tcp", m, c).mass_matrix(x))


def test_unknown_frame() -> None:
    with pytest.raises(FrameNotFound, match=r"'palm'.*hand_tcp"):
        load_robot("panda").with_payload("palm", 1.0)


@pytest.mark.parametrize(
    ("mass", "com", "field"),
    [
        (-1.0, (0.0, 0.0, 0.0), "payload_mass"),
        (np.nan, (0.0, 0.0, 0.0), "payload_mass"),
        (1.0, (0.0, 0.0), "payload_com"),
        (1.0, np.array([0.0, np.inf, 0.0]), "payload_com"),
    ],
)
def test_payloads_that_cannot_be(panda: Robot, mass: float, com: Array, field: str) -> None:
    with pytest.raises(InvalidValue, match=f"{field}: "):
        panda.with_payload("hand_tcp", mass, com)
