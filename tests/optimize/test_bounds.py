# SPDX-License-Identifier: BSD-3-Clause
"""Each bound's figures by dense matrices and Pinocchio's way of counting; kept by what is found."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh
from small_arm import small_study
from studies import InProcess

from softimpact.optimize import Infeasible, Outcome, SolverFailure, Study
from softimpact.optimize import bounds as package
from softimpact.optimize.bounds import Bound, Deflection
from softimpact.optimize.bounds.cartesian_stiffness import CartesianStiffness
from softimpact.optimize.bounds.energy import Energy
from softimpact.optimize.bounds.giaf import Giaf
from softimpact.optimize.bounds.joint_range import JointRange
from softimpact.optimize.bounds.joint_speed import JointSpeed
from softimpact.optimize.bounds.manipulability import Manipulability
from softimpact.optimize.bounds.mass import Mass
from softimpact.optimize.bounds.natural_frequency import NaturalFrequency
from softimpact.optimize.bounds.torque import Torque
from softimpact.optimize.evaluation import figures, kept
from softimpact.optimize.members import kinds_in
from softimpact.optimize.robust import robust_design
from softimpact.optimize.study_scenarios import scenarios_of
from softimpact.symbolic import (
    InvalidValue,
    drives,
    gravity_torques,
    impact_factors,
    impact_model,
    manipulability,
    mass_matrix,
)
from softimpact.symbolic.robot.rigid import Array

Q = np.array([0.3, -0.6, 1.1])
SPRINGS = np.array([7000.0, 4000.0, 1500.0])
WEIGHT = np.array([0.0, 0.0, -9.81])


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    return small_study(tmp_path_factory.mktemp("bounds"))


@pytest.fixture(scope="module")
def J(study: Study) -> Array:  # the field's symbol
    return np.array(study.model.jacobian(Q))


def numbers(matrix: object) -> Array:
    return np.array(matrix, dtype=float)


def test_deflection_under_forces_moments_payload_and_sag(study: Study, J: Array) -> None:
    forces, moments = ((5.0, -3.0, 8.0), (0.0, 0.0, 0.0)), ((0.0, 2.0, 1.0), (0.0, 0.0, 0.0))
    bound = Deflection(1e-3, forces, moments, payload=1.5, sag=True)
    # the tip's turning by finite differences would be another Jacobian: here joints turn about axes
    axes = np.array([[0, 0, 1], *2 * [[-np.sin(Q[0]), np.cos(Q[0]), 0]]]).T
    own = numbers(gravity_torques(study.robot, Q)).ravel()
    for k in range(2):
        torque = J.T @ (np.array(forces[k]) + 1.5 * WEIGHT) + axes.T @ np.array(moments[k]) - own
        expected = np.linalg.norm(J @ (torque / SPRINGS))
        assert figures(bound, study, Q, SPRINGS)[k] == pytest.approx(expected, rel=1e-9)


def test_no_spring_within_its_tolerance_breaks_what_is_kept_with_a_margin(study: Study) -> None:
    wide = replace(study, margin=0.1)
    random = np.random.default_rng(0)
    bounds: tuple[Bound, ...] = (study.deflection, CartesianStiffness(1.0), NaturalFrequency(1.0))
    for bound in bounds:
        stated = figures(bound, wide, Q, SPRINGS)
        pick = np.min if bound.sense == "least" else np.max
        for _ in range(100):
            off = SPRINGS * (1 + 0.1 * random.choice([-1, 1, random.uniform(-1, 1)], 3))
            found = figures(bound, study, Q, off)
            if bound.sense == "most":
                assert np.all(found <= stated * (1 + 1e-9))
            else:
                assert pick(found) >= pick(stated) * (1 - 1e-9)


def test_cartesian_stiffness(study: Study, J: Array) -> None:
    K = np.linalg.inv(J @ np.diag(1 / SPRINGS) @ J.T)
    least = np.linalg.eigvalsh(K)[0]
    found = figures(CartesianStiffness(1.0), study, Q, SPRINGS)[0]
    assert least * 0.995 <= found <= least * (1 + 1e-9)
    along = figures(CartesianStiffness(1.0, (0.0, 0.0, 2.0)), study, Q, SPRINGS)[0]
    assert along == pytest.approx(1 / np.linalg.inv(K)[2, 2])


def test_natural_frequency(study: Study, J: Array) -> None:
    M = numbers(mass_matrix(study.robot, Q)) + 2.0 * J.T @ J
    exact = np.sqrt(eigh(np.diag(SPRINGS), M, eigvals_only=True)[0]) / (2 * np.pi)
    found = figures(NaturalFrequency(1.0, payload=2.0), study, Q, SPRINGS)[0]
    assert exact * 0.996 <= found <= exact * (1 + 1e-9)


def test_torque(study: Study, J: Array) -> None:
    bound = Torque(payload=2.0, forces=((0.0, 0.0, 0.0), (30.0, 0.0, 0.0)))
    own = numbers(gravity_torques(study.robot, Q)).ravel()
    at_tip = [-2.0 * WEIGHT, np.array([30.0, 0, 0]) - 2.0 * WEIGHT]
    expected = [abs(own + J.T @ f) / study.robot.torque_limits for f in at_tip]
    np.testing.assert_allclose(figures(bound, study, Q, SPRINGS), np.concatenate(expected))


def test_joint_speed_energy_and_range(study: Study, J: Array) -> None:
    directions = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]).T
    velocities = np.linalg.pinv(J) @ directions * 0.5
    M = numbers(mass_matrix(study.robot, Q)) + np.diag(study.robot.armature)
    energies = [v @ M @ v / 2 for v in velocities.T]
    np.testing.assert_allclose(figures(Energy(1.0), study, Q, SPRINGS), energies)
    assert not np.isfinite(study.robot.speed_limits).any()  # nothing to bound then
    assert figures(JointSpeed(), study, Q, SPRINGS).size == 0
    expected = np.r_[Q + 2.8, 2.8 - Q]
    np.testing.assert_allclose(figures(JointRange(0.1), study, Q, SPRINGS), expected)


def test_manipulability_and_giaf(study: Study) -> None:
    factors = impact_factors(study.model, Q, [0.0, 1.0, 0.0]).spatial
    assert factors is not None
    assert figures(Giaf(0.1), study, Q, SPRINGS)[0] == pytest.approx(factors.giaf)
    along = figures(Giaf(0.1, (0.0, 3.0, 0.0)), study, Q, SPRINGS)[0]
    assert along == pytest.approx(factors.directional_giaf)
    expected = float(manipulability(study.model.jacobian(Q)))
    assert figures(Manipulability(0.1), study, Q, SPRINGS)[0] == pytest.approx(expected)


def test_speeds_of_joints_count_the_gears(tmp_path: Path) -> None:
    study = small_study(tmp_path, "[hardware.gear_ratio]\nlower = 0.5\nupper = 2.0")
    limited = replace(
        study,
        model=impact_model(
            replace(
                study.robot, joints=tuple(replace(j, speed_limit=2.0) for j in study.robot.joints)
            ),
            "tool",
            drives=study.model.drives,
        ),
    )
    present, higher = (
        figures(JointSpeed(), limited, Q, SPRINGS, np.full(3, ratio)) for ratio in (1.0, 2.0)
    )
    velocities = np.linalg.pinv(numbers(study.model.jacobian(Q))) @ np.array([0, 0.5, 0])
    np.testing.assert_allclose(present[:3], abs(velocities) / 2.0)
    np.testing.assert_allclose(higher, 2 * present)


def test_every_bound_says_what_it_is() -> None:
    for kind, bound in kinds_in(package, Bound).items():
        assert bound.__doc__, kind
        assert getattr(bound, "unit", ""), kind
        assert bound.figures.__doc__, kind  # type: ignore[attr-defined]


BINDING = """
[bounds.natural_frequency]
least = 5.0
[bounds.cartesian_stiffness]
least = 9000.0
"""


@pytest.mark.slow
def test_what_is_found_keeps_all_bounds_and_pays_for_them(tmp_path: Path) -> None:
    loose, tight = (small_study(tmp_path, text, deflection=4e-3) for text in ("", BINDING))
    free, held = (robust_design(s, scenarios_of(s), InProcess()) for s in (loose, tight))
    for q in held.postures:
        for each in kept(tight, q, held.springs):
            assert each.share <= 1 + 1e-5, each
    assert held.worst.keeps
    assert free.worst.share <= held.worst.share
    binding = [each for each in held.worst.bounds if each.share > 1 - 1e-3]
    assert binding
    assert {price.bound for price in held.prices} >= {each.name for each in binding}


def test_bounds_that_conflict_are_named(tmp_path: Path) -> None:
    """More stiffness than the springs have; the other bounds could be kept beside it."""
    text = "[bounds.cartesian_stiffness]\nleast = 1e6\n[bounds.natural_frequency]\nleast = 1.0"
    study = small_study(tmp_path, text)
    with pytest.raises(Infeasible, match=r"cartesian_stiffness.*largest that can be reached") as e:
        robust_design(study, scenarios_of(study), InProcess())
    assert "bounds.cartesian_stiffness.least" in e.value.conflicts
    assert "accuracy.max_deflection" not in e.value.conflicts
    assert "bounds.natural_frequency.least" not in e.value.conflicts


@pytest.mark.slow
def test_two_bounds_that_conflict_only_together(tmp_path: Path) -> None:
    """Light links for energy, heavy ones for a factor of absorption: each alone is possible."""
    text = (
        "[hardware.link_mass]\nlower = 0.2\nupper = 3.0\n"
        "[bounds.energy]\nmost = 0.55\n[bounds.giaf]\nleast = 0.3"
    )
    study = small_study(tmp_path, text)
    with pytest.raises(Infeasible) as caught:
        robust_design(study, scenarios_of(study), InProcess())
    names = [name for name in caught.value.conflicts if name.startswith("bounds.")]
    assert names == ["bounds.energy.most", "bounds.giaf.least"]


@pytest.mark.parametrize(
    ("tables", "reason"),
    [
        ("[bounds.firmness]\nleast = 1", "unknown bound 'firmness'"),
        ("[bounds.energy]\nleast = 1", "bounds.energy.least: unknown; fields are: most, payload"),
        ("[bounds.energy]\npayload = 1", r"bounds\.energy\.most: is missing"),
        ("[bounds.energy]\nmost = 0", r"bounds\.energy\.most: must be greater than 0 J"),
        ("[bounds]\nenergy = 3", r"bounds\.energy: must be a table"),
        (
            "[bounds.energy]\nmost = 3\n[objective]\nkind = 'safe_speed'",
            "'safe_speed' changes the speeds for which bounds.energy holds",
        ),
    ],
)
def test_bounds_that_cannot_be(tmp_path: Path, tables: str, reason: str) -> None:
    with pytest.raises(InvalidValue, match=reason):
        small_study(tmp_path, tables)


def test_rigid_drives_have_no_say(study: Study) -> None:
    """Figures come from the hardware that is asked for, not from the study's nominal springs."""
    other = replace(study, model=study.model.with_drives(drives(study.robot, 1.0, 0.5)))
    bound = CartesianStiffness(1.0)
    np.testing.assert_array_equal(
        figures(bound, other, Q, SPRINGS), figures(bound, study, Q, SPRINGS)
    )


