# SPDX-License-Identifier: BSD-3-Clause
"""Variables of the hardware act as on a robot that is built with their values."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from small_arm import small_study
from studies import InProcess

from softimpact.optimize import Study, load_study
from softimpact.optimize import variables as package
from softimpact.optimize.evaluation import (
    equipped,
    figures,
    largest_deflection,
    largest_share,
)
from softimpact.optimize.impact.impact_program import PARTS, impact_program
from softimpact.optimize.impact.timing import impact_timing, scenario_timing, study_impacts
from softimpact.optimize.machine.hardware import built
from softimpact.optimize.members import kinds_in
from softimpact.optimize.robust.robust import RobustDesign, robust_design
from softimpact.optimize.search.problem import felt_numbers, sought_parts
from softimpact.optimize.study.study_scenarios import scenarios_of
from softimpact.optimize.variables import Variable
from softimpact.simulate import Approach, simulate_impact
from softimpact.studio.design.scenario_checks import checked_worst
from softimpact.symbolic import (
    InvalidValue,
    PowerLaw,
    Robot,
    drives,
    gravity_torques,
    impact_model,
    mass_matrix,
)
from softimpact.symbolic.robot.rigid import Array, Inertia

Q = np.array([0.3, -0.6, 1.1])
SPRINGS = np.array([7000.0, 4000.0, 1500.0])


def peak(study: Study, others: Array) -> float:
    """Peak force by the design's own program."""
    parts = sought_parts(study)
    program = impact_program(study.model, 200, 1, parts=parts, compiled=False)
    x = np.r_[Q, felt_numbers(study, parts, SPRINGS, others)]
    (row,) = study_impacts(study, study.horizon / 200)
    slope = np.array(program["slopes"](x, row, 0)[1])
    at = np.array(program["peaks"](x, row, 0)).ravel()
    for i in range(x.size):  # derivatives by finite differences
        step = 1e-6 * np.eye(x.size)[i]
        ends = [np.array(program["peaks"](x + s, row, 0)).ravel() for s in (step, -step)]
        np.testing.assert_allclose(slope[:, i], (ends[0] - ends[1]) / 2e-6, rtol=2e-4, atol=2e-3)
    return float(at.max())


def simulated(study: Study, **changes: object) -> float:
    """Peak force of a robot that is built so, by SUNDIALS."""
    robot, contact = changes.get("robot", study.robot), changes.get("contact", study.contact)
    rotors = changes.get("rotors", study.robot.armature)
    model = impact_model(robot, "tool", drives=drives(robot, SPRINGS, rotors))  # type: ignore[arg-type]
    return simulate_impact(
        model,
        Approach(Q, study.direction, study.speed),
        contact,  # type: ignore[arg-type]
        motors=study.motors[0],
        horizon=study.horizon,
    ).peak


def test_rotors_and_gears(tmp_path: Path) -> None:
    text = (
        "[hardware.rotor_inertia]\nlower = 0.05\nupper = 1.0\n"
        "[hardware.gear_ratio]\nlower = 0.5\nupper = 2.0"
    )
    study = small_study(tmp_path, text, motors="free")
    rotors, gears = np.array([0.2, 0.5, 0.07]), np.array([1.5, 0.6, 1.1])
    expected = simulated(study, rotors=rotors * gears**2)
    assert peak(study, np.r_[rotors, gears]) == pytest.approx(expected, rel=5e-5)
    assert abs(expected / simulated(study) - 1) > 1e-4


def test_link_masses(tmp_path: Path) -> None:
    study = small_study(tmp_path, "[hardware.link_mass]\nlower = 0.5\nupper = 2.0")
    masses = np.array([0.7, 1.4, 0.6])
    joints = []
    for joint, factor in zip(study.robot.joints, masses, strict=True):
        own = joint.inertia
        scaled = Inertia(factor * own.mass, factor * own.first_moment, factor * own.about_origin)
        joints.append(replace(joint, inertia=scaled))
    robot = replace(study.robot, joints=tuple(joints))
    assert (
        np.abs(np.array(mass_matrix(robot, Q)) - np.array(mass_matrix(study.robot, Q))).max() > 0.1
    )
    assert peak(study, masses) == pytest.approx(simulated(study, robot=robot), rel=1e-3)


