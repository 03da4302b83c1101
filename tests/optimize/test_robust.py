# SPDX-License-Identifier: BSD-3-Clause
"""One set of springs for many scenarios: certified, no worse than brute force, and explained."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.text import Text
from studies import InProcess, changed, study_of, written

from softimpact.optimize import Infeasible, Study, design, load_study
from softimpact.optimize.evaluation import largest_deflection
from softimpact.optimize.impact.impact_program import impact_numbers, impact_program
from softimpact.optimize.posture.tip_pose import tip_pose
from softimpact.optimize.robust.robust import RobustDesign, robust_design
from softimpact.optimize.study.study_scenarios import scenarios_of
from softimpact.simulate import Approach, simulate_impact
from softimpact.studio.design.checks import Check
from softimpact.studio.design.scenario_checks import CheckedScenario, doubts_in_words
from softimpact.studio.figures.robust import figure_of_robust_design
from softimpact.symbolic import InvalidValue, impact_model, limits_of, with_load
from softimpact.symbolic.robot.rigid import Array

SIDES = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]

TWO_GROUPS = [["joint1", "joint2", "joint3", "joint4"], ["joint5", "joint6", "joint7"]]

ASKED: dict[str, dict[str, Any]] = {
    "motors": {"kind": "driven", "horizon": 0.1},
    "hardware": {"joint_stiffness": TWO_GROUPS},
    "scenarios": {
        "directions": SIDES,
        "regions": ["chest", "hand"],
        "payloads": [0.0, 2.0],
        "speeds": [0.5],
    },
}


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    return study_of(tmp_path_factory.mktemp("robust"), ASKED, ("q9", "q18"))


@pytest.fixture(scope="module")
def found(study: Study) -> RobustDesign:
    return robust_design(study, scenarios_of(study), InProcess())


def simulated(found: RobustDesign, index: int, springs: Array) -> float:
    """Share of its limit that a scenario's force is, by SUNDIALS."""
    scenarios = found.scenarios
    one = scenarios[index]
    robot, load = found.study.robot, scenarios.payloads[one.payload]
    if load:
        robot = with_load(robot, found.study.model.tip, load)
    drives = found.study.model.with_springs(springs).drives
    model = impact_model(robot, scenarios.points[one.point], drives=drives)
    approach = Approach(
        found.postures[one.pose], scenarios.directions[one.direction], scenarios.speeds[one.speed]
    )
    motors, contact = scenarios.motors[one.motors], scenarios.contacts[one.contact]
    force = simulate_impact(
        model, approach, contact, motors=motors, horizon=found.study.horizon
    ).peak
    return force / limits_of(contact.region, contact.clamped).transient.force


def test_no_scenario_is_worse_than_the_certificate(found: RobustDesign) -> None:
    assert len(found.scenarios) == 2 * 2 * 2 * 2
    shares = [simulated(found, i, found.springs) for i in range(len(found.scenarios))]
    assert max(shares) == pytest.approx(found.worst.share, rel=1e-3)
    assert int(np.argmax(shares)) == found.worst.index
    assert found.worst.share <= found.bound * (1 + 1e-3)
    assert found.worst.deflection <= found.study.max_deflection * (1 + 1e-5)


@pytest.mark.slow
def test_kinds_of_motors_are_an_axis_of_the_product(tmp_path: Path) -> None:
    servo = {"position_gain": 3000.0, "damping_gain": 60.0, "horizon": 0.1}
    kinds = ["free", "servo", "driven"]
    asked = {**ASKED, "motors": servo, "scenarios": {"motors": kinds, "regions": ["chest"]}}
    study = study_of(tmp_path, asked, ("q9",))
    found = robust_design(study, scenarios_of(study), InProcess())
    assert [m.kind for m in found.scenarios.motors] == kinds
    assert len(found.scenarios) == 3
    shares = [simulated(found, i, found.springs) for i in range(3)]
    assert max(shares) == pytest.approx(found.worst.share, rel=1e-3)
    assert len(set(np.round(shares, 3))) == 3


