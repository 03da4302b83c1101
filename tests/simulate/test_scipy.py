# SPDX-License-Identifier: BSD-3-Clause
"""SciPy integrates the same equations, written down again and in their first coordinates."""

from __future__ import annotations

import numpy as np
import pytest
from oracles import configurations
from scipy.integrate import solve_ivp

from softimpact.simulate import Approach, simulate_impact
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    Motors,
    Robot,
    approach_velocity,
    body_region,
    drives,
    generalised_velocity,
    impact_model,
    unit_direction,
)
from softimpact.symbolic.robot.rigid import Array


def by_scipy(
    model: ImpactModel, approach: Approach, contact: Contact, times: Array
) -> tuple[Array, float, float]:
    """Return the force at some times, its first maximum and the time of separation."""
    n = unit_direction(approach.direction)
    linear = model.linear(approach.q, n)
    M, K = np.array(linear.mass.matrix), np.array(linear.stiffness)
    J = np.array(linear.jacobian).ravel()
    start = generalised_velocity(model, approach_velocity(model, approach.q, n)) * approach.speed
    k_h, c_h = contact.region.stiffness, contact.region.damping
    size = len(J)
    flexibility, push = np.linalg.solve(M, K), np.linalg.solve(M, J)

    def force(state: Array) -> Array:
        depth = np.maximum(J @ state[:size] - state[-1], 0)
        return np.asarray(contact.hertz_stiffness * depth**1.5)

    def rate(_: float, state: Array) -> Array:
        z, dz = state[:size], state[size : 2 * size]
        x_h, v_h, x_0 = state[2 * size :]
        f = float(force(state))
        a_h = 0.0 if contact.clamped else f / contact.region.effective_mass
        slip = (f - k_h * (x_0 - x_h)) / c_h
        return np.concatenate([dz, -flexibility @ z - push * f, [v_h, a_h, v_h + slip]])

    def depth(_: float, state: Array) -> float:
        return float(J @ state[:size] - state[-1])

    def closing(time: float, state: Array) -> float:
        return depth(time, rate(time, state))

    closing.direction = depth.direction = -1  # type: ignore[attr-defined]
    found = solve_ivp(
        rate,
        (0, times[-1]),
        np.concatenate([np.zeros(size), start, np.zeros(3)]),
        "Radau",
        times,
        events=(closing, depth),
        rtol=1e-10,
        atol=1e-13,
    )
    peak, ends = found.y_events[0][0], found.t_events[1]
    return force(found.y), float(force(peak)), float(ends[ends > 1e-5][0])


@pytest.mark.parametrize(("region", "clamped"), [("head", True), ("chest", False)])
@pytest.mark.parametrize("case", range(2))
def test_agrees_with_scipy(panda: Robot, region: str, clamped: bool, case: int) -> None:
    q = list(configurations(panda, 2, seed=5))[case]
    random = np.random.default_rng(case)
    gain = [None, 6050.0][case]
    model = impact_model(
        panda, drives=drives(panda, random.uniform(1e3, 3e4, 7), computed_torque_gain=gain)
    )
    approach = Approach(q, random.normal(size=3), random.uniform(0.1, 2))
    contact = Contact(body_region(region), clamped=clamped)
    motors = Motors("free" if gain is None else "held")
    ours = simulate_impact(model, approach, contact, motors=motors, horizon=None)
    force, first_peak, separation = by_scipy(model, approach, contact, ours.time)
    np.testing.assert_allclose(ours.force, force, rtol=0, atol=1e-6 * force.max())
    assert ours.first_peak == pytest.approx(first_peak, rel=1e-6)
    assert ours.separation == pytest.approx(separation, rel=1e-6)
    # between the nodes of 50 µs the force may rise a little further
    assert force.max() * (1 - 1e-9) <= ours.first_contact <= force.max() * (1 + 1e-3)