@pytest.mark.parametrize(
    ("kind", "lower", "upper", "fastest"),
    [
        ("rotor_inertia", 1e-3, 1.0, 1e-3),
        ("link_mass", 1e-3, 1.0, 1e-3),
        ("parallel_spring", 1.0, 1e5, 1e5),
    ],
)
def test_time_steps_follow_the_fastest_machine(
    tmp_path: Path, kind: str, lower: float, upper: float, fastest: float
) -> None:
    """What is far lighter than the machine as it is moves faster; a leapfrog would blow up."""
    text = f"[hardware.{kind}]\nlower = {lower}\nupper = {upper}"
    study = small_study(tmp_path, text, motors="free")
    others, springs = np.full(3, fastest), study.upper
    for timing in (scenario_timing(study, scenarios_of(study)), impact_timing(study, [Q])):
        parts = sought_parts(study)
        program = impact_program(
            study.model, timing.nodes, timing.substeps, parts=parts, compiled=False
        )
        x = np.r_[Q, felt_numbers(study, parts, springs, others)]
        (row,) = study_impacts(study, timing.step)
        found = float(np.array(program["peaks"](x, row, 0)).max())
        model = built(study.with_springs(springs), equipped(study, ca.DM(springs), others))
        expected = simulate_impact(
            model,
            Approach(Q, study.direction, study.speed),
            study.contact,
            motors=study.motors[0],
            horizon=timing.duration,
        ).peak
        assert found == pytest.approx(expected, rel=1e-2)


BESIDE = np.array([900.0, 400.0, 150.0])


def with_springs_beside_motors(study: Study) -> Robot:
    """Return the arm with springs beside its motors, unbent at 0.4 rad."""
    joints = zip(study.robot.joints, BESIDE, strict=True)
    bent = (replace(j, stiffness=float(k), spring_reference=0.4) for j, k in joints)
    return replace(study.robot, joints=tuple(bent))


def test_springs_beside_motors(tmp_path: Path) -> None:
    """Sought, and as a file has them, they give the force of a robot that is built so."""
    text = "[hardware.parallel_spring]\nlower = 1.0\nupper = 2000.0"
    sought = small_study(tmp_path, text)
    robot = with_springs_beside_motors(sought)
    expected = simulated(sought, robot=robot)
    assert peak(sought, BESIDE) == pytest.approx(expected, rel=1e-3)
    assert abs(expected / simulated(sought) - 1) > 1e-3
    plain = small_study(tmp_path)
    given = replace(plain, model=replace(plain.model, robot=robot))
    assert peak(given, np.empty(0)) == pytest.approx(expected, rel=1e-3)


def test_bounds_count_springs_beside_motors(tmp_path: Path) -> None:
    """A link, its motor held, has both springs; its motor holds what the one beside it pulls."""
    plain = small_study(tmp_path, "[bounds.torque]\nmost = 1.0")
    robot = with_springs_beside_motors(plain)
    study = replace(plain, model=replace(plain.model, robot=robot))
    J = np.array(study.model.jacobian(Q))
    pressed = (J.T @ study.forces.T).T
    held = np.array(gravity_torques(plain.robot, Q)).ravel() + BESIDE * (Q - 0.4)
    for case, torques in ((study, pressed), (replace(study, sag=True), pressed - held)):
        moved = J @ (torques / (SPRINGS + BESIDE)).T
        expected = np.linalg.norm(moved, axis=0).max()
        assert largest_deflection(case, Q, SPRINGS) == pytest.approx(expected)
    torque = next(bound for bound in study.bounds if bound.kind == "torque")
    shares = abs(held) / np.array(plain.robot.torque_limits)
    np.testing.assert_allclose(figures(torque, study, Q, SPRINGS), shares)


def test_cover(tmp_path: Path) -> None:
    study = small_study(tmp_path, "[hardware.cover]\nlower = 1e5\nupper = 1e8")
    contact = replace(study.contact, cover=PowerLaw(3e6))
    assert peak(study, np.array([3e6])) == pytest.approx(
        simulated(study, contact=contact), rel=1e-3
    )


ALL = """
[hardware.rotor_inertia]
lower = 0.05
upper = 1.0
[hardware.link_mass]
lower = 0.8
upper = 1.0
[hardware.cover]
lower = 2e6
upper = 1e8
"""


@pytest.mark.slow
def test_more_variables_never_hurt_and_what_is_found_is_as_simulated(tmp_path: Path) -> None:
    alone, more = (small_study(tmp_path, text, motors="free") for text in ("", ALL))
    springs, all_ = (robust_design(s, scenarios_of(s), InProcess()) for s in (alone, more))
    assert all_.worst.share < 0.97 * springs.worst.share
    assert checked_worst(all_).linearised == pytest.approx(all_.worst.force, rel=1e-3)
    lower, upper = more.range.lower[3:], more.range.upper[3:]
    assert np.all(lower * (1 - 1e-9) <= all_.others)
    assert np.all(all_.others <= upper * (1 + 1e-9))
    assert all_.others[-1] == pytest.approx(2e6)  # the softest cover