def test_motors_are_told_once_and_do_not_pull_back(tmp_path: Path) -> None:
    for motors, kinds, words in (
        ({"kind": "free"}, ["driven"], r"motors\.kind: and scenarios\.motors say what motors do"),
        ({}, ["held"], "motors"),
        ({}, ["servo"], "position_gain: is needed"),
        ({}, ["driver"], r"scenarios.*motors"),
        ({}, [], r"scenarios.*motors"),
    ):
        asked: dict[str, dict[str, Any]] = {"motors": motors, "scenarios": {"motors": kinds}}
        with pytest.raises(InvalidValue, match=words):
            study_of(tmp_path, asked)


def test_groups_share_their_spring(found: RobustDesign) -> None:
    for joints in (found.springs[:4], found.springs[4:]):
        np.testing.assert_array_equal(joints, joints[0])
    assert found.springs[0] != found.springs[6]


@pytest.mark.slow
def test_two_groups_are_no_worse_than_a_grid(found: RobustDesign) -> None:
    study, best = found.study, np.inf
    J = [np.array(study.model.jacobian(q)) for q in found.postures]
    for large in np.geomspace(300.0, 1e5, 12):
        for small in np.geomspace(300.0, 1e5, 12):
            springs = np.r_[np.full(4, large), np.full(3, small)]
            bends = [np.linalg.norm(j @ ((j.T @ study.forces.T).T / springs).T, axis=0) for j in J]
            if np.max(bends) > study.max_deflection:
                continue
            if all(simulated(found, i, springs) < best for i in found.active):
                best = max(simulated(found, i, springs) for i in range(len(found.scenarios)))
    assert np.isfinite(best)
    assert found.worst.share <= best * (1 + 1e-3)


def test_it_is_compared_with_what_keeps_the_bounds(found: RobustDesign) -> None:
    equal, springs = found.equal
    assert equal.keeps
    assert np.ptp(springs) < 1e-6 * springs[0]
    assert found.worst.share <= equal.share * (1 + 1e-3)


@pytest.mark.slow
def test_ranges_cost_less_than_half_a_percent(found: RobustDesign) -> None:
    least = found.worst.share
    for joints, (low, high) in zip((slice(0, 4), slice(4, 7)), found.indifferent, strict=True):
        assert low <= found.springs[joints][0] * (1 + 1e-9)
        assert high >= found.springs[joints][0] * (1 - 1e-9)
        for end in (low, high):
            springs = found.springs.copy()
            springs[joints] = end
            worst = max(simulated(found, i, springs) for i in found.active)
            assert worst <= least * 1.005 * (1 + 2e-3)


@pytest.mark.slow
def test_the_price_of_accuracy_is_what_it_buys(study: Study, found: RobustDesign) -> None:
    price = next(p for p in found.prices if p.bound == "accuracy.max_deflection")
    assert price.room == "0.1 mm more"
    more = Study(**{**vars(study), "max_deflection": study.max_deflection + 2e-5})
    again = robust_design(more, found.scenarios, InProcess())
    saved = found.worst.force * (1 - again.worst.share / found.worst.share)
    assert price.newtons is not None
    assert saved == pytest.approx(0.2 * price.newtons, rel=0.3)


@pytest.mark.slow
def test_it_finds_what_many_starts_find(tmp_path: Path) -> None:
    """Thirty searches from random springs found these; one that changes little ends 5 % worse."""
    asked: dict[str, dict[str, Any]] = {
        "impact": {"region": "head", "speed": 0.5},
        "motors": {"kind": "driven", "reaction_time": 0.02, "horizon": 0.1},
        "scenarios": {"directions": [[0.224, -0.833, -0.505], [-0.981, -0.179, 0.069]]},
    }
    study = study_of(tmp_path, asked, ("q2", "q8", "q9", "q13"))
    scenarios = scenarios_of(study)
    poses = tuple(pose for pose in scenarios.poses if pose.pose.name != "q9")
    found = robust_design(study, replace(scenarios, poses=poses), InProcess())
    springs = np.array([1e5, 67400.0, 15060.0, 21390.0, 1552.0, 1902.0, 1089.0])
    for q in found.postures:
        assert largest_deflection(study, q, springs) <= study.max_deflection
    known = max(simulated(found, i, springs) for i in range(len(found.scenarios)))
    assert found.worst.share <= known * (1 + 1e-3)


