# SPDX-License-Identifier: BSD-3-Clause
"""The standard's two-body formula."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from softimpact.symbolic import Robot, body_region, moving_mass, two_body


@pytest.mark.parametrize(
    ("region", "clamped", "free"), [("head", 562, 329), ("chest", 229, 208), ("hand", 397, 102)]
)
def test_the_panda_at_half_a_metre_a_second(
    panda: Robot, region: str, clamped: float, free: float
) -> None:
    """Worked out by hand with M/2 = 8.41 kg."""
    mass = moving_mass(panda)
    assert mass / 2 == pytest.approx(8.41, abs=0.005)
    held = two_body(body_region(region), True, mass)
    loose = two_body(body_region(region), False, mass)
    assert held.force(0.5) == pytest.approx(clamped, abs=0.5)
    assert loose.force(0.5) == pytest.approx(free, abs=0.6)


@pytest.mark.parametrize("clamped", [True, False])
def test_two_masses_and_a_spring_agree_with_scipy(clamped: bool) -> None:
    region, robot, payload, speed = body_region("lower_arm"), 12.0, 1.5, 0.8
    m_r, m_h, k = robot / 2 + payload, region.effective_mass, region.stiffness

    def rate(_: float, state: np.ndarray) -> list[float]:
        x, v, x_h, v_h = state
        f = k * (x - x_h)
        return [v, -f / m_r, v_h, 0.0 if clamped else f / m_h]

    times = np.linspace(0, 0.05, 20001)
    found = solve_ivp(rate, (0, 0.05), [0, speed, 0, 0], "DOP853", times, rtol=1e-11, atol=1e-14)
    squeezed = (found.y[0] - found.y[2]).max()
    model = two_body(region, clamped, robot, payload)
    assert model.force(speed) == pytest.approx(k * squeezed, rel=1e-6)
    assert model.energy(speed) == pytest.approx(k * squeezed**2 / 2, rel=1e-6)
    assert model.energy(speed) == pytest.approx(model.force(speed) ** 2 / (2 * k))
    assert model.force(model.safe_speed(300.0)) == pytest.approx(300)


def test_payload_counts_whole_and_the_robot_half() -> None:
    chest = body_region("chest")
    assert two_body(chest, True, 10.0, 3.0).reduced_mass == 8.0
    assert two_body(chest, False, 10.0, 3.0).reduced_mass == pytest.approx(1 / (1 / 8 + 1 / 40))


def test_masses_may_be_symbols() -> None:
    m = ca.SX.sym("m")
    force = ca.Function("f", [m], [two_body(body_region("hand"), False, m).force(0.5)])
    assert float(force(16.82)) == pytest.approx(102, abs=0.6)
