# SPDX-License-Identifier: BSD-3-Clause
"""Programs are slowed down to what one impact's own safe speed allows, and no faster."""

from __future__ import annotations

import numpy as np
import pytest
from oracles import column

from softimpact.simulate import Approach, assess_impact
from softimpact.simulate.program import (
    Danger,
    SafeProgram,
    program_dangers,
    safe_program,
    worst_moments,
)
from softimpact.simulate.trajectory import Trajectory, trajectory
from softimpact.symbolic import (
    Contact,
    FrameNotFound,
    ImpactModel,
    InvalidValue,
    LoopCannotClose,
    Motors,
    body_region,
    close_loops,
    drives,
    frame_pose,
    impact_model,
    load_robot,
)

ENDS = {"free": Motors("free"), "driven": Motors("driven")}
ELBOW = "link5@0,0.05,-0.1"

CHEST, HORIZON = Contact(body_region("chest"), clamped=False), 0.1


@pytest.fixture(scope="module")
def model() -> ImpactModel:
    robot = load_robot("panda")
    return impact_model(robot, drives=drives(robot, joint_stiffness=1e4))


@pytest.fixture(scope="module")
def motion() -> Trajectory:
    t = np.linspace(0, 1, 21)
    sway = np.sin(np.pi * t) ** 2
    q = np.array([0, 0.3, 0, -2, 0, 2, 0.8]) + np.outer(sway, [0.8, 0.3, 0.2, 0.4, 0.1, 0.2, 0])
    return trajectory(t, q)


@pytest.fixture(scope="module")
def dangers(model: ImpactModel, motion: Trajectory) -> list[Danger]:
    return program_dangers(model, motion, ["hand_tcp", ELBOW], [CHEST], ENDS, horizon=HORIZON)


@pytest.fixture(scope="module")
def program(motion: Trajectory, dangers: list[Danger]) -> SafeProgram:
    return safe_program(motion, dangers)


def test_points_move_where_and_as_fast_as_they_do(
    model: ImpactModel, motion: Trajectory, dangers: list[Danger]
) -> None:
    rate = np.gradient(motion.q, motion.time, axis=0)
    for danger in dangers:
        at = ImpactModel(model.robot, danger.point, model.drives)
        rows = [row for row, k in enumerate(danger.sample) if (danger.sample == k).sum() == 1]
        for row in rows[::5]:
            k = danger.sample[row]
            velocity = np.array(at.jacobian(motion.q[k])) @ rate[k]
            np.testing.assert_allclose(danger.speed[row] * danger.direction[row], velocity)


@pytest.mark.slow
def test_worst_moment_has_its_impacts_own_safe_speed(
    model: ImpactModel, motion: Trajectory, program: SafeProgram
) -> None:
    k = worst_moments(motion, program)[0]
    worst = program.worst[k]
    assert worst is not None
    danger, row = worst
    rate = np.gradient(motion.q, motion.time, axis=0)[k] / danger.speed[row]
    approach = Approach(motion.q[k], danger.direction[row], danger.speed[row], rate)
    at = ImpactModel(model.robot, danger.point, model.drives)
    one = assess_impact(at, approach, CHEST, safe_speed=True, horizon=HORIZON)
    assert one.safe_speed is not None
    assert danger.safe_speed[row] <= one.safe_speed
    assert danger.safe_speed[row] == pytest.approx(one.safe_speed, rel=8e-3)
    assert danger.peak[row] == pytest.approx(one.history.peak, rel=2e-3)
    assert program.factor[k] == pytest.approx(danger.safe_speed[row] / danger.speed[row])


def test_factors_keep_the_limits(
    model: ImpactModel, motion: Trajectory, program: SafeProgram
) -> None:
    assert ((program.factor > 0) & (program.factor <= 1)).all()
    slowed = trajectory(motion.time / program.factor.min(), motion.q)
    again = program_dangers(model, slowed, [ELBOW], [CHEST], ENDS, horizon=HORIZON)
    assert (safe_program(slowed, again).factor > 0.995).all()


def test_more_points_and_regions_never_allow_more(
    motion: Trajectory, dangers: list[Danger], program: SafeProgram
) -> None:
    for danger in dangers:
        alone = safe_program(motion, [danger])
        assert (program.factor <= alone.factor).all()
        assert program.time_after >= alone.time_after


def test_times(motion: Trajectory, program: SafeProgram) -> None:
    assert program.time_before == pytest.approx(1)
    assert program.time_before < program.time_after < 1 / program.factor.min()
    assert program.time_by_formula > program.time_before


def test_worst_moments_are_worst_first(motion: Trajectory, program: SafeProgram) -> None:
    moments = worst_moments(motion, program)
    assert len(moments) == 5
    assert len(set(moments)) == 5
    assert program.factor[moments[0]] == program.factor.min()
    assert list(program.factor[moments]) == sorted(program.factor[moments])


def test_a_slow_program_is_left_alone(model: ImpactModel, motion: Trajectory) -> None:
    slow = trajectory(50 * motion.time, motion.q)
    at = program_dangers(model, slow, ["hand_tcp"], [CHEST], ENDS, horizon=HORIZON)
    found = safe_program(slow, at)
    assert (found.factor == 1).all()
    assert found.time_after == pytest.approx(found.time_before)
    assert worst_moments(slow, found)


def test_points_that_do_not_move_or_do_not_exist(model: ImpactModel, motion: Trajectory) -> None:
    only_last = trajectory([0.0, 1.0], motion.q[0] + np.outer([0, 1], np.eye(7)[6]))
    body = [CHEST]
    with pytest.raises(InvalidValue, match="points: 'link5' never moves"):
        program_dangers(model, only_last, ["link5"], body, ENDS)
    with pytest.raises(FrameNotFound):
        program_dangers(model, motion, ["nose"], body, ENDS)


def test_a_closed_chain_must_stay_closed() -> None:
    robot = load_robot("rmin")
    model = impact_model(robot)
    independent = np.array(robot.home)[list(model.independent)]
    first = close_loops(robot, independent)
    second = close_loops(robot, independent + np.array([0.01, 0.005, 0, 0]))
    motion = trajectory([0.0, 0.02], np.stack([first, second]))
    (danger,) = program_dangers(model, motion, ["P"], [CHEST], {"driven": Motors("driven")})
    places = [column(frame_pose(robot, "P", q).position) for q in (first, second)]
    way = float(np.linalg.norm(places[1] - places[0]))
    assert danger.speed[0] == pytest.approx(way / 0.02, rel=0.02)
    open_again = trajectory([0.0, 0.02], np.stack([first, first + 0.01]))
    with pytest.raises(LoopCannotClose):
        program_dangers(model, open_again, ["P"], [CHEST], ENDS)
