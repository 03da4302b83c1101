# SPDX-License-Identifier: BSD-3-Clause
"""Many different impacts at once are what SUNDIALS finds one by one."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from softimpact.simulate import Approach, simulate_impact
from softimpact.simulate.sampled import SampledImpacts, Samples
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    Motors,
    approach_velocity,
    body_region,
    drives,
    impact_model,
    load_robot,
)

WITHIN = 2e-3
"""Relative error that forces of many impacts may have."""

SERVO = {"position_gain": 2000.0, "damping_gain": 50.0}
CASES = {
    "free": (Motors("free"), {}),
    "driven": (Motors("driven", 0.02), {}),
    "braking": (Motors("driven", 0.03, "stop"), {}),
    "servo": (Motors("servo", 0.02), SERVO),
    "servo that does not react": (Motors("servo", np.inf), {"position_gain": 2000.0}),
}


def samples(model: ImpactModel, count: int, seed: int) -> tuple[Samples, np.ndarray]:
    """Return random postures and directions, and speeds."""
    random = np.random.default_rng(seed)
    q = random.uniform(*model.robot.limits, (count, model.robot.n))
    n = random.normal(size=(count, 3))
    n /= np.linalg.norm(n, axis=1)[:, None]
    velocity = np.array([approach_velocity(model, *at) for at in zip(q, n, strict=True)])
    return Samples(q, n, velocity), random.uniform(0.1, 1.0, count)


@pytest.mark.parametrize(
    "name", ["servo", *(pytest.param(n, marks=pytest.mark.slow) for n in CASES if n != "servo")]
)
@pytest.mark.parametrize(
    ("stiffness", "body", "clamped"), [(1e4, "chest", True), (None, "device_75_sh70", False)]
)
def test_they_are_those_of_the_simulator(
    name: str, stiffness: float | None, body: str, clamped: bool
) -> None:
    motors, gains = CASES[name]
    robot = load_robot("panda")
    model = impact_model(robot, drives=drives(robot, joint_stiffness=stiffness, **gains))
    at, speeds = samples(model, 12, seed=5)
    contact = Contact(body_region(body), clamped)
    found = SampledImpacts(model, at, contact, motors).peaks(speeds)
    for i in range(2):
        approach = Approach(at.q[i], at.direction[i], speeds[i], at.link_velocity[i])
        one = simulate_impact(model, approach, contact, motors=motors)
        assert found.peak[i] == pytest.approx(one.peak, rel=WITHIN)
        assert found.first_contact[i] == pytest.approx(one.first_contact, rel=WITHIN)
        assert found.pressing[i] == pytest.approx(one.pressing, abs=WITHIN * one.peak)


def test_numbers_of_the_model_may_differ_too() -> None:
    robot = load_robot("panda")
    known = drives(robot, joint_stiffness=1e4)
    symbols = ca.SX.sym("p", 14)
    symbolic = replace(known, rotors=symbols[:7], springs=symbols[7:])
    model = impact_model(robot, drives=symbolic)
    at, speeds = samples(impact_model(robot, drives=known), 6, seed=2)
    values = np.exp(np.random.default_rng(0).uniform(-1, 1, (6, 14))) * np.repeat([0.4, 1e4], 7)
    contact, motors = Contact(body_region("hand")), Motors("driven", 0.02)
    found = SampledImpacts(model, replace(at, values=values, symbols=symbols), contact, motors)
    peaks = found.peaks(speeds).peak
    for i in range(2):
        own = drives(robot, joint_stiffness=values[i, 7:], rotor_inertia=values[i, :7])
        approach = Approach(at.q[i], at.direction[i], speeds[i])
        one = simulate_impact(impact_model(robot, drives=own), approach, contact, motors=motors)
        assert peaks[i] == pytest.approx(one.peak, rel=WITHIN)


def test_speeds_may_be_asked_again() -> None:
    robot = load_robot("ur5e")
    model = impact_model(robot, drives=drives(robot, joint_stiffness=1e4))
    at, speeds = samples(model, 3, seed=1)
    impacts = SampledImpacts(model, at, Contact(body_region("chest")), Motors("driven", 0.02))
    first = impacts.peaks(speeds).peak
    faster = impacts.peaks(2 * speeds).peak
    assert (faster > first).all()
    np.testing.assert_array_equal(impacts.peaks(speeds).peak, first)
