# SPDX-License-Identifier: BSD-3-Clause
"""Co-design: solved, feasible, as simulated, and no worse than brute force."""

from __future__ import annotations

import multiprocessing
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from studies import PANDA_24, InProcess, study_of

from softimpact.optimize import Design, Outcome, SolverFailure, Study, design, load_study
from softimpact.optimize.co_design import MODES
from softimpact.optimize.evaluation import largest_deflection
from softimpact.optimize.impact.impact_program import impact_program
from softimpact.optimize.posture.tip_pose import tip_pose, tip_pose_error
from softimpact.optimize.search import ipopt as solving
from softimpact.optimize.search import solve
from softimpact.optimize.search.accurate_springs import accurate_springs
from softimpact.optimize.search.ipopt import Begin, Nlp
from softimpact.optimize.search.problem import peak_force
from softimpact.optimize.solver_options import FEASIBLE
from softimpact.simulate import Approach, simulate_impact
from softimpact.symbolic.robot.rigid import Array

POSES = ("q3", "q9", "q18")


def simulated_peak(study: Study, q: Array, springs: Array) -> float:
    approach = Approach(q, study.direction, study.speed)
    model = study.model.with_springs(springs)
    return max(
        simulate_impact(
            model, approach, study.contact, "linearised", motors=motors, horizon=study.horizon
        ).peak
        for motors in study.motors
    )


def assert_feasible(study: Study, outcome: Outcome) -> None:
    """Check pose, joint limits, stiffness bounds and deflection without the NLP."""
    position, rotation = tip_pose(study.model, study.task_pose.q)
    at = tip_pose(study.model, outcome.q)
    np.testing.assert_allclose(at[0], position, atol=2e-5)
    np.testing.assert_allclose(at[1], rotation, atol=2e-5)
    lower, upper = study.robot.limits
    assert np.all((lower <= outcome.q) & (outcome.q <= upper))
    assert np.all(study.lower * (1 - 1e-12) <= outcome.springs)
    assert np.all(outcome.springs <= study.upper * (1 + 1e-12))
    J = np.array(study.model.jacobian(outcome.q))
    moved = J @ np.diag(1 / outcome.springs) @ J.T @ study.forces.T
    assert np.linalg.norm(moved, axis=0).max() <= study.max_deflection * (1 + 1e-5)


@pytest.fixture(scope="module", params=["chest", pytest.param("head", marks=pytest.mark.slow)])
def found(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Design:
    folder = tmp_path_factory.mktemp(request.param)
    study = study_of(folder, {"impact": {"region": request.param}}, POSES)
    heard: list[Outcome] = []
    result = design(study, executor=InProcess(), on_outcome=heard.append)
    assert sorted((o.name, o.mode) for o in heard) == sorted((n, m) for n in POSES for m in MODES)
    return result


def test_every_search_is_solved_and_feasible(found: Design) -> None:
    for mode in MODES:
        outcomes = found.outcomes(mode)
        assert [outcome.name for outcome in outcomes] == list(POSES)
        for outcome in outcomes:
            assert outcome.solved, outcome.status
            assert outcome.attempts >= {"table": 2, "free": 1}[mode]
            assert outcome.iterations > 2
            assert_feasible(found.study, outcome)


def test_forces_are_those_of_sundials(found: Design) -> None:
    for mode in MODES:
        for outcome in found.outcomes(mode):
            peak = simulated_peak(found.study, outcome.q, outcome.springs)
            assert outcome.force == pytest.approx(peak, rel=1e-3)
    for pose in found.poses:
        before = simulated_peak(found.study, pose.candidate.q, found.study.nominal)
        assert pose.force_before == pytest.approx(before, rel=1e-3)


def test_the_table_keeps_its_postures(found: Design) -> None:
    for pose in found.poses:
        assert pose.table is not None
        np.testing.assert_allclose(pose.table.q, pose.candidate.q, atol=1e-12)


def test_freedom_does_not_hurt(found: Design) -> None:
    for pose in found.poses:
        assert pose.table is not None
        assert pose.free is not None
        assert pose.free.force <= pose.table.force * (1 + 1e-3)


def test_winner_and_gains(found: Design) -> None:
    outcomes = found.outcomes("table") + found.outcomes("free")
    assert found.winner.force == min(outcome.force for outcome in outcomes)
    assert found.gains is not None
    task = next(pose for pose in found.poses if pose.candidate.pose.name == "q9")
    assert task.table is not None
    assert found.gains.before == task.force_before
    assert found.gains.springs == task.table.force
    assert found.gains.posture == min(pose.force_before for pose in found.poses)
    assert found.gains.both == found.winner.force
    for pose in found.poses:
        deflection = largest_deflection(found.study, pose.candidate.q, found.study.nominal)
        assert pose.deflection_before == deflection


def one_or_two_free(folder: Path, region: str, joints: tuple[int, ...], poses: Any) -> Study:
    """A study in which only some joints' stiffness is free."""
    lower, upper = np.full(7, 15000.0), np.full(7, 15000.0)
    lower[list(joints)], upper[list(joints)] = 300.0, 1e5
    bounds = {"lower": lower.tolist(), "upper": upper.tolist(), "nominal": 15000.0}
    return study_of(folder, {"impact": {"region": region}, "stiffness": bounds}, poses)


@pytest.mark.parametrize(
    "joints",
    [
        (1, 3),
        pytest.param((0, 5), marks=pytest.mark.slow),
        pytest.param((3, 4), marks=pytest.mark.slow),
    ],
)
@pytest.mark.parametrize("region", ["chest", pytest.param("head", marks=pytest.mark.slow)])
def test_two_springs_are_no_worse_than_a_grid(
    tmp_path: Path, region: str, joints: tuple[int, int]
) -> None:
    study = one_or_two_free(tmp_path, region, joints, ("q9",))
    result = design(study, ["table"], InProcess())
    program = impact_program(
        study.model, result.timing.nodes, result.timing.substeps, compiled=True
    )
    q = result.poses[0].candidate.q
    best = np.inf
    axis = np.geomspace(300.0, 1e5, 15)
    for pair in np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2):
        springs = study.lower.copy()
        springs[list(joints)] = pair
        if largest_deflection(study, q, springs) <= study.max_deflection:
            best = min(best, peak_force(study, program, result.timing, q, springs))
    assert np.isfinite(best)
    assert result.winner.force <= best * (1 + 1e-3)


