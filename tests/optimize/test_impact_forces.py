# SPDX-License-Identifier: BSD-3-Clause
"""The impact inside the NLP: SUNDIALS' forces and exact derivatives, whatever the posture."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from studies import study_of

from softimpact.optimize import Study, candidates
from softimpact.optimize.impact_forces import (
    ContactParameters,
    ImpactDynamics,
    contact_forces,
)
from softimpact.optimize.nlp import DesignNlp, build_nlp, parameters
from softimpact.optimize.timing import MOST_STEPS, Timing, impact_timing
from softimpact.simulate import Approach, ImpactHistory, simulate_impact
from softimpact.symbolic import Contact, InvalidValue, body_region
from softimpact.symbolic.robot.rigid import Array

POSES = ("q1", "q9", "q18")

FREE_MOTORS: dict[str, Any] = {}
HELD = {"position_gain": 2000.0}
COMPUTED_TORQUE = {"position_gain": None, "computed_torque_gain": 6050.0}


@dataclass(frozen=True, eq=False)
class Impacts:
    """A study's impacts as its NLP sees them."""

    study: Study
    postures: list[Array]
    timing: Timing
    nlp: DesignNlp

    @staticmethod
    def of(study: Study) -> Impacts:
        postures = [candidate.q for candidate in candidates(study)]
        timing = impact_timing(study, postures)
        return Impacts(
            study, postures, timing, build_nlp(study.model, 3, timing.nodes, timing.substeps)
        )

    @property
    def times(self) -> Array:
        return self.timing.duration * np.arange(1, self.timing.nodes + 1) / self.timing.nodes

    def numbers(self) -> Array:
        return parameters(self.study, np.zeros(3), np.eye(3), self.timing.step, 1.0)

    def forces(self, q: Array, springs: Array) -> Array:
        x = np.concatenate([q, np.log10(springs), [0.0]])
        return np.array(self.nlp.oracle(x, self.numbers())[1])[self.nlp.forces].ravel()

    def simulated(self, q: Array, springs: Array, **options: Any) -> ImpactHistory:
        study = self.study
        approach = Approach(q, study.direction, study.speed)
        return simulate_impact(
            study.model.with_springs(springs), approach, study.contact, "linearised", **options
        )

    def springs(self, random: np.random.Generator) -> Array:
        return 10 ** random.uniform(np.log10(self.study.lower), np.log10(self.study.upper))

    def near(self, random: np.random.Generator) -> Array:
        """A posture in the neighbourhood that a search explores."""
        lower, upper = self.study.robot.limits
        q = self.postures[random.integers(len(self.postures))]
        return np.clip(q + random.uniform(-0.3, 0.3, q.size), lower, upper)


@pytest.fixture(scope="module")
def head(tmp_path_factory: pytest.TempPathFactory) -> Impacts:
    folder = tmp_path_factory.mktemp("head")
    return Impacts.of(study_of(folder, {"impact": {"region": "head"}}, POSES))


@pytest.mark.parametrize("gains", [FREE_MOTORS, HELD, COMPUTED_TORQUE])
@pytest.mark.parametrize("clamped", [True, False])
@pytest.mark.parametrize("region", ["head", "chest"])
def test_peaks_are_those_of_sundials(
    tmp_path: Path, region: str, clamped: bool, gains: dict[str, Any]
) -> None:
    overrides = {"impact": {"region": region, "clamped": clamped}, "robot": gains}
    impacts = Impacts.of(study_of(tmp_path, overrides, POSES))
    random = np.random.default_rng(1)
    for _ in range(4):
        q, springs = impacts.near(random), impacts.springs(random)
        peak = impacts.simulated(q, springs).first_contact
        assert impacts.forces(q, springs).max() == pytest.approx(peak, rel=2e-4)


def test_peaks_in_any_posture(head: Impacts) -> None:
    """Light tips give peaks shorter than the nodes are apart, so a little less is reached."""
    lower, upper = head.study.robot.limits
    random = np.random.default_rng(2)
    for _ in range(8):
        q, springs = random.uniform(lower + 0.2, upper - 0.2), head.springs(random)
        peak = head.simulated(q, springs).first_contact
        assert head.forces(q, springs).max() == pytest.approx(peak, rel=5e-4)


