# SPDX-License-Identifier: BSD-3-Clause
"""MSM's R-Min, scenarios e (impact at P) and f (at O13), §3.3.

The distance of the motors is not printed; 0.263 m is inferred from the two reflected masses. The
passive joints rest where springs and gravity balance.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from softimpact.symbolic import (
    Chain,
    ImpactModel,
    Robot,
    approach_velocity,
    chain,
    configuration_at_rest,
    drives,
    impact_model,
    load_robot,
)
from softimpact.symbolic.robot.rigid import Array, Placement

GRAVITY = (0.0, 0.0, -9.81)
MOTORS = np.radians([-130.6, -50.0])
ALONG_X = np.array([-1.0, 0.0, 0.0])
"""The printed rates of the motors move both contact points towards −x."""
TIPS = {"e": "P", "f": "O13"}
PRINTED_MASS = {"e": 1.17, "f": 0.44}
PROPORTIONAL_GAIN = 1076.0

scenarios = pytest.mark.parametrize("scenario", TIPS)


def robot_with(k_s: float = 351.0, distance: float = 0.263) -> Robot:
    """Return R-Min with other springs or another distance of its motors."""
    robot = load_robot("rmin")
    joints = [replace(j, stiffness=k_s if j.stiffness else 0.0) for j in robot.joints]
    base = joints[3].placement
    joints[3] = replace(
        joints[3], placement=Placement(base.rotation, np.array([distance, 0.0, 0.0]))
    )
    return replace(robot, joints=tuple(joints))


def at_rest(
    scenario: str, k_s: float = 351.0, gain: float | None = None, distance: float = 0.263
) -> tuple[ImpactModel, Array]:
    """Return a scenario's model and configuration."""
    robot = robot_with(k_s, distance)
    given = drives(robot, computed_torque_gain=gain)
    model = impact_model(robot, TIPS[scenario], drives=given, gravity=GRAVITY)
    return model, configuration_at_rest(model, MOTORS)


@scenarios
def test_reflected_masses_are_the_printed_ones(scenario: str) -> None:
    model, q = at_rest(scenario)
    m_c = float(model.reflected_mass(q, ALONG_X))
    assert round(m_c, 2) == PRINTED_MASS[scenario]
    assert m_c == pytest.approx({"e": 1.1711, "f": 0.43857}[scenario], rel=1e-4)


@pytest.mark.parametrize("distance", [0.257, 0.269])
def test_another_distance_of_the_motors_gives_other_masses(distance: float) -> None:
    masses = {}
    for scenario in TIPS:
        model, q = at_rest(scenario, distance=distance)
        masses[scenario] = round(float(model.reflected_mass(q, ALONG_X)), 2)
    assert masses != PRINTED_MASS


@pytest.mark.parametrize(
    ("scenario", "found", "printed"),
    [("e", (-2.786, -2.799), (-2.80, -2.74)), ("f", (-2.786, -5.067), (-2.80, -5.00))],
)
def test_motor_rates_are_near_the_printed_ones(
    scenario: str, found: Chain, printed: list[float]
) -> None:
    """No distance gives all printed rates; ours are within 2.5 % of them."""
    model, q = at_rest(scenario, k_s=5e4)
    rates = approach_velocity(model, q, ALONG_X)
    assert rates[:2] == pytest.approx(found, rel=5e-4)
    assert rates[:2] == pytest.approx(printed, rel=0.025)
    assert not rates[2:].any()


REDUCED = {
    # scenario, k_s: k_r [N/m] and m_a [kg] without and with the controller's gain
    ("e", 35.1): (720.3, 0.06730, 2040.5, 1.1027),
    ("e", 351.0): (7426.5, 0.05181, 8740.7, 0.1547),
    ("e", 3510.0): (74499.0, 0.05030, 75813.0, 0.05944),
    ("f", 35.1): (5333.0, 1.2771, 5468.6, 1.4475),
    ("f", 351.0): (52793.0, 1.2660, 52930.0, 1.3124),
    ("f", 3510.0): (527390.0, 1.2648, 527530.0, 1.2699),
}
"""Ours: the paper has them in Fig. 12 and 13 only."""


@pytest.mark.parametrize(("scenario", "k_s"), REDUCED)
def test_reduced_parameters(scenario: str, k_s: float) -> None:
    found = []
    for gain in (None, PROPORTIONAL_GAIN):
        model, q = at_rest(scenario, k_s, gain)
        reduced = model.reduced(q, ALONG_X)
        found += [float(reduced.k_r), float(reduced.m_a)]
    assert found == pytest.approx(REDUCED[scenario, k_s], rel=5e-4)


def test_the_mass_behind_the_end_point_is_small_and_behind_the_elbow_large() -> None:
    """Which is why springs matter for f and not for e (MSM §3.3.4)."""
    parts = {}
    for scenario in TIPS:
        model, q = at_rest(scenario)
        reduced = model.reduced(q, ALONG_X)
        parts[scenario] = float(reduced.m_a / reduced.m_c)
    assert parts["e"] < 0.1
    assert parts["f"] > 2


@scenarios
def test_k_r_is_nearly_proportional_to_k_s(scenario: str) -> None:
    """Fig. 13; arms misaligned by gravity keep it from being exactly so."""
    ratios = [
        float(model.reduced(q, ALONG_X).k_r) / k_s
        for k_s in (100.0, 1e3, 1e4)
        for model, q in [at_rest(scenario, k_s)]
    ]
    assert ratios == pytest.approx([ratios[-1]] * 3, rel=0.02)
    assert len({f"{ratio:.6g}" for ratio in ratios}) == 3


@scenarios
def test_chain_of_two_has_a_mass_that_does_not_depend_on_coordinates(scenario: str) -> None:
    model, q = at_rest(scenario)
    second = float(chain(model.linear(q, ALONG_X), 2).mass[1])
    other = replace(model.robot, independent=("q11", "q21", "q12", "q22"))
    moved = impact_model(other, TIPS[scenario], gravity=GRAVITY)
    assert float(chain(moved.linear(q, ALONG_X), 2).mass[1]) == pytest.approx(second, rel=1e-6)
    assert float(moved.reduced(q, ALONG_X).m_a) != pytest.approx(
        float(model.reduced(q, ALONG_X).m_a), rel=0.05
    )
