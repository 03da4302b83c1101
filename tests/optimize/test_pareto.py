# SPDX-License-Identifier: BSD-3-Clause
"""Pareto fronts: ordered, feasible, as good as a design and as a grid, as simulated."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from studies import PANDA_24, InProcess, study_of, written

from softimpact.optimize import (
    Front,
    Outcome,
    Pareto,
    SolverFailure,
    Study,
    design,
    load_study,
    pareto_fronts,
)
from softimpact.optimize.evaluation import largest_deflection
from softimpact.optimize.front.dominance import WORTH
from softimpact.optimize.front.front import ParetoPoint, knee, undominated
from softimpact.optimize.front.levels import even_bounds
from softimpact.optimize.front.sweep import sweep
from softimpact.optimize.impact.impact_program import impact_program
from softimpact.optimize.posture.self_motion import self_motion
from softimpact.optimize.posture.tip_pose import tip_pose
from softimpact.optimize.search import ipopt as solving
from softimpact.optimize.search.problem import peak_force
from softimpact.optimize.search.stiffest import stiffest
from softimpact.simulate import Approach, simulate_impact
from softimpact.symbolic import InvalidValue
from softimpact.symbolic.robot.rigid import Array

POSES = ("q9", "q18")


@pytest.fixture(scope="module", params=["chest", pytest.param("head", marks=pytest.mark.slow)])
def found(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Pareto:
    folder = tmp_path_factory.mktemp(request.param)
    study = study_of(folder, {"impact": {"region": request.param}, "pareto": {"points": 4}}, POSES)
    return pareto_fronts(study, InProcess())


def fronts(found: Pareto) -> list[Front]:
    return [found.free, found.given, *found.held.values()]


def test_more_accuracy_never_costs_less_force(found: Pareto) -> None:
    for front in fronts(found):
        assert len(front.points) >= 2
        for a, b in pairwise(front.points):
            assert a.deflection < b.deflection
            assert a.force > b.force


def test_every_level_is_solved_or_out_of_reach(found: Pareto) -> None:
    for front in fronts(found):
        assert front.unsolved == ()
        assert len(front.outcomes) == found.levels.size
    assert all(outcome is not None for outcome in found.free.outcomes)
    for pose, front in found.held.items():
        q = next(p.q for p in found.study.poses if p.name == pose)
        least = stiffest(found.study, q, "table").deflection
        for level, outcome in zip(found.levels, front.outcomes, strict=True):
            assert (outcome is None) == (level < least * (1 - 1e-3))


def test_points_are_feasible(found: Pareto) -> None:
    study = found.study
    position, rotation = tip_pose(study.model, study.task_pose.q)
    lower, upper = study.robot.limits
    for front in fronts(found):
        for point in front.points:
            outcome = point.outcome
            J = np.array(study.model.jacobian(outcome.q))
            moved = J @ np.diag(1 / outcome.springs) @ J.T @ study.forces.T
            assert point.deflection == pytest.approx(np.linalg.norm(moved, axis=0).max())
            assert point.deflection <= point.bound * (1 + 1e-5)
            at = tip_pose(study.model, outcome.q)
            np.testing.assert_allclose(at[0], position, atol=2e-5)
            np.testing.assert_allclose(at[1], rotation, atol=2e-5)
            assert np.all((lower <= outcome.q) & (outcome.q <= upper))
            assert np.all(study.lower * (1 - 1e-12) <= outcome.springs)
            assert np.all(outcome.springs <= study.upper * (1 + 1e-12))


def test_forces_are_those_of_sundials(found: Pareto) -> None:
    study = found.study
    for point in (*found.free.points, *found.task.points):
        peak = simulated_peak(study, point.outcome.q, point.outcome.springs)
        assert point.force == pytest.approx(peak, rel=1e-3)


def simulated_peak(study: Study, q: Array, springs: Array) -> float:
    """The worst end of what the motors may do, by SUNDIALS."""
    approach = Approach(q, study.direction, study.speed)
    model, horizon = study.model.with_springs(springs), study.horizon
    return max(
        simulate_impact(model, approach, study.contact, motors=motors, horizon=horizon).peak
        for motors in study.motors
    )


def force_within(front: Front, deflection: float) -> float:
    """Least force of a front's points that give way by no more than that."""
    allowed = [p.force for p in front.points if p.deflection <= deflection * (1 + 1e-5)]
    return min(allowed, default=np.inf)


