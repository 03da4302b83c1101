# SPDX-License-Identifier: BSD-3-Clause
"""Rotors, springs and gains: defaults, units, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles import assert_near

from softimpact.symbolic import (
    InvalidValue,
    Robot,
    WrongLength,
    drives,
    impact_model,
    load_robot,
)
from softimpact.symbolic.impact.motors import MotorLaw


@pytest.fixture(scope="module")
def robot() -> Robot:
    return load_robot("panda")


def test_defaults_are_rigid_joints_with_the_files_rotors(robot: Robot) -> None:
    found = drives(robot)
    assert found.elastic == (False,) * 7
    assert_near(found.rotors, robot.armature)
    assert_near(found.gains, np.zeros(7))
    assert found.computed_torque_gain is None


def test_one_number_serves_all_joints(robot: Robot) -> None:
    found = drives(robot, joint_stiffness=3e3, rotor_inertia=0.2, position_gain=5.0)
    assert found.elastic == (True,) * 7
    assert_near(found.springs, np.full(7, 3e3))
    assert_near(found.rotors, np.full(7, 0.2))
    assert_near(found.gains, np.full(7, 5.0))


def test_infinite_stiffness_is_a_rigid_joint(robot: Robot) -> None:
    k_s = np.array([1e3, np.inf, 1e3, 1e3, np.inf, 1e3, 1e3])
    found = drives(robot, joint_stiffness=k_s)
    assert found.elastic == (True, False, True, True, False, True, True)
    assert np.isfinite(np.array(found.springs)).all()


def test_gear_ratio_counts_squared(robot: Robot) -> None:
    found = drives(robot, rotor_inertia=1e-5, gear_ratio=-100.0)
    assert_near(found.rotors, np.full(7, 0.1))
    ratio = np.arange(1.0, 8.0)
    assert_near(drives(robot, rotor_inertia=1e-4, gear_ratio=ratio).rotors, 1e-4 * ratio**2)


def test_passive_joints_get_no_gain() -> None:
    assert_near(drives(load_robot("rr"), position_gain=5.0).gains, [5, 0, 5, 0])


NAN = float("nan")


@pytest.mark.parametrize(
    ("options", "field", "message"),
    [
        ({"joint_stiffness": 0.0}, "joint_stiffness", "must be greater than 0.*entry 1 is 0"),
        ({"joint_stiffness": -1.0}, "joint_stiffness", "must be greater than 0"),
        ({"joint_stiffness": [1, 1, -5, 1, 1, 1, 1]}, "joint_stiffness", "entry 3 is -5"),
        ({"joint_stiffness": NAN}, "joint_stiffness", "must not be NaN"),
        ({"joint_stiffness": [1, 1, 1, 1, 1, 1, NAN]}, "joint_stiffness", "must not be NaN"),
        ({"rotor_inertia": -0.1}, "rotor_inertia", "must be finite and ≥ 0"),
        ({"rotor_inertia": np.inf}, "rotor_inertia", "must be finite and ≥ 0"),
        ({"rotor_inertia": NAN}, "rotor_inertia", "must not be NaN"),
        ({"position_gain": -1.0}, "position_gain", "must be finite and ≥ 0"),
        ({"position_gain": np.inf}, "position_gain", "must be finite and ≥ 0"),
        ({"damping_gain": -1.0}, "damping_gain", "must be finite and ≥ 0"),
        ({"damping_gain": np.inf}, "damping_gain", "must be finite and ≥ 0"),
        ({"torque_limit": 0.0}, "torque_limit", "must be greater than 0 N·m"),
        ({"torque_limit": [1, 1, 1, -2, 1, 1, 1]}, "torque_limit", "entry 4 is -2"),
        ({"torque_limit": NAN}, "torque_limit", "must not be NaN"),
        ({"computed_torque_gain": -1.0}, "computed_torque_gain", "must be finite and ≥ 0"),
        ({"computed_torque_gain": NAN}, "computed_torque_gain", "must be finite and ≥ 0"),
        (
            {"position_gain": 1.0, "computed_torque_gain": 1.0},
            "computed_torque_gain",
            "excludes position_gain; give one of them",
        ),
        ({"gear_ratio": 100.0}, "gear_ratio", "needs rotor_inertia"),
        ({"rotor_inertia": 1e-4, "gear_ratio": 0.0}, "gear_ratio", "must be finite and not 0"),
        ({"rotor_inertia": 1e-4, "gear_ratio": NAN}, "gear_ratio", "must not be NaN"),
    ],
)
def test_bad_numbers_are_refused(
    robot: Robot, options: dict[str, Any], field: str, message: str
) -> None:
    with pytest.raises(InvalidValue, match=f"^{field}: .*{message}") as caught:
        drives(robot, **options)
    assert caught.value.field == field


@pytest.mark.parametrize(
    "field", ["joint_stiffness", "rotor_inertia", "position_gain", "gear_ratio"]
)
@pytest.mark.parametrize("values", [[1.0, 2.0], []])
def test_vectors_must_fit(robot: Robot, field: str, values: list[float]) -> None:
    options: dict[str, Any] = {"rotor_inertia": 0.1} if field == "gear_ratio" else {}
    with pytest.raises(WrongLength, match=f"{field}: has .* 7 are needed.*joint1") as caught:
        drives(robot, **options | {field: values})
    assert caught.value.expected == 7


def test_vectors_are_flat(robot: Robot) -> None:
    with pytest.raises(InvalidValue, match="joint_stiffness: must be a flat list"):
        drives(robot, np.ones((7, 1)))


@pytest.mark.parametrize("law", ["free", "servo", "held", "driven"])
def test_only_motors_that_are_not_driven_need_rotors(robot: Robot, law: MotorLaw) -> None:
    """The rotor of an elastic joint must not be zero, unless its motion is given."""
    given = drives(robot, joint_stiffness=1e3, rotor_inertia=[1, 1, 0, 1, 1, 1, 1])
    model = impact_model(robot, drives=given)
    q, n = np.full(7, 0.3), np.array([0.0, 1.0, 0.0])
    if law == "driven":
        assert model.linear(q, n, law).jacobian.shape == (1, 7)
        return
    with pytest.raises(InvalidValue, match="joint 'joint3' is elastic") as caught:
        model.linear(q, n, law)
    assert caught.value.field == "rotor_inertia"


def test_a_servo_has_some_gain(robot: Robot) -> None:
    assert not drives(robot).has_gains
    assert not drives(robot, position_gain=0.0, damping_gain=0.0).has_gains
    for given in ({"position_gain": 1.0}, {"damping_gain": 1.0}, {"computed_torque_gain": 1.0}):
        assert drives(robot, **given).has_gains
    assert not drives(robot, position_gain=1.0).without_gains().has_gains