def self_motion(study: Study, step: float = 0.05) -> Iterator[Array]:
    """Postures along the self-motion at the task's pose, both ways, within the joint limits."""
    start = study.task_pose.q
    q = ca.SX.sym("q", start.size)
    error = tip_pose_error(study.model, q, *tip_pose(study.model, start))
    residual = ca.Function("r", [q], [error, ca.jacobian(error, q)])
    lower, upper = study.robot.limits
    yield start
    for sign in (1.0, -1.0):
        at, ahead = start, sign * np.eye(start.size)[0]
        while True:
            along = np.linalg.svd(np.array(residual(at)[1]))[2][-1]
            ahead = along * np.sign(along @ ahead)
            at = at + step * ahead
            for _ in range(4):
                e, J = (np.array(matrix) for matrix in residual(at))
                at = at - np.linalg.pinv(J) @ e.ravel()
            if np.any(at < lower) or np.any(at > upper):
                break
            yield at


@pytest.mark.parametrize("joint", [1, pytest.param(5, marks=pytest.mark.slow)])
@pytest.mark.parametrize("region", ["chest", pytest.param("head", marks=pytest.mark.slow)])
def test_posture_and_spring_are_no_worse_than_a_sweep(
    tmp_path: Path, region: str, joint: int
) -> None:
    study = one_or_two_free(tmp_path, region, (joint,), POSES)
    result = design(study, ["free"], InProcess())
    program = impact_program(
        study.model, result.timing.nodes, result.timing.substeps, compiled=True
    )
    best, postures = np.inf, 0
    for q in self_motion(study):
        postures += 1
        for stiffness in np.geomspace(300.0, 1e5, 15):
            springs = study.lower.copy()
            springs[joint] = stiffness
            if largest_deflection(study, q, springs) <= study.max_deflection:
                best = min(best, peak_force(study, program, result.timing, q, springs))
    assert postures > 50
    assert np.isfinite(best)
    assert result.winner.force <= best * (1 + 1e-3)
    for outcome in result.outcomes("free"):
        assert outcome.solved
        assert_feasible(study, outcome)
        assert outcome.force <= best * (1 + 5e-3)


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Ipopt that stops where it starts, and nothing that goes on from there."""
    monkeypatch.setattr(solving, "IPOPT", {**solving.IPOPT, "max_iter": 0})

    def least_worst(nlp: Nlp, begin: Begin, *effort: Any) -> solving.Found:
        return solving.minimise(nlp, begin, free=False)  # whatever the effort

    monkeypatch.setattr(solve, "least_worst", least_worst)
    solving._solver.cache_clear()
    yield
    solving._solver.cache_clear()


@pytest.mark.usefixtures("impatient")
def test_nothing_solved(tmp_path: Path) -> None:
    study = study_of(tmp_path, None, ("q3", "q9"))
    with pytest.raises(SolverFailure) as caught:
        design(study, executor=InProcess())
    failure = caught.value
    assert failure.exit_code == 3
    assert len(failure.outcomes) == 4
    for outcome in failure.outcomes:
        assert not outcome.solved
        assert outcome.attempts >= 2
        peak = simulated_peak(study, outcome.q, outcome.springs)
        assert outcome.force == pytest.approx(peak, rel=1e-3)
    feasible = [outcome for outcome in failure.outcomes if outcome.violation <= FEASIBLE]
    assert failure.best in feasible
    assert failure.best.force == min(outcome.force for outcome in feasible)
    assert "Maximum_Iterations_Exceeded" in str(failure)
    assert failure.feasible
    assert f"best feasible point, from {failure.best.name}" in str(failure)
    assert f"{failure.best.force:.1f} N at q = [{failure.best.q[0]:.4f}" in str(failure)


@pytest.mark.parametrize(
    ("failing", "attempts"), [pytest.param(1, 2, marks=pytest.mark.slow), (2, 3)]
)
def test_the_fallback_is_taken_when_all_points_fail(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failing: int, attempts: int
) -> None:
    study = study_of(tmp_path, None, ("q9",))
    patient, calls = solving.IPOPT, []
    real = solving._solver.__wrapped__

    def fails_at_first(*program: Any) -> Any:
        calls.append(program)
        limit = 0 if len(calls) <= failing else patient["max_iter"]
        monkeypatch.setattr(solving, "IPOPT", {**patient, "max_iter": limit})
        return real(*program)

    monkeypatch.setattr(solving, "_solver", fails_at_first)
    result = design(study, ["free"], InProcess())
    assert len(calls) >= attempts  # windows set anew around peaks need further ones
    assert result.winner.attempts >= attempts
    assert result.winner.solved
    assert_feasible(study, result.winner)
    assert result.gains is None


@pytest.mark.slow
def test_processes_given_by_the_caller(tmp_path: Path) -> None:
    study = study_of(tmp_path, {"impact": {"region": "head"}}, ("q3", "q9"))
    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as pool:
        result = design(study, ["table"], pool)
        pool.submit(int).result()  # the pool is the caller's: still open
    alone = design(study, ["table"], InProcess())
    for a, b in zip(result.outcomes("table"), alone.outcomes("table"), strict=True):
        assert a.name == b.name
        assert a.force == b.force
        np.testing.assert_array_equal(a.springs, b.springs)


def test_without_a_compiler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study = study_of(tmp_path, {"impact": {"region": "head"}}, ("q9",))
    fast = design(study, ["table"], InProcess())
    monkeypatch.setenv("CC", str(tmp_path / "none"))
    slow = design(study, ["table"], InProcess())
    assert not slow.compiled
    assert slow.winner.solved
    assert slow.winner.force == pytest.approx(fast.winner.force, rel=1e-9)
    np.testing.assert_allclose(slow.winner.springs, fast.winner.springs, rtol=1e-6)


@pytest.mark.slow
def test_a_pose_turned_by_half_is_led_back_to_the_task(tmp_path: Path) -> None:
    study = study_of(tmp_path, {"task": {"exact": False}}, ("q9",))
    half = study.task_pose.q + np.pi * np.eye(7)[6]
    turned = type(study.task_pose)("turned", half)
    both = type(study)(**{**vars(study), "poses": (study.task_pose, turned)})
    result = design(both, ["free"], InProcess())
    for outcome in result.outcomes("free"):
        assert outcome.solved
        assert_feasible(study, outcome)


def test_starts_are_just_accurate(found: Design) -> None:
    study = found.study
    for pose in found.poses:
        springs = accurate_springs(study, pose.candidate.q, study.nominal)
        start = simulated_peak(study, pose.candidate.q, springs)
        assert pose.table is not None
        assert pose.table.force < start


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("region", ["chest", "head"])
def test_the_whole_study(region: str) -> None:
    study = load_study(PANDA_24, {"impact": {"region": region}})
    result = design(study)
    for mode in MODES:
        assert [outcome.name for outcome in result.outcomes(mode)] == [p.name for p in study.poses]
        for outcome in result.outcomes(mode):
            assert outcome.solved, (outcome.name, mode, outcome.status)
            peak = simulated_peak(study, outcome.q, outcome.springs)
            assert outcome.force == pytest.approx(peak, rel=1e-3)
    free = result.outcomes("free")
    best = min(outcome.force for outcome in free)
    assert sum(outcome.force <= 1.005 * best for outcome in free) >= 20
    for outcome in free:
        assert_feasible(study, outcome)
    for pose in result.poses:
        assert pose.table is not None
        assert pose.free is not None
        assert pose.free.force <= pose.table.force * (1 + 1e-3)
        if pose.deflection_before <= study.max_deflection:
            assert pose.table.force <= pose.force_before * (1 + 1e-5)
    assert result.winner.force == best


def test_threads_take_turns(tmp_path: Path) -> None:
    """The linear solver is not thread-safe: two searches at once used to crash the interpreter."""
    study = study_of(tmp_path, None, ("q9", "q22"))
    with ThreadPoolExecutor(2) as executor:
        result = design(study, ("table",), executor)
    assert all(outcome.solved for outcome in result.outcomes("table"))
