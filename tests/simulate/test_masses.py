# SPDX-License-Identifier: BSD-3-Clause
"""Masses in a row, given as numbers: the robot's own reduced models, and what cannot be."""

from __future__ import annotations

import numpy as np
import pytest
from oracles import assert_near

from softimpact.simulate import Approach, ImpactHistory, simulate_impact, simulate_masses
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
from softimpact.symbolic.robot.rigid import Array

Q = np.array([-1.22, 0.84, 0.72, -2.41, 0.79, 1.97, -2.04])
Y = np.array([0.0, 1.0, 0.0])
APPROACH = Approach(Q, Y, speed=0.5)
CHEST = Contact(body_region("chest"))
NEVER = Motors("free", float("inf"))


@pytest.fixture(scope="module")
def model() -> ImpactModel:
    robot = load_robot("panda")
    return impact_model(robot, drives=drives(robot, joint_stiffness=1e4))


def chain_of(model: ImpactModel, order: int) -> tuple[Array, Array]:
    found = model.chain(Q, Y, order=order)
    masses, springs = ([float(x) for x in values] for values in (found.mass, found.stiffness))
    return np.array(masses), np.array(springs)


def assert_same(ours: ImpactHistory, theirs: ImpactHistory) -> None:
    assert ours.peak == pytest.approx(theirs.peak, rel=1e-7)
    assert ours.pressing == pytest.approx(theirs.pressing, abs=1e-6)
    times = np.linspace(0, 0.05, 50)
    found = [np.interp(times, each.time, each.force) for each in (ours, theirs)]
    assert_near(found[0], found[1], 0.05)


@pytest.mark.parametrize("contact", [CHEST, Contact(body_region("hand"), clamped=False)])
def test_masses_of_the_papers_models_are_these(model: ImpactModel, contact: Contact) -> None:
    reduced = model.reduced(Q, Y)
    one = simulate_masses(float(reduced.m_c), 0.0, 0.5, contact)
    assert_same(one, simulate_impact(model, APPROACH, contact, "one_mass"))
    masses = [float(reduced.m_c), float(reduced.m_a)]
    two = simulate_masses(masses, [float(reduced.k_r), 0.0], 0.5, contact)
    assert_same(two, simulate_impact(model, APPROACH, contact, "two_mass"))


def test_a_chain_is_its_masses(model: ImpactModel) -> None:
    masses, springs = chain_of(model, 4)
    found = simulate_impact(model, APPROACH, CHEST, "chain", motors=NEVER, order=4, end="free")
    assert_same(simulate_masses(masses, [*springs[:-1], 0.0], 0.5, CHEST), found)


def test_a_ground_that_moves_on_pushes(model: ImpactModel) -> None:
    masses, springs = chain_of(model, 2)
    held = simulate_masses(masses, springs, 0.5, CHEST)
    free = simulate_masses(masses, [springs[0], 0.0], 0.5, CHEST)
    assert held.peak > free.peak
    assert held.pressing is not None
    assert held.pressing > 100  # N: the ground has moved a quarter of a metre


@pytest.mark.parametrize(
    ("mass", "springs", "speed", "reason"),
    [
        ([], [], 0.5, "mass: needs a list of finite masses"),
        ([1.0, 0.0], [1.0, 0.0], 0.5, "mass: needs a list of finite masses"),
        ([1.0, np.nan], [1.0, 0.0], 0.5, "mass: needs a list of finite masses"),
        ([[1.0]], [0.0], 0.5, "mass: needs a list of finite masses"),
        ([1.0, 2.0], [1.0], 0.5, "springs: needs 2 finite numbers"),
        ([1.0], [-1.0], 0.5, "springs: needs 1 finite numbers"),
        ([1.0], [0.0], 0.0, "speed: must be greater than 0"),
    ],
)
def test_what_are_no_masses(mass: Array, springs: Array, speed: float, reason: str) -> None:
    with pytest.raises(InvalidValue, match=reason):
        simulate_masses(mass, springs, speed, CHEST)