def test_a_list_of_scenarios(tmp_path: Path) -> None:
    content = changed({"motors": {"kind": "driven"}}, ("q9", "q18"))
    path = written(tmp_path, content)
    text = path.read_text(encoding="utf-8")
    more = '[[scenarios]]\npose = "q18"\nregion = "hand"\n[[scenarios]]\npayload = 1.5\n'
    path.write_text(f"{text}\n{more}", encoding="utf-8")
    scenarios = scenarios_of(load_study(path))
    assert len(scenarios) == 2
    first, second = (scenarios.describe(scenarios[i]) for i in range(2))
    assert (first["pose"], first["region"], first["payload"]) == ("q18", "hand", 0.0)
    assert (second["pose"], second["region"], second["payload"]) == ("q9", "chest", 1.5)


def test_scenarios_are_not_held_in_memory(study: Study) -> None:
    scenarios = scenarios_of(study)
    many = type(scenarios)(**{**vars(scenarios), "speeds": tuple(np.linspace(0.1, 1, 10**6))})
    assert len(many) == 16 * 10**6
    assert many.describe(many[len(many) - 1])["speed"] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("scenarios", "reason"),
    [
        ({"points": ["elbow"]}, "elbow"),
        ({"regions": ["toe"]}, "unknown body region 'toe'"),
        ({"poses": ["q99"]}, "q99"),
        ({"directions": []}, "scenarios"),
        ({"points": ["link1"], "directions": [[0.0, 0.0, 1.0]]}, "pose 'q9', point 'link1'"),
    ],
)
def test_scenarios_that_cannot_be(tmp_path: Path, scenarios: dict[str, Any], reason: str) -> None:
    with pytest.raises(InvalidValue, match=reason) as caught:
        scenarios_of(study_of(tmp_path, {"scenarios": scenarios}, ("q9",)))
    assert "scenarios" in str(caught.value)


@pytest.mark.parametrize(
    ("groups", "reason"),
    [
        ([["joint1"], ["joint1", "joint2"]], "joint 'joint1' is in two groups"),
        ([["joint1"]], "joint 'joint2' is in no group"),
        ([["elbow"]], "elbow"),
    ],
)
def test_groups_that_cannot_be(tmp_path: Path, groups: list[list[str]], reason: str) -> None:
    with pytest.raises(InvalidValue, match=reason):
        study_of(tmp_path, {"hardware": {"joint_stiffness": groups}}, ("q9",))


@pytest.mark.parametrize("robust", [True, False])
def test_accuracy_beyond_reach_is_told_at_once(tmp_path: Path, robust: bool) -> None:
    bound = {"accuracy": {"max_deflection": 1e-5}}
    study = study_of(tmp_path, {**ASKED, **bound}, ("q9", "q18"))
    scenarios = scenarios_of(study)

    def searched() -> object:
        if robust:
            return robust_design(study, scenarios, InProcess())
        return design(study, executor=InProcess())

    with pytest.raises(Infeasible, match="the least that can be reached is") as caught:
        searched()
    failure = caught.value
    assert failure.exit_code == 3
    assert failure.least.deflection > 1e-5
    assert "accuracy.max_deflection" in failure.conflicts


def test_motors_that_are_held_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidValue, match="held' cannot give a design"):
        study_of(tmp_path, {"motors": {"kind": "held"}}, ("q9",))
    with pytest.raises(InvalidValue, match="is needed: a servo acts by its gains"):
        study_of(tmp_path, {"motors": {"kind": "servo"}}, ("q9",))


def test_driven_motors_need_no_rotors_and_then_never_react(tmp_path: Path) -> None:
    driven: dict[str, dict[str, Any]] = {
        "robot": {"rotor_inertia": 0.0},
        "motors": {"kind": "driven", "horizon": 0.05},
    }
    study = study_of(tmp_path, driven, ("q9",))
    assert [(m.kind, m.reaction_time) for m in study.motors] == [("driven", np.inf)]
    program = impact_program(study.model, 150, 1, compiled=False)
    q, (motors,) = study.task_pose.q, study.motors
    row = impact_numbers(study.direction, study.speed, study.contact, motors, 0.05 / 150)
    force = np.array(program["forces"](np.r_[q, np.log10(study.nominal)], row)).max()
    approach = Approach(q, study.direction, study.speed)
    peak = simulate_impact(study.model, approach, study.contact, motors=motors, horizon=0.05).peak
    assert force == pytest.approx(peak, rel=1e-3)


