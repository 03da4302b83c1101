# SPDX-License-Identifier: BSD-3-Clause
"""The one-mass forces of MSM, and impacts with a solution in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from impact_cases import peak_of_one_mass
from scipy.optimize import brentq

from softimpact.simulate import Approach, simulate_impact
from softimpact.symbolic import Contact, ImpactModel, body_region, drives, impact_model, load_robot

COMPUTED_TORQUE_GAIN = 6050.0
FOLDED = [0.0, 0.0, np.pi / 3, 0.0]

MSM_RR = [
    # scenario, tip, q, head [N], chest [N]: recomputed, and printed but for the chest in (a)
    ("a", "P", [0.0] * 4, 291.2, 125.3),
    ("b", "O3", [0.0] * 4, 902.8, 387.3),
    ("c", "P", FOLDED, 363.5, 156.5),
    ("d", "O3", FOLDED, 1078.9, 462.2),
]


def turned_by_first_motor(tip: str, q: list[float]) -> tuple[ImpactModel, Approach]:
    robot = load_robot("rr")
    model = impact_model(
        robot, tip, drives=drives(robot, computed_torque_gain=COMPUTED_TORQUE_GAIN)
    )
    rates = np.array([1.0, 0.0, 0.0, 0.0])
    moved = np.array(model.jacobian(q)) @ rates
    speed = np.linalg.norm(moved)
    return model, Approach(np.array(q), moved / speed, 1.0, rates / speed)


@pytest.mark.parametrize(("scenario", "tip", "q", "head", "chest"), MSM_RR)
def test_one_mass_forces_of_rr(
    scenario: str, tip: str, q: list[float], head: float, chest: float
) -> None:
    model, approach = turned_by_first_motor(tip, q)
    for region, force in (("head", head), ("chest", chest)):
        history = simulate_impact(model, approach, Contact(body_region(region)), "one_mass")
        assert history.first_peak == pytest.approx(force, rel=5e-4), scenario
        assert history.first_contact == history.first_peak


@pytest.mark.parametrize(
    ("m_c", "region", "force"),
    [(1.17, "head", 372.3), (0.44, "head", 222.9), (1.17, "chest", 160.3), (0.44, "chest", 95.7)],
)
def test_one_mass_forces_of_r_min(m_c: float, region: str, force: float) -> None:
    assert peak_of_one_mass(m_c, 1.0, Contact(body_region(region))) == pytest.approx(
        force, rel=5e-4
    )


def peak_from_energy(mass: float, speed: float, contact: Contact) -> float:
    """Without damping ½mv² is stored in skin and spring when the force is highest."""
    k_f, k_h = contact.hertz_stiffness, contact.region.stiffness

    def missing(force: float) -> float:
        stored = 0.4 * k_f * (force / k_f) ** (5 / 3) + force**2 / (2 * k_h)
        return float(stored - mass * speed**2 / 2)

    return float(brentq(missing, 0, 1e6, xtol=1e-9, rtol=1e-14))


@pytest.mark.parametrize("mass", [0.02, 1.0, 60.0])
@pytest.mark.parametrize("speed", [0.05, 2.0])
@pytest.mark.parametrize("clamped", [True, False])
def test_peak_without_damping_is_that_of_the_energy(
    mass: float, speed: float, clamped: bool
) -> None:
    region = replace(body_region("chest"), damping=0.0)
    contact = Contact(region, clamped=clamped)
    m_h = region.effective_mass
    moving = mass if clamped else mass * m_h / (mass + m_h)
    expected = peak_from_energy(moving, speed, contact)
    assert peak_of_one_mass(mass, speed, contact) == pytest.approx(expected, rel=1e-7)


def test_damping_vanishes_continuously() -> None:
    region = body_region("head")
    without = peak_of_one_mass(1.0, 1.0, Contact(replace(region, damping=0.0)))
    nearly = peak_of_one_mass(1.0, 1.0, Contact(replace(region, damping=1e-3)))
    assert nearly == pytest.approx(without, rel=1e-4)
    assert nearly != without