def test_freedom_does_not_hurt(found: Pareto) -> None:
    for level in found.levels:
        free, given = (force_within(front, level) for front in (found.free, found.given))
        assert free <= given * (1 + WORTH)
        for front in found.held.values():
            assert given <= force_within(front, level) * (1 + WORTH)
    assert found.free.points[0].deflection <= found.given.points[0].deflection


def test_fronts_are_tables_and_figures(found: Pareto) -> None:
    told = found.to_dict()
    assert json.loads(json.dumps(told, allow_nan=False)) == told
    points = [point for front in (found.free, found.given, *found.held.values())
              for point in front.points]  # fmt: skip
    assert [row["force"] for row in found.rows()] == [point.force for point in points]
    assert len(found.plot().lines) == 2


def test_levels_hold_the_ends_and_the_studys_bound(found: Pareto) -> None:
    study = found.study
    assert study.max_deflection in found.levels
    assert len(found.levels) == study.levels.points + 2
    least = min(stiffest(study, pose.q, "free").deflection for pose in study.poses)
    assert found.levels[0] == pytest.approx(1.01 * least)
    assert found.levels[-1] == pytest.approx(found.free.points[-1].deflection, rel=0.05)


@pytest.mark.slow
def test_levels_agree_with_designs(found: Pareto) -> None:
    """At both ends and the study's own bound, by searches that know nothing of the others."""
    for level in (found.levels[0], found.study.max_deflection, found.levels[-1]):
        asked = replace(found.study, max_deflection=float(level))
        best = design(asked, executor=InProcess()).winner.force
        assert force_within(found.free, level) == pytest.approx(best, rel=1e-3)


def test_the_reference_is_the_tasks_pose_with_nominal_springs(found: Pareto) -> None:
    study, reference = found.study, found.reference
    np.testing.assert_allclose(reference.q, study.task_pose.q, atol=1e-9)
    assert reference.deflection == largest_deflection(study, reference.q, study.nominal)
    peak = simulated_peak(study, reference.q, study.nominal)
    assert reference.force == pytest.approx(peak, rel=1e-3)
    if reference.deflection <= study.max_deflection:
        assert force_within(found.task, study.max_deflection) < reference.force


def small(folder: Path, region: str, free: tuple[int, ...], poses: tuple[str, ...]) -> Study:
    """A study in which few springs are free."""
    lower, upper = np.full(7, 15000.0), np.full(7, 15000.0)
    lower[list(free)], upper[list(free)] = 300.0, 1e5
    bounds = {"lower": lower.tolist(), "upper": upper.tolist(), "nominal": 15000.0}
    fields: dict[str, dict[str, Any]] = {
        "impact": {"region": region},
        "stiffness": bounds,
        "pareto": {"points": 5},
    }
    return study_of(folder, fields, poses)


def tried(study: Study, result: Pareto, postures: list[Array], springs: Array) -> Any:
    """Deflection and force of every posture with every stiffness."""
    timing = result.timing
    program = impact_program(study.model, timing.nodes, timing.substeps, compiled=True)
    for q in postures:
        for k in springs:
            yield largest_deflection(study, q, k), peak_force(study, program, timing, q, k)


def assert_no_better(result: Pareto, front: Front, grid: Any) -> None:
    """No point of a grid beats the front: level by level, so that the front need not be fine."""
    known = np.array(list(grid))
    compared = 0
    for level in result.levels:
        within = known[known[:, 0] <= level, 1]
        if within.size:
            compared += 1
            assert force_within(front, level) <= within.min() * (1 + 1e-3)
    assert compared >= 3


@pytest.mark.parametrize("region", ["chest", pytest.param("head", marks=pytest.mark.slow)])
def test_two_springs_are_no_worse_than_a_grid(tmp_path: Path, region: str) -> None:
    study = small(tmp_path, region, (1, 3), ("q9",))
    result = pareto_fronts(study, InProcess())
    axis = np.geomspace(300.0, 1e5, 15)
    springs = np.tile(study.lower, (axis.size**2, 1))
    springs[:, [1, 3]] = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    grid = tried(study, result, [study.task_pose.q], springs)
    assert_no_better(result, result.task, grid)