def worst_share(found: RobustDesign, springs: Array) -> float:
    """Evaluate all scenarios with other springs, apart from the search."""
    scenarios, timing = found.scenarios, found.timing
    program = impact_program(found.study.model, timing.nodes, timing.substeps, compiled=False)
    shares = []
    for i in range(len(scenarios)):
        x = np.r_[found.postures[scenarios[i].pose], np.log10(springs)]
        row = scenarios.numbers(scenarios[i], timing.step)
        shares.append(np.array(program["forces"](x, row)).max() / scenarios.limit(scenarios[i]))
    return float(max(shares))


@pytest.mark.slow
def test_catalogue_is_the_best_of_all_combinations(tmp_path: Path) -> None:
    entries = [1000.0, 2500.0, 5000.0, 9000.0, 20000.0]
    study = small_study(tmp_path, f"[hardware]\ncatalogue = {entries}")
    found = robust_design(study, scenarios_of(study), InProcess())
    assert found.bought is not None
    assert set(found.springs) <= set(entries)
    assert found.worst.keeps
    ideal = robust_design(replace(study, catalogue=()), scenarios_of(study), InProcess())
    assert found.bought.loss == pytest.approx(found.worst.share / ideal.worst.share - 1)
    assert found.bought.loss >= 0
    best = np.inf
    for springs in np.stack(np.meshgrid(*3 * [entries]), axis=-1).reshape(-1, 3):
        if all(largest_share(study, q, springs) <= 1 for q in found.postures):
            best = min(best, worst_share(found, springs))
    assert found.worst.share <= best * (1 + 1e-3)


def test_every_variable_says_what_it_is() -> None:
    for kind, variable in kinds_in(package, Variable).items():
        assert variable.__doc__, kind
        assert getattr(variable, "unit", ""), kind
        assert set(getattr(variable, "moves", ())) <= {*PARTS}


@pytest.mark.parametrize(
    ("tables", "reason"),
    [
        ("[hardware.colour]\nlower = 1\nupper = 2", "unknown variable 'colour'"),
        (
            "[hardware.link_mass]\nlower = 2\nupper = 1",
            r"upper: must be finite and at least 2",
        ),
        ("[hardware.link_mass]\nlower = 0\nupper = 1", r"link_mass\.lower: must be finite and gr"),
        ("[hardware.link_mass]\nlower = [1, 2]\nupper = 3", "has 2 values, but 3"),
        ("[hardware]\ncatalogue = [1.0, 2.0]", "has no entry from 500 to 30000 N·m/rad"),
        ("[hardware]\ncatalogue = []", "catalogue"),
    ],
)
def test_variables_that_cannot_be(tmp_path: Path, tables: str, reason: str) -> None:
    with pytest.raises(InvalidValue, match=reason):
        small_study(tmp_path, tables)


@pytest.mark.slow
def test_a_cover_that_is_pressed_through_is_refused_with_what_would_do(tmp_path: Path) -> None:
    text = "[hardware.cover]\nlower = 1e5\nupper = 1e8\nthickness = 0.003"
    study = small_study(tmp_path, text)
    with pytest.raises(InvalidValue, match=r"press the cover by .* raise it to .* N/m\^1.5"):
        robust_design(study, scenarios_of(study), InProcess())


def test_joints_that_share_a_spring_need_a_common_stiffness(tmp_path: Path) -> None:
    text = (small_study(tmp_path).source).read_text(encoding="utf-8")
    apart = text.replace("lower = 500.0", "lower = [500.0, 2e4, 500.0]")
    apart = apart.replace("upper = 3e4", "upper = [1e4, 3e4, 3e4]")
    apart = apart.replace("nominal = 8000.0", "nominal = [8000.0, 2e4, 8000.0]")
    for grouping, reason in (
        ('"equal"', "'lift' and 'turn' share a spring, but 'lift' needs 20000 at least"),
        ('[["turn"], ["lift", "bend"], []]', "group 3 names no joint"),
    ):
        path = tmp_path / "apart.toml"
        path.write_text(f"{apart}\n[hardware]\njoint_stiffness = {grouping}\n", encoding="utf-8")
        with pytest.raises(InvalidValue, match=rf"hardware\.joint_stiffness: .*{reason}"):
            load_study(path)