def test_without_a_table_the_worse_end_counts(tmp_path: Path) -> None:
    assert [m.kind for m in study_of(tmp_path, None, ("q9",)).motors] == ["free", "driven"]
    gains: dict[str, dict[str, Any]] = {"robot": {"position_gain": 2000.0}}
    assert [m.kind for m in study_of(tmp_path, gains, ("q9",)).motors] == ["servo"]


@pytest.mark.slow
def test_free_postures_hold_their_tasks_and_never_hurt(
    tmp_path: Path, study: Study, found: RobustDesign
) -> None:
    moved = robust_design(study, found.scenarios, InProcess(), free=True)
    assert moved.worst.share <= found.worst.share * (1 + 1e-3)
    assert np.abs(moved.postures - found.postures).max() > 1e-2
    lower, upper = study.robot.limits
    for pose, q in zip(moved.scenarios.poses, moved.postures, strict=True):
        position, rotation = tip_pose(study.model, pose.q)
        at = tip_pose(study.model, q)
        np.testing.assert_allclose(at[0], position, atol=2e-5)
        np.testing.assert_allclose(at[1], rotation, atol=2e-5)
        assert np.all((lower <= q) & (q <= upper))
        assert largest_deflection(study, q, moved.springs) <= study.max_deflection * (1 + 1e-5)
    shares = [simulated(moved, i, moved.springs) for i in range(len(moved.scenarios))]
    assert max(shares) == pytest.approx(moved.worst.share, rel=1e-3)


def test_the_figure_marks_a_machine_that_breaks_bounds(found: RobustDesign) -> None:
    """Text is legible and inside; a machine before that breaks a bound is hollow and says so."""
    broken = replace(found.before, bounds=(replace(found.before.bounds[0], share=2.0),))
    for shown_design, breaks in (
        (replace(found, before=replace(found.before, bounds=())), False),
        (replace(found, before=broken), True),
    ):
        figure = figure_of_robust_design(shown_design)
        figure.draw_without_rendering()
        shown = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip()]
        assert any("breaks" in text.get_text() for text in shown) == breaks
        assert min(float(text.get_fontsize()) for text in shown) >= 9
        box, (width, height) = figure.get_tightbbox(), figure.get_size_inches()
        assert 0 <= box.x0 < box.x1 <= width
        assert 0 <= box.y0 < box.y1 <= height


def test_scenarios_that_simulation_finds_worse_are_told(found: RobustDesign) -> None:
    """The worst may be another scenario of the nonlinear robot, against another limit."""
    at, scenarios = found.worst.index, found.scenarios
    other = next(i for i in found.active if i != at)
    limits = [scenarios.limit(scenarios[i]) for i in (at, other)]
    allowed = [found.worst.share * limit for limit in limits]
    agreed = CheckedScenario(at, limits[0], Check(*(3 * [allowed[0]])))

    def told(full: float) -> list[str]:
        more = CheckedScenario(other, limits[1], Check(allowed[1], allowed[1], full))
        return doubts_in_words(found, [agreed, more])

    assert told(1.005 * allowed[1]) == []
    (line,) = told(1.03 * allowed[1])
    assert f"simulation finds {1.03 * allowed[1]:.1f} N for the winner (pose " in line
    assert str(scenarios.describe(scenarios[other])["pose"]) in line


def test_what_is_indifferent_costs_little_in_every_scenario(found: RobustDesign) -> None:
    """Within a range, the others held, no scenario exceeds the worst by more than 0.5 %."""
    random, scenarios, timing = np.random.default_rng(1), found.scenarios, found.timing
    program = impact_program(found.study.model, timing.nodes, timing.substeps, compiled=True)
    for group, (low, high) in enumerate(found.indifferent):
        assert low <= found.springs[found.study.groups.index(group)] * (1 + 1e-9)
        for value in (low, high, *np.exp(random.uniform(np.log(low), np.log(high), 2))):
            springs = np.where(np.array(found.study.groups) == group, value, found.springs)
            for i in range(len(scenarios)):
                one = scenarios[i]
                x = np.r_[found.postures[one.pose], np.log10(springs)]
                force = np.array(program["forces"](x, scenarios.numbers(one, timing.step))).max()
                assert force / scenarios.limit(one) <= found.worst.share * (1.005 + 1e-3)
            for q in found.postures:
                deflection = largest_deflection(found.study, q, springs)
                assert deflection <= found.study.max_deflection * (1 + 2e-5)