def test_the_whole_history_is_that_of_sundials(head: Impacts) -> None:
    random = np.random.default_rng(3)
    for _ in range(4):
        q, springs = head.near(random), head.springs(random)
        history = head.simulated(q, springs, duration=head.timing.duration)
        expected = np.interp(head.times, history.time, history.force)
        assert history.separation is not None
        expected[head.times > history.separation] = 0.0
        gap = abs(head.forces(q, springs) - expected) / history.first_contact
        assert gap.max() < 5e-3
        assert gap[len(gap) // 10 :].max() < 1e-3  # first touch rings on the body's trapezoid


def test_soft_springs_at_the_stiffest_bounds_of_a_stiff_study(tmp_path: Path) -> None:
    stiff: dict[str, dict[str, Any]] = {"impact": {"region": "head"}, "stiffness": {"upper": 2e6}}
    impacts = Impacts.of(study_of(tmp_path, stiff, POSES))
    random = np.random.default_rng(4)
    for springs in (impacts.study.upper, impacts.study.lower, impacts.springs(random)):
        q = impacts.near(random)
        peak = impacts.simulated(q, springs).first_contact
        assert impacts.forces(q, springs).max() == pytest.approx(peak, rel=3e-4)


def test_joints_too_stiff_to_simulate_are_refused(tmp_path: Path) -> None:
    study = study_of(tmp_path, {"stiffness": {"upper": 1e12}}, POSES)
    with pytest.raises(InvalidValue, match=f"stiffness.upper.*more than {MOST_STEPS}"):
        impact_timing(study, [pose.q for pose in study.poses])


def test_only_the_first_contact_counts(tmp_path: Path) -> None:
    """These springs let the tip bounce: it comes back before the simulation ends."""
    study = study_of(tmp_path, {"impact": {"region": "head"}}, ("q9", "q18", "q20"))
    impacts = Impacts.of(study)
    q = np.array([0.00, 0.63, -0.10, -2.36, 1.19, 1.50, -2.29])
    springs = 10 ** np.array([3.75, 3.68, 2.86, 3.81, 2.59, 3.0, 2.73])
    history = impacts.simulated(q, springs, duration=impacts.timing.duration)
    assert history.separation is not None
    assert history.force[history.time > history.separation + 1e-3].max() > 100.0
    forces = impacts.forces(q, springs)
    assert np.all(forces[impacts.times > history.separation + impacts.timing.step] == 0.0)
    assert np.all(forces[impacts.times < history.separation - impacts.timing.step] > 0.0)


def jacobians(impacts: Impacts, q: Array, springs: Array) -> tuple[Array, Array]:
    """Derivative of g with respect to x: exact, and by central differences."""
    oracle, numbers = impacts.nlp.oracle, impacts.numbers()
    x = ca.MX.sym("x", oracle.numel_in("x"))
    exact = ca.Function("J", [x], [ca.jacobian(oracle(x, numbers)[1], x)])
    at = np.concatenate([q, np.log10(springs), [1.0]])
    columns = []
    for step in 1e-6 * np.eye(at.size):
        ahead, behind = (np.array(oracle(at + s, numbers)[1]).ravel() for s in (step, -step))
        columns.append((ahead - behind) / 2e-6)
    return np.array(exact(at)), np.array(columns).T


@pytest.mark.parametrize("gains", [FREE_MOTORS, COMPUTED_TORQUE])
def test_derivatives_are_exact(tmp_path: Path, gains: dict[str, Any]) -> None:
    impacts = Impacts.of(study_of(tmp_path, {"robot": gains}, POSES))
    random = np.random.default_rng(5)
    for _ in range(2):
        q, springs = impacts.near(random), impacts.springs(random)
        exact, differences = jacobians(impacts, q, springs)
        forces = np.r_[np.full(9, 1.0), impacts.forces(q, springs)]
        smooth = forces > 1.0  # the force law has a kink where the contact ends
        smooth[:9] = True
        assert smooth.sum() > 50
        scale = abs(differences).max(axis=1, keepdims=True)
        np.testing.assert_allclose(
            (exact / scale)[smooth], (differences / scale)[smooth], atol=2e-6, rtol=0
        )


def test_a_single_mass_on_a_damped_body() -> None:
    """One joint of inertia 2 at arm 1: m ẍ = −f_c alone, against a fine Runge-Kutta solution."""
    contact = Contact(body_region("chest"))
    steps, step = 6000, 1e-5
    dynamics = ImpactDynamics(
        mobility=ca.MX(0.5),
        jacobian=ca.MX(1.0),
        springs=ca.MX(1e-9),
        rotors=ca.MX(1.0),
        gains=ca.MX(1, 1),
        velocity=ca.MX(1.0),
    )
    forces = contact_forces(dynamics, ContactParameters.of(contact), step, 150, steps // 150)
    found = np.array(ca.Function("f", [], [forces])()["o0"]).ravel()

    region = contact.region

    def rate(state: Array) -> Array:
        x, velocity, node = state
        force = contact.hertz_stiffness * max(x - node, 0.0) ** 1.5
        return np.array(
            [velocity, -force / 2.0, (force - region.stiffness * node) / region.damping]
        )

    state, expected = np.array([0.0, 1.0, 0.0]), []
    for i in range(steps):
        a = rate(state)
        b = rate(state + step / 2 * a)
        c = rate(state + step / 2 * b)
        d = rate(state + step * c)
        state = state + step / 6 * (a + 2 * b + 2 * c + d)
        if (i + 1) % 40 == 0:
            expected.append(contact.hertz_stiffness * max(state[0] - state[2], 0.0) ** 1.5)
    until = int(np.argmin(expected))
    np.testing.assert_allclose(found[:until], expected[:until], atol=1e-3 * max(expected))
    assert max(found) == pytest.approx(max(expected), rel=1e-4)
    assert not np.any(found[until + 1 :])