@pytest.mark.parametrize("region", ["chest", pytest.param("head", marks=pytest.mark.slow)])
def test_posture_and_spring_are_no_worse_than_a_sweep(tmp_path: Path, region: str) -> None:
    study = small(tmp_path, region, (1,), POSES)
    result = pareto_fronts(study, InProcess())
    springs = np.tile(study.lower, (15, 1))
    springs[:, 1] = np.geomspace(300.0, 1e5, 15)
    curve = self_motion(study.model, study.task_pose.q, 0.05)
    assert len(curve.q) > 50
    assert_no_better(result, result.free, tried(study, result, list(curve.q), springs))


def test_stiffest_is_no_worse_than_random_springs(tmp_path: Path) -> None:
    study = study_of(tmp_path, None, POSES)
    random = np.random.default_rng(0)
    for pose in study.poses:
        held, free = (stiffest(study, pose.q, mode) for mode in ("table", "free"))
        np.testing.assert_allclose(held.q, pose.q, atol=1e-12)
        assert free.deflection <= held.deflection * (1 + 1e-3)
        assert held.deflection <= largest_deflection(study, pose.q, study.upper)
        for _ in range(200):
            springs = study.upper * 10 ** (-0.3 * random.random(7))
            assert held.deflection <= largest_deflection(study, pose.q, springs)


def point(deflection: float, force: float) -> ParetoPoint:
    q = np.zeros(1)
    outcome = Outcome("a", "table", "Solve_Succeeded", True, 1, 1, 0.0, q, q, force, 0.0)
    return ParetoPoint(deflection, deflection, outcome)


def test_dominated_points_go() -> None:
    points = [point(*each) for each in ((3, 5), (1, 9), (2, 9.5), (2, 7), (4, 5 * (1 - WORTH / 2)))]
    kept = [(p.deflection, p.force) for p in undominated(points)]
    assert kept == [(1, 9), (2, 7), (3, 5)]


def test_the_knee_is_where_a_front_bends() -> None:
    bent = [point(*each) for each in ((1, 100), (2, 40), (4, 38), (8, 36))]
    assert knee(bent) == 1
    straight = [point(*each) for each in ((1, 4), (2, 3), (4, 2))]
    assert knee(straight) is None
    assert knee(bent[:2]) is None


def test_even_bounds_follow_the_front() -> None:
    bounds = np.geomspace(1.0, 16.0, 5)
    np.testing.assert_allclose(even_bounds(bounds, np.array([5.0, 4, 3, 2, 1])), bounds)
    steep = even_bounds(bounds, np.array([50.0, 4, 3, 2, 1]))
    assert (steep[0], steep[-1]) == (1.0, 16.0)
    gaps = np.diff(np.log(steep))
    assert gaps[0] < 0.6 * np.log(2) < np.log(2) < gaps[-1]
    np.testing.assert_allclose(even_bounds(bounds, np.full(5, np.nan)), bounds)
    np.testing.assert_allclose(even_bounds(bounds, np.array([np.nan, 2, 2, 2, np.nan])), bounds)
    np.testing.assert_allclose(even_bounds(np.array([2.0]), np.array([1.0])), [2.0])


@pytest.mark.parametrize(
    ("field", "value", "reason"),
    [
        ("lower", 1e-6, "give way by"),
        ("upper", 1e-6, "give way by"),
        ("lower", 1.0, "the force is least at"),
        ("ends", {"deflection": [1e-3, 2e-3]}, "is for fronts over objectives"),
    ],
)
def test_levels_where_there_is_nothing(
    tmp_path: Path, field: str, value: object, reason: str
) -> None:
    study = study_of(tmp_path, {"pareto": {field: value}}, ("q9",))
    with pytest.raises(InvalidValue) as caught:
        pareto_fronts(study, InProcess())
    assert f"pareto.{field}" in str(caught.value)
    assert reason in str(caught.value)


def test_forces_that_bend_no_spring(tmp_path: Path) -> None:
    study = replace(study_of(tmp_path, None, ("q9",)), forces=np.zeros((2, 3)))
    with pytest.raises(InvalidValue, match=r"accuracy\.forces: none of them bends"):
        pareto_fronts(study, InProcess())


