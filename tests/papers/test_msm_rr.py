# SPDX-License-Identifier: BSD-3-Clause
"""MSM's serial elastic RR robot, scenarios a-d (Table 1, §3.2).

What is asserted is recomputed from the paper's equations with three readings it leaves open: the
controller's gain enters K0 as K_p = 6050 rad/s² times the motors' block of M0, Eq. 38's norm is
Frobenius' with orthonormal rows J_a, and the contact normal is the contact point's direction of
motion for q̇ = [1, 0, 0, 0]. The printed numbers stand beside, with how far they are off.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
import pytest
from linear_models import nullspace, transformed, with_nullspace

from softimpact.symbolic import (
    LinearModel,
    chain,
    drives,
    impact_model,
    load_robot,
    reduce_to_two_masses,
)
from softimpact.symbolic.robot.rigid import Array

COMPUTED_TORQUE_GAIN = 6050.0
STIFFNESS = 1e4
THREE_DIGITS = 5e-4
STRAIGHT, FOLDED = np.zeros(4), np.array([0.0, 0.0, np.pi / 3, 0.0])
RELATIVE_TO_ABSOLUTE = np.tril(np.ones((4, 4)))
"""Angles of the four bodies against the base, from MSM's relative coordinates."""


@dataclass(frozen=True)
class Scenario:
    """A column of MSM §3.2.3: recomputed and printed m_c [kg], k_r [N/m], m_a [kg]."""

    tip: str
    q: Array
    recomputed: tuple[float, float, float]
    printed: tuple[float, float, float]


SCENARIOS = {
    "a": Scenario("P", STRAIGHT, (0.731, 5.113e4, 3.497), (0.73, 5.1e4, 3.49)),
    "b": Scenario("O3", STRAIGHT, (6.457, 23.511e4, 12.845), (6.46, 23.5e4, 12.8)),
    "c": Scenario("P", FOLDED, (1.117, 5.363e4, 3.892), (1.12, 5.4e4, 3.88)),
    "d": Scenario("O3", FOLDED, (9.128, 10.764e4, 7.454), (9.13, 10.8e4, 7.43)),
}

scenarios = pytest.mark.parametrize("scenario", SCENARIOS.values(), ids=SCENARIOS)


def linear(scenario: Scenario, gain: float = COMPUTED_TORQUE_GAIN) -> LinearModel:
    """Return M0, K0 and J_c of a scenario."""
    robot = load_robot("rr")
    model = impact_model(robot, scenario.tip, drives=drives(robot, computed_torque_gain=gain))
    moved = np.array(model.jacobian(scenario.q))[:, 0]  # q̇ = [1, 0, 0, 0]
    return model.linear(scenario.q, ca.DM(moved / np.linalg.norm(moved)))


@scenarios
def test_reduced_parameters_are_the_recomputed_ones(scenario: Scenario) -> None:
    reduced = reduce_to_two_masses(linear(scenario))
    found = [float(reduced.m_c), float(reduced.k_r), float(reduced.m_a)]
    assert found == pytest.approx(scenario.recomputed, rel=THREE_DIGITS)


@scenarios
def test_reduced_parameters_are_near_the_printed_ones(scenario: Scenario) -> None:
    """m_c and k_r to their last printed digit; m_a, whose last digit differs, within 0.4 %."""
    reduced = reduce_to_two_masses(linear(scenario))
    m_c, k_r, m_a = scenario.printed
    assert float(reduced.m_c) == pytest.approx(m_c, abs=0.005)
    assert float(reduced.k_r) == pytest.approx(k_r, abs=0.05e4)
    assert float(reduced.m_a) == pytest.approx(m_a, rel=4e-3)


@scenarios
def test_an_explicit_nullspace_gives_the_same(scenario: Scenario) -> None:
    model = linear(scenario)
    reduced = reduce_to_two_masses(model)
    expected = with_nullspace(model, nullspace(model, 1))
    found = (float(reduced.m_c), float(reduced.k_r), float(reduced.m_a))
    assert found == pytest.approx(expected, rel=1e-9)


def test_k_r_follows_the_joint_stiffness_in_a_straight_line() -> None:
    """Without a controller K0 is k_s alone; MSM calls Fig. 5 quasi-linear."""
    scenario = SCENARIOS["a"]
    robot = load_robot("rr")
    model = impact_model(robot, "P")
    n = ca.DM([0.0, 1.0, 0.0])
    assert robot.joints[1].stiffness == STIFFNESS
    k_r = float(model.reduced(scenario.q, n).k_r)
    for factor in (0.05, 5.0):
        joints = tuple(replace(j, stiffness=factor * j.stiffness) for j in robot.joints)
        other = impact_model(replace(robot, joints=joints), "P")
        assert float(other.reduced(scenario.q, n).k_r) == pytest.approx(factor * k_r, rel=1e-12)


ABSOLUTE_ANGLES = {
    # m_a in MSM's coordinates, m_a in the bodies' absolute angles, the chain's second mass [kg]
    ("a", 0.0): (3.902, 4.319, 2.746),
    ("b", 0.0): (16.949, 5.930, 4.303),
    ("c", 0.0): (4.718, 5.410, 3.260),
    ("d", 0.0): (13.166, 5.112, 2.592),
    ("b", COMPUTED_TORQUE_GAIN): (12.845, 10.491, 5.878),
}


@pytest.mark.parametrize(("name", "gain"), ABSOLUTE_ANGLES)
def test_m_a_depends_on_the_choice_of_angles_and_the_chain_does_not(name: str, gain: float) -> None:
    """The same robot in relative and in absolute angles: m_a of (b) is 16.9 or 5.9 kg."""
    relative = linear(SCENARIOS[name], gain)
    absolute = transformed(relative, np.asarray(np.linalg.inv(RELATIVE_TO_ABSOLUTE), dtype=float))
    ours, theirs = reduce_to_two_masses(relative), reduce_to_two_masses(absolute)
    assert float(theirs.m_c) == pytest.approx(float(ours.m_c), rel=1e-12)
    assert float(theirs.k_r) == pytest.approx(float(ours.k_r), rel=1e-12)
    second = [float(chain(model, 2).mass[1]) for model in (relative, absolute)]
    assert second[1] == pytest.approx(second[0], rel=1e-10)
    found = (float(ours.m_a), float(theirs.m_a), second[0])
    assert found == pytest.approx(ABSOLUTE_ANGLES[name, gain], rel=THREE_DIGITS)
