# SPDX-License-Identifier: BSD-3-Clause
"""Candidate postures: what is turned is found and taken back, and all hold the task's pose."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from studies import PANDA_24, changed, study_of, written

from softimpact.optimize import Candidate, Pose, Study, candidates, load_study
from softimpact.optimize.evaluation import figures, kept, largest_deflection
from softimpact.optimize.posture.at_pose import posture_at_pose
from softimpact.optimize.posture.tip_pose import tip_pose, tip_pose_error
from softimpact.optimize.search.accurate_springs import accurate_springs
from softimpact.optimize.solver_options import FEASIBLE
from softimpact.symbolic import InvalidValue
from softimpact.symbolic.robot.rigid import Array


@pytest.fixture(scope="module")
def study() -> Study:
    return load_study(PANDA_24)


@pytest.fixture(scope="module")
def found(study: Study) -> dict[str, Candidate]:
    return {candidate.pose.name: candidate for candidate in candidates(study)}


def assert_at_task(study: Study, q: Array, tolerance: float = 1e-6) -> None:
    position, rotation = tip_pose(study.model, study.task_pose.q)
    at = tip_pose(study.model, q)
    np.testing.assert_allclose(at[0], position, atol=tolerance)
    np.testing.assert_allclose(at[1], rotation, atol=tolerance)
    lower, upper = study.robot.limits
    assert np.all(q >= lower - 1e-7)
    assert np.all(q <= upper + 1e-7)


def test_q22_to_q24_are_turned_about_the_base(found: dict[str, Candidate]) -> None:
    turned = {name: c.turned for name, c in found.items() if c.turned != 0.0}
    assert set(turned) == {"q22", "q23", "q24"}
    np.testing.assert_allclose(list(turned.values()), 0.31, atol=0.01)


def test_all_poses_hold_the_tip_at_the_task(study: Study, found: dict[str, Candidate]) -> None:
    assert len(found) == 24
    for candidate in found.values():
        assert_at_task(study, candidate.q)
        assert candidate.offset < 1e-6
        assert candidate.moved < 0.03
        back = candidate.pose.q - candidate.turned * np.eye(7)[0]
        assert abs(candidate.q - back).max() == pytest.approx(candidate.moved, abs=1e-12)


def test_as_printed(tmp_path: Path) -> None:
    study = study_of(tmp_path, {"task": {"exact": False}})
    for candidate in candidates(study):
        assert candidate.moved == 0.0
        assert candidate.offset < 0.02
        back = candidate.pose.q - candidate.turned * np.eye(7)[0]
        np.testing.assert_allclose(candidate.q, back, atol=1e-15)


@pytest.mark.parametrize("angle", [-1.4, -0.5, -0.15, 0.15, 1.0, 2.5, 3.6, 4.3])
def test_any_turn_about_the_base_is_found_and_taken_back(
    study: Study, found: dict[str, Candidate], angle: float
) -> None:
    """A turn by more than half takes q1 back through its limits: it must come out the other way."""
    turned = study.poses[5].q + angle * np.eye(7)[0]
    (candidate,) = candidates(replace(study, poses=(Pose("turned", turned),)))
    assert np.cos(candidate.turned - angle) == pytest.approx(1.0, abs=1e-3)
    assert_at_task(study, candidate.q)
    np.testing.assert_allclose(candidate.q, found["q6"].q, atol=0.03)


def test_a_sliding_first_joint_is_left_alone(tmp_path: Path) -> None:
    body = "<inertial mass='1' pos='0 0 0.1' diaginertia='1 1 1'/>"
    (tmp_path / "slider.xml").write_text(
        "<mujoco><compiler angle='radian'/><worldbody>"
        f"<body><joint name='rail' type='slide' axis='0 1 0' armature='1'/>{body}"
        f"<body><joint name='turn' axis='0 0 1' armature='0.1'/>{body}"
        f"<body pos='0.4 0 0'><joint name='elbow' axis='0 0 1' armature='0.1'/>{body}"
        "<site name='end' pos='0.4 0 0'/></body></body></body></worldbody></mujoco>"
    )
    robot = {"model": "slider.xml", "tip": "end", "rotor_inertia": None}
    file = changed({"robot": robot, "task": {"pose_of": "a", "exact": False}})
    file["poses"] = [{"name": "a", "q": [0, 0.4, 0.5]}, {"name": "b", "q": [0.4, -0.3, 1.2]}]
    slider = load_study(written(tmp_path, file))
    for candidate, pose in zip(candidates(slider), slider.poses, strict=True):
        assert candidate.turned == 0.0
        np.testing.assert_array_equal(candidate.q, pose.q)


def test_a_pose_that_cannot_serve_the_task_is_refused(tmp_path: Path) -> None:
    file = changed()
    file["poses"].append({"name": "away", "q": [0.0, -1.5, 0.0, -0.3, 0.0, 0.2, 0.0]})
    study = load_study(written(tmp_path, file))
    with pytest.raises(InvalidValue, match=r"poses.away.q.*'q9'.*task.exact"):
        candidates(study)


def test_q19_lies_on_the_self_motion_from_q18_to_q20(study: Study) -> None:
    """The source skips q19: hold the tip where q18 and q20 have it on average, and turn joint 1."""
    named = {pose.name: pose for pose in study.poses}
    before, given, after = (named[f"q{i}"].q for i in (18, 19, 20))
    ends = [tip_pose(study.model, q) for q in (before, after)]
    position = (ends[0][0] + ends[1][0]) / 2
    left, _, right = np.linalg.svd((ends[0][1] + ends[1][1]) / 2)  # the mean rotation

    q = ca.SX.sym("q", 7)
    error = tip_pose_error(study.model, q, position, left @ right)
    residual = ca.Function("r", [q], [error, ca.jacobian(error, q)])
    moved = before.copy()
    for angle in np.linspace(before[0], -0.35, 10):
        moved[0] = angle
        for _ in range(5):  # Newton over the six other joints
            e, J = (np.array(matrix) for matrix in residual(moved))
            moved[1:] -= np.linalg.solve(J[:, 1:], e.ravel())
    np.testing.assert_allclose(np.array(residual(moved)[0]), 0.0, atol=1e-10)
    np.testing.assert_allclose(given, moved, atol=0.01)


def test_posture_at_pose_reaches_it_or_says_so(study: Study) -> None:
    task = tip_pose(study.model, study.task_pose.q)
    random = np.random.default_rng(0)
    lower, upper = study.robot.limits
    reached = 0
    for _ in range(60):
        q = posture_at_pose(study.model, random.uniform(lower, upper), *task)
        if q is not None:
            assert_at_task(study, q)
            reached += 1
    assert reached > 10
    assert (
        posture_at_pose(study.model, study.task_pose.q, task[0] + [2.0, 0.0, 0.0], task[1]) is None
    )


def test_posture_at_pose_stays_near(study: Study) -> None:
    q = study.poses[3].q
    held = posture_at_pose(study.model, q, *tip_pose(study.model, q))
    assert held is not None
    np.testing.assert_allclose(held, q, atol=1e-8)


@pytest.mark.parametrize("off", [0.0, 1e-9, 1e-4, 0.1, -0.3])
def test_a_tip_turned_by_half_is_never_taken_for_the_task(study: Study, off: float) -> None:
    for name in ("q6", "q9", "q18"):
        pose = next(pose for pose in study.poses if pose.name == name)
        task = tip_pose(study.model, pose.q)
        half = pose.q + (np.pi + off) * np.eye(7)[6]
        error = np.array(tip_pose_error(study.model, half, *task)).ravel()
        assert np.linalg.norm(error[3:]) > 1.0
        q = posture_at_pose(study.model, half, *task)
        assert q is None or abs(tip_pose(study.model, q)[1] - task[1]).max() < 1e-6


def test_pose_error_is_the_angle(study: Study) -> None:
    position, rotation = tip_pose(study.model, study.task_pose.q)
    for angle in (0.0, 1e-6, -0.1, 1.0, -2.0):
        q = study.task_pose.q + angle * np.eye(7)[6]
        error = np.array(tip_pose_error(study.model, q, position, rotation)).ravel()
        np.testing.assert_allclose(error[:3], 0.0, atol=1e-12)  # the tip is on the last axis
        np.testing.assert_allclose(
            np.linalg.norm(error[3:]), abs(2 * np.sin(angle / 2)), atol=2e-12
        )


def test_deflections_are_those_of_dense_matrices(study: Study) -> None:
    random = np.random.default_rng(1)
    for pose in study.poses[::6]:
        springs = 10 ** random.uniform(2.5, 5, 7)
        forces = random.uniform(-30, 30, (3, 4))
        J = np.array(study.model.jacobian(pose.q))
        expected = J @ np.linalg.inv(np.diag(springs)) @ J.T @ forces
        loads = tuple(tuple(force) for force in forces.T.tolist())
        found = figures(replace(study.deflection, forces=loads), study, pose.q, springs)
        np.testing.assert_allclose(found, np.linalg.norm(expected, axis=0), rtol=1e-11)
        moved = J @ np.diag(1 / springs) @ J.T @ study.forces.T
        assert largest_deflection(study, pose.q, springs) == pytest.approx(
            np.linalg.norm(moved, axis=0).max(), rel=1e-11
        )


def test_accurate_springs_just_meet_the_bound(study: Study) -> None:
    random = np.random.default_rng(2)
    for pose in study.poses[::4]:
        for proportions in (np.full(7, 1e4), 10 ** random.uniform(3, 5, 7)):
            springs = accurate_springs(study, pose.q, proportions)
            share = largest_deflection(study, pose.q, springs) / study.max_deflection
            assert 1 - 1e-3 < share <= 1 + FEASIBLE
            assert np.all(springs >= study.lower)
            assert np.all(springs <= study.upper)


def test_accurate_springs_keep_other_bounds_too(tmp_path: Path) -> None:
    study = study_of(tmp_path, {"bounds": {"natural_frequency": {"least": 15.0}}})
    q = study.task_pose.q
    asked = kept(study, q, accurate_springs(study, q, np.full(7, 1e4)))
    assert not any(each.broken for each in asked)
    assert max(each.share for each in asked) > 1 - 2e-3
    assert asked[0].share < 0.99  # stiffer than accuracy needs


def test_accurate_springs_keep_to_the_bounds(tmp_path: Path) -> None:
    soft = {"stiffness": {"upper": 2000.0, "nominal": 1000.0}}
    study = study_of(tmp_path, soft)
    springs = accurate_springs(study, study.task_pose.q, np.full(7, 500.0))
    np.testing.assert_allclose(springs, study.upper)
    lax = study_of(tmp_path, {"accuracy": {"max_deflection": 10.0}})
    springs = accurate_springs(lax, lax.task_pose.q, np.full(7, 1e4))
    np.testing.assert_allclose(springs, lax.lower)
