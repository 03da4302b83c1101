# SPDX-License-Identifier: BSD-3-Clause
"""The self-motion of the Panda, and the best postures on it by brute force and by Ipopt."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from oracles import example_urdf
from studies import PANDA_24

from softimpact.optimize import Study, candidates, load_study
from softimpact.optimize.posture.self_motion import SelfMotion, self_motion
from softimpact.optimize.posture.tip_pose import tip_pose
from softimpact.optimize.search.best_posture import best_posture, posture_of_least_force
from softimpact.simulate import Approach, simulate_impact
from softimpact.symbolic import InvalidValue, giaf, impact_model, load_robot
from softimpact.symbolic.matrices import Matrix


@pytest.fixture(scope="module")
def study() -> Study:
    return load_study(PANDA_24)


@pytest.fixture(scope="module")
def curve(study: Study) -> SelfMotion:
    task = next(c for c in candidates(study) if c.pose.name == study.task_pose.name)
    return self_motion(study.model, task.q)


def test_every_posture_holds_the_task(study: Study, curve: SelfMotion) -> None:
    position, rotation = tip_pose(study.model, study.task_pose.q)
    for q in curve.q[::10]:
        at = tip_pose(study.model, q)
        np.testing.assert_allclose(at[0], position, atol=1e-8)
        np.testing.assert_allclose(at[1], rotation, atol=1e-8)


def test_it_ends_at_joint_limits(study: Study, curve: SelfMotion) -> None:
    lower, upper = study.robot.limits
    assert not curve.closed
    assert ((lower <= curve.q) & (curve.q <= upper)).all()
    for end in (curve.q[0], curve.q[-1]):
        assert min((end - lower).min(), (upper - end).min()) < 1e-4


def test_its_length_counts_from_the_start(study: Study, curve: SelfMotion) -> None:
    steps = np.diff(curve.arc)
    assert 0 < steps.min() <= steps.max() < 0.021
    at_zero = curve.q[np.argmin(abs(curve.arc))]
    assert abs(at_zero - study.task_pose.q).max() < 0.01


def test_all_poses_of_the_table_lie_on_it(study: Study, curve: SelfMotion) -> None:
    for candidate in candidates(study):
        assert np.linalg.norm(curve.q[curve.nearest(candidate.q)] - candidate.q) < 0.011


def test_a_free_elbow_comes_back_round() -> None:
    """Without limits the self-motion closes, after full turns of some joints."""
    robot = load_robot("panda")
    joints = tuple(replace(joint, lower=-np.inf, upper=np.inf) for joint in robot.joints)
    model = impact_model(replace(robot, joints=joints))
    found = self_motion(model, np.array([0.1, 0.4, 0.2, -2.0, 0.3, 1.8, 0.1]), 0.05)
    assert found.closed
    turns = (found.q[-1] - found.q[0]) / (2 * np.pi)
    np.testing.assert_allclose(turns, turns.round(), atol=0.01)
    assert abs(turns).max() > 0.5


def test_six_joints_have_none() -> None:
    model = impact_model(load_robot(example_urdf("ur5_robot.urdf")), "tool0")
    with pytest.raises(InvalidValue, match="no self-motion"):
        self_motion(model, np.full(6, 0.4))


@pytest.mark.parametrize("tip", ["hand_tcp", "flange"])
def test_ipopt_finds_the_top_of_the_curve(study: Study, curve: SelfMotion, tip: str) -> None:
    model = replace(study.model, tip=tip)
    q = ca.SX.sym("q", 7)
    zeta = ca.Function("zeta", [q], [giaf(model.free_mobility(q), model.mobility(q))])
    along = np.array([float(zeta(x)) for x in curve.q])

    def absorbed(q: Matrix) -> Matrix:
        return -giaf(model.free_mobility(q), model.mobility(q))

    best = best_posture(model, curve.q[along.argmax()], absorbed)
    assert best.solved
    assert -best.value >= along.max() * (1 - 1e-7)
    assert -best.value == pytest.approx(along.max(), rel=1e-3)
    at = tip_pose(study.model, best.q)
    np.testing.assert_allclose(at[0], tip_pose(study.model, curve.q[0])[0], atol=1e-7)


def test_posture_of_least_force(study: Study, curve: SelfMotion) -> None:
    def force(q: np.ndarray) -> float:
        approach = Approach(q, study.direction, study.speed)
        return max(
            simulate_impact(
                study.model, approach, study.contact, motors=motors, horizon=study.horizon
            ).peak
            for motors in study.motors
        )

    samples = curve.q[::25]
    forces = [force(q) for q in samples]
    best = posture_of_least_force(study, samples[int(np.argmin(forces))])
    assert best.solved
    assert best.value <= min(forces)
    assert force(best.q) == pytest.approx(best.value, rel=1e-3)