@pytest.mark.parametrize(
    ("tables", "told"),
    [
        (
            "[bounds.natural_frequency]\nleast = 80",
            r"above 80 Hz .*is 33\.\d+ Hz, with k_s = .*stiffness\.upper of turn, lift, bend$",
        ),
        ("[bounds.energy]\nmost = 1e-3", r"0\.3457 J; change bounds\.energy\.most or the pose"),
        (
            "[hardware.link_mass]\nlower = 0.8\nupper = 1.2\n[bounds.mass]\nmost = 5.0",
            r"is 7\.2 kg; change bounds\.mass\.most or hardware\.link_mass\.lower of turn, lift",
        ),
    ],
)
def test_what_holds_a_design_back_is_named(tmp_path: Path, tables: str, told: str) -> None:
    """Springs where springs would help, other hardware where that would, and else neither."""
    study = small_study(tmp_path, tables)
    with pytest.raises(Infeasible, match=told):
        robust_design(study, scenarios_of(study), InProcess())


def test_a_margin_is_told_where_it_is_in_the_way(tmp_path: Path) -> None:
    study = small_study(tmp_path, deflection=5e-4, accuracy="margin = 0.3")
    with pytest.raises(Infeasible, match=r"off by up to 30 %; .* or accuracy\.margin$"):
        robust_design(study, scenarios_of(study), InProcess())


def test_mass(tmp_path: Path) -> None:
    study = small_study(tmp_path, "[hardware.link_mass]\nlower = 0.8\nupper = 1.2")
    factors = np.array([0.9, 1.1, 1.0])
    expected = 4 * 0.9 + 3 * 1.1 + 2 * 1.0
    assert figures(Mass(1.0), study, Q, SPRINGS, factors)[0] == pytest.approx(expected)


def test_a_failure_tells_each_bound_in_its_own_unit(study: Study) -> None:
    """Not one number for metres, radians and shares of bounds."""
    bounded = replace(study, max_deflection=1e-3, other_bounds=(NaturalFrequency(50.0),))
    q = study.task_pose.q
    best = Outcome("bent", "free", "Stopped", False, 1, 1, 0.0, q + 0.01, SPRINGS, 90.0, 0.4)
    said = str(SolverFailure([best], bounded))
    assert "mm of accuracy.max_deflection, at most 1 mm," in said
    assert "Hz of bounds.natural_frequency.least, at least 50 Hz," in said
    assert "mm and 0.0" in said
    assert "rad off the task, and has 90.0 N" in said
    held = replace(best, mode="table", springs=np.full(3, 1e9))
    assert "misses by a share of 0.4" in str(SolverFailure([held], study))
