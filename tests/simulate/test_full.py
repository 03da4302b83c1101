# SPDX-License-Identifier: BSD-3-Clause
"""The nonlinear robot: against MuJoCo, and where it must agree with simpler models."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from impact_cases import ALONG_Y, CHEST, HEAD, POSE
from mujoco_impacts import extrapolated, impact_forces
from oracles import configurations

from softimpact.robots import built_in_robots
from softimpact.simulate import Approach, simulate_impact
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    InvalidValue,
    Motors,
    Robot,
    approach_velocity,
    drives,
    impact_model,
    load_robot,
    unit_direction,
)
from softimpact.symbolic.robot.rigid import Array


def with_elastic_joints(path: Path, stiffness: float) -> mujoco.MjModel:
    """Let a second hinge on the same axis, with a spring, follow every joint of an MJCF."""
    spec = mujoco.MjSpec.from_file(str(path))
    spec.option.gravity = [0, 0, 0]
    for joint in list(spec.joints):
        spring = joint.parent.add_joint(name=f"{joint.name}_spring", axis=joint.axis)
        spring.pos, spring.stiffness = joint.pos, [stiffness, 0, 0]
    model = spec.compile()
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    return model


def peak_by_mujoco(
    model: mujoco.MjModel,
    ours: ImpactModel,
    approach: Approach,
    coordinates: slice,
    contact: Contact,
    duration: float,
) -> float:
    """Return MuJoCo's largest force; the approach's q are some of its coordinates."""
    n = unit_direction(approach.direction)

    def forces(step: float) -> Array:
        data = mujoco.MjData(model)
        data.qpos[coordinates] = approach.q
        data.qvel[coordinates] = approach.speed * approach_velocity(ours, approach.q, n)
        return impact_forces(model, data, ours.tip, n, contact, duration, step)

    return float(extrapolated(forces).max())


def test_panda_agrees_with_mujoco(panda: Robot) -> None:
    model = impact_model(panda, drives=drives(panda, 3e3))
    approach = Approach(POSE, np.array([0.4, 1.0, -0.3]), 1.5)
    ours = simulate_impact(model, approach, HEAD, "full")
    linear = simulate_impact(model, approach, HEAD)
    theirs = peak_by_mujoco(
        with_elastic_joints(built_in_robots()["panda"], 3e3),
        model,
        approach,
        slice(0, None, 2),  # motors; deflections are between them
        HEAD,
        ours.time_of_first_contact_peak + 1e-3,
    )
    assert ours.first_contact == pytest.approx(theirs, rel=2e-5)
    assert abs(ours.first_contact - theirs) < 0.3 * abs(linear.first_contact - theirs)


def test_rr_agrees_with_mujoco() -> None:
    robot = load_robot("rr")
    approach = Approach(np.array([0.2, 0.0, 0.9, 0.0]), np.array([1.0, 0.5, 0.0]), 3.0)
    model = impact_model(robot, "P")
    ours = simulate_impact(model, approach, CHEST, "full")
    linear = simulate_impact(model, approach, CHEST)
    theirs = peak_by_mujoco(
        mujoco.MjModel.from_xml_path(str(built_in_robots()["rr"])),
        model,
        approach,
        slice(None),
        CHEST,
        ours.time_of_first_contact_peak + 1e-3,
    )
    assert ours.first_contact == pytest.approx(theirs, rel=2e-5)
    assert abs(ours.first_contact - theirs) < 0.3 * abs(linear.first_contact - theirs)


def every_kind_of_drive(robot: Robot) -> list[ImpactModel]:
    some = np.array([np.inf, 8e3, 1e3, 9e3, np.inf, 5e3, 1e4])
    gravity = (1.0, -2.0, -9.0)
    return [
        impact_model(robot),
        impact_model(robot, drives=drives(robot, 1e3), gravity=gravity),
        impact_model(robot, drives=drives(robot, some, position_gain=1e4), gravity=gravity),
        impact_model(robot, drives=drives(robot, some, computed_torque_gain=6050.0)),
    ]


@pytest.mark.parametrize("kind", range(4))
def test_slow_impacts_are_linear(panda: Robot, kind: int) -> None:
    model = every_kind_of_drive(panda)[kind]
    errors = []
    for speed in (1e-2, 1e-3):
        approach = Approach(POSE, np.array([0.5, 1.0, 0.3]), speed)
        motors = Motors("held" if model.drives.has_gains else "free")
        full = simulate_impact(model, approach, CHEST, "full", motors=motors)
        linear = simulate_impact(model, approach, CHEST, motors=motors)
        errors.append(abs(full.first_contact / linear.first_contact - 1))
    assert errors[1] < 2e-5
    assert errors[1] < 0.2 * errors[0]  # in proportion to speed


@pytest.mark.slow
def test_linearised_is_near_where_joints_need_not_rush(panda: Robot) -> None:
    errors = []
    for i, q in enumerate(configurations(panda, 20, seed=3)):
        random = np.random.default_rng(i)
        model = impact_model(panda, drives=drives(panda, 10 ** random.uniform(3, 5)))
        n = unit_direction(random.normal(size=3))
        if np.linalg.norm(approach_velocity(model, q, n)) > 4:  # rad/s for 1 m/s
            continue
        contact = (HEAD, CHEST)[i % 2]
        full = simulate_impact(model, Approach(q, n, 1.0), contact, "full")
        linear = simulate_impact(model, Approach(q, n, 1.0), contact)
        errors.append(abs(full.first_contact / linear.first_contact - 1))
    assert len(errors) > 8
    assert np.mean(errors) < 0.006
    assert max(errors) < 0.025
    assert min(errors) > 1e-6  # the two are not the same model


def test_turning_about_the_base_axis_changes_nothing(panda: Robot) -> None:
    model = impact_model(panda, drives=drives(panda, 5e3), gravity=(0.0, 0.0, -9.81))
    angle = 0.8
    c, s = np.cos(angle), np.sin(angle)
    here = simulate_impact(model, Approach(POSE, ALONG_Y, 1.0), HEAD, "full")
    turned = Approach(POSE + angle * np.eye(7)[0], np.array([-s, c, 0.0]), 1.0)
    there = simulate_impact(model, turned, HEAD, "full")
    np.testing.assert_allclose(there.force, here.force, atol=1e-7 * here.first_contact)


def test_passive_joints_must_be_at_rest() -> None:
    model = impact_model(load_robot("rr"), "P")
    approach = Approach(np.array([0.0, 0.0, 1.0, 0.01]), ALONG_Y, 1.0)
    with pytest.raises(InvalidValue, match="joint 'q4' has no motor and is not at rest"):
        simulate_impact(model, approach, HEAD, "full")