def test_one_design_is_a_front_of_one_point(tmp_path: Path) -> None:
    rigid = {"lower": 15000.0, "upper": 15000.0, "nominal": 15000.0}
    fields: dict[str, dict[str, Any]] = {"stiffness": rigid, "pareto": {"points": 3}}
    study = study_of(tmp_path, fields, ("q9",))
    result = pareto_fronts(study, InProcess())
    assert len(result.task.points) == 1
    assert result.task.points[0].force == pytest.approx(result.reference.force, rel=1e-6)


TWO_JOINTS = """
<mujoco><compiler angle="radian"/><worldbody><body name="upper">
<joint name="shoulder" axis="0 0 1" armature="0.3"/>
<inertial pos="0.2 0 0" mass="3" diaginertia="0.05 0.05 0.05"/>
<body name="lower" pos="0.4 0 0"><joint name="elbow" axis="0 0 1" armature="0.2"/>
<inertial pos="0.15 0 0" mass="2" diaginertia="0.03 0.03 0.03"/>
<site name="tip" pos="0.3 0 0"/></body></body></worldbody>
<actuator><motor joint="shoulder"/><motor joint="elbow"/></actuator></mujoco>
"""


def test_an_arm_without_a_choice_of_posture(tmp_path: Path) -> None:
    """Two joints cannot hold a pose in two ways: the free front is that of the posture held."""
    (tmp_path / "two.xml").write_text(TWO_JOINTS)
    content: dict[str, Any] = {
        "robot": {"model": "two.xml", "tip": "tip"},
        "impact": {"region": "chest", "direction": [1.0, 0.0, 0.0], "speed": 0.5},
        "stiffness": {"lower": 500.0, "upper": 5e4, "nominal": 1e4},
        "accuracy": {"forces": [[30.0, 0.0, 0.0], [0.0, 30.0, 0.0]], "max_deflection": 5e-3},
        "pareto": {"points": 4},
        "task": {"pose_of": "bent"},
        "poses": [{"name": "bent", "q": [0.5, 1.2]}],
    }
    study = load_study(written(tmp_path, content))
    result = pareto_fronts(study, InProcess())
    assert len(result.free.points) >= 4
    for a, b in zip(result.free.points, result.task.points, strict=True):
        assert a.force == pytest.approx(b.force, rel=WORTH)
    axis = np.geomspace(500.0, 5e4, 25)
    springs = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    grid = tried(study, result, [study.task_pose.q], springs)
    assert_no_better(result, result.free, grid)


@pytest.mark.slow
def test_a_missed_optimum_of_springs_is_no_gain_of_posture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What held searches miss is found from the springs of free ones."""
    study = study_of(tmp_path, {"pareto": {"points": 2}}, ("q9",))
    right = pareto_fronts(study, InProcess()).task

    def missing(*arguments: Any) -> list[Outcome]:
        return [replace(found, force=1.2 * found.force) for found in sweep(*arguments)]

    monkeypatch.setattr("softimpact.optimize.front.pareto.sweep", missing)
    found = pareto_fronts(study, InProcess())
    for a, b in zip(found.free.outcomes, found.task.outcomes, strict=True):
        if a is not None and b is not None and abs(a.q - b.q).max() < 1e-3:
            assert a.force == pytest.approx(b.force, rel=1e-3)
    for level in found.levels:
        assert force_within(found.task, level) <= 1.01 * force_within(right, level)


def test_nothing_solved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solving, "IPOPT", {**solving.IPOPT, "max_iter": 0})
    solving._solver.cache_clear()
    study = study_of(tmp_path, {"pareto": {"points": 2}}, ("q9",))
    try:
        with pytest.raises(SolverFailure) as caught:
            pareto_fronts(study, InProcess())
    finally:
        solving._solver.cache_clear()
    assert caught.value.exit_code == 3
    assert "Maximum_Iterations_Exceeded" in str(caught.value)
    assert np.isfinite(caught.value.best.force)


@pytest.mark.long
@pytest.mark.slow
def test_the_whole_study() -> None:
    study = load_study(PANDA_24)
    result = pareto_fronts(study)
    for front in fronts(result):
        assert front.unsolved == ()
    assert len(result.free.points) >= study.levels.points
    for level in (result.levels[0], study.max_deflection, result.levels[-1]):
        best = design(replace(study, max_deflection=float(level))).winner.force
        assert force_within(result.free, level) == pytest.approx(best, rel=1e-3)
