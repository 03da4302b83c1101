# SPDX-License-Identifier: BSD-3-Clause
"""The speed factor as a constraint: on the safe side of ``program``, near it, and smooth."""

from __future__ import annotations

import importlib.util
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import casadi as ca
import numpy as np
import pytest

from softimpact.optimize.impact.speed_factor import Watch, speed_factor
from softimpact.simulate.program import program_dangers
from softimpact.simulate.trajectory import Passes
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    InvalidValue,
    Motors,
    body_region,
    drives,
    impact_model,
    load_robot,
)
from softimpact.symbolic.body.laws import PowerLaw

ENDS = {"free": Motors("free"), "driven": Motors("driven")}
CHEST = Contact(body_region("chest"), clamped=False)
HORIZON = 0.04


@pytest.fixture(scope="module")
def model() -> ImpactModel:
    robot = load_robot("panda")
    return impact_model(robot, drives=drives(robot, joint_stiffness=1e4))


@pytest.fixture(scope="module")
def factor(model: ImpactModel) -> ca.Function:
    watched = [Watch(["hand_tcp", "link5"], CHEST)]
    return speed_factor(model, watched, list(ENDS.values()), horizon=HORIZON, compiled=False)


@pytest.fixture(scope="module")
def moments() -> Passes:
    random = np.random.default_rng(5)
    count = 24
    q = np.array([0, 0.3, 0, -2, 0, 2, 0.8]) + random.uniform(-0.5, 0.5, (count, 7))
    rate = random.normal(size=(count, 7)) * random.uniform(0.1, 4.0, (count, 1))
    return Passes(np.arange(count), np.arange(count, dtype=float), q, rate, np.ones(count))


def test_it_is_on_the_safe_side_of_program_and_near_it(
    model: ImpactModel, factor: ca.Function, moments: Passes
) -> None:
    dangers = program_dangers(model, moments, ["hand_tcp", "link5"], [CHEST], ENDS, horizon=HORIZON)
    right = np.ones(len(moments.q))
    for danger in dangers:
        np.minimum.at(right, danger.sample, danger.factor)
    found = np.array(factor(moments.q.T, moments.velocity.T)).ravel()
    slowed = right < 1
    assert 8 < slowed.sum() < 22
    assert (found[slowed] <= right[slowed]).all()
    assert (found[slowed] >= 0.94 * right[slowed]).all()
    assert (found[~slowed] > 0.95).all()


def test_its_derivative_is_that_of_differences(factor: ca.Function, moments: Passes) -> None:
    q, rate = ca.MX.sym("q", 7), ca.MX.sym("dq", 7)
    both = ca.vertcat(q, rate)
    value = ca.Function("value", [both], [factor(q, rate)])
    slope = ca.Function("slope", [both], [ca.gradient(value(both), both)])
    x = np.concatenate([moments.q[3], moments.velocity[3]])
    step = 1e-6 * np.eye(14)
    differences = [(float(value(x + h)) - float(value(x - h))) / 2e-6 for h in step]
    found = np.array(slope(x)).ravel()
    np.testing.assert_allclose(found, differences, atol=1e-6 * abs(found).max())


def test_at_rest_everything_is_allowed(factor: ca.Function, moments: Passes) -> None:
    assert float(factor(moments.q[0], np.zeros(7))) > 10


def test_what_it_does_not_know_is_refused(model: ImpactModel) -> None:
    watched = [Watch(["hand_tcp"], CHEST)]
    rigid = impact_model(model.robot)
    with pytest.raises(InvalidValue, match="joint_stiffness"):
        speed_factor(rigid, watched, [Motors("free")])
    with pytest.raises(InvalidValue, match="cannot give a speed factor"):
        speed_factor(model, watched, [Motors("held")])
    with pytest.raises(InvalidValue, match="motors"):
        speed_factor(model, watched, [])
    covered = [Watch(["hand_tcp"], replace(CHEST, cover=PowerLaw(1e6, 1.2)))]
    with pytest.raises(InvalidValue, match="Hertz"):
        speed_factor(model, covered, [Motors("free")])


def example() -> ModuleType:
    path = Path(__file__).resolve().parents[2] / "examples" / "03_time_optimal.py"
    spec = importlib.util.spec_from_file_location("time_optimal", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["time_optimal"] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_a_time_optimal_motion_keeps_the_limits() -> None:
    module = example()
    free, kept = module.fastest(limited=False), module.fastest()
    assert free.factor.min() < 0.7
    assert kept.factor.min() > 0.99
    assert free.motion.time[-1] < kept.motion.time[-1] < 2 * free.motion.time[-1]
