# SPDX-License-Identifier: BSD-3-Clause
"""What holds between the linear models, and for each of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from impact_cases import CHEST, HEAD, POSE, peak_of_one_mass
from oracles import configurations

from softimpact.simulate import Approach, Fidelity, simulate_impact
from softimpact.simulate.arrival import arrival_of
from softimpact.simulate.events import SPAN, course_of
from softimpact.simulate.linear import linear_system, modes
from softimpact.simulate.linear_stages import linear_scene
from softimpact.simulate.simulator import UNIT_TIME
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    InvalidValue,
    Motors,
    Robot,
    body_region,
    drives,
    generalised_velocity,
    impact_model,
    load_robot,
    unit_direction,
)

LINEAR: tuple[Fidelity, ...] = ("one_mass", "two_mass", "chain", "linearised")
FOLDED = np.array([0.0, 0.0, np.pi / 3, 0.0])


@pytest.fixture(scope="module")
def arm(panda: Robot) -> ImpactModel:
    return impact_model(panda, drives=drives(panda, 1e4))


@pytest.fixture(scope="module")
def rr() -> ImpactModel:
    return impact_model(load_robot("rr"), "P")


@pytest.mark.parametrize("gain", [None, 6050.0])
def test_chain_of_full_order_is_the_linearised_robot(panda: Robot, gain: float | None) -> None:
    model = impact_model(panda, drives=drives(panda, 3e3, computed_torque_gain=gain))
    for q in configurations(panda, 2, seed=8):
        approach = Approach(q, np.array([0.3, 1.0, -0.4]), 0.7)
        whole = simulate_impact(model, approach, HEAD)
        chain = simulate_impact(model, approach, HEAD, "chain", order=model.size)
        assert chain.first_contact == pytest.approx(whole.first_contact, rel=1e-6)
        assert chain.separation == pytest.approx(whole.separation, rel=1e-6)


def test_two_springs_are_three_masses(rr: ImpactModel) -> None:
    approach = Approach(FOLDED, np.array([0.0, 1.0, 0.0]), 1.0, None)
    whole = simulate_impact(rr, approach, CHEST)
    for order in (3, 4):
        chain = simulate_impact(rr, approach, CHEST, "chain", order=order)
        np.testing.assert_allclose(chain.force, whole.force, atol=1e-6 * whole.force.max())
    two = simulate_impact(rr, approach, CHEST, "chain", order=2)
    assert two.first_contact != pytest.approx(whole.first_contact, rel=1e-4)


def test_a_chain_keeps_its_last_spring_where_a_servo_drives_the_motors(panda: Robot) -> None:
    motors = {"free": Motors("free"), "grounded": Motors("servo", np.inf)}
    motors["grounded too"] = motors["grounded"]
    approach = Approach(POSE, np.array([0.0, 1.0, 0.0]), 1.0)
    driven = {"free": {}, "grounded": {"position_gain": 5e3}} | {
        "grounded too": {"computed_torque_gain": 500.0}
    }
    for expected, gains in driven.items():
        model = impact_model(panda, drives=drives(panda, 1e4, **gains))
        default, free, grounded = (
            simulate_impact(
                model, approach, CHEST, "chain", order=4, end=end, motors=motors[expected]
            ).first_contact
            for end in (None, "free", "grounded")
        )
        assert default == (free if expected == "free" else grounded)
        assert free != pytest.approx(grounded, rel=1e-6)


def test_stiff_springs_make_a_rigid_robot(panda: Robot) -> None:
    approach = Approach(POSE, np.array([0.0, 1.0, 0.0]), 1.0)
    rigid = simulate_impact(impact_model(panda), approach, HEAD)
    stiff = impact_model(panda, drives=drives(panda, 1e8))
    assert simulate_impact(stiff, approach, HEAD).first_contact == pytest.approx(
        rigid.first_contact, rel=1e-4
    )
    # without springs, the mass at the contact point is all there is
    alone = simulate_impact(impact_model(panda), approach, HEAD, "one_mass")
    assert alone.first_contact == pytest.approx(rigid.first_contact, rel=1e-9)
    with pytest.raises(InvalidValue, match="two_mass needs a spring"):
        simulate_impact(impact_model(panda), approach, HEAD, "two_mass")


@pytest.mark.parametrize("fidelity", ["two_mass", "chain", "linearised"])
def test_soft_springs_leave_the_links_alone(panda: Robot, fidelity: Fidelity) -> None:
    approach = Approach(POSE, np.array([0.0, 1.0, 0.0]), 1.0)
    soft = impact_model(panda, drives=drives(panda, 0.1))
    alone = simulate_impact(soft, approach, HEAD, "one_mass")
    assert simulate_impact(soft, approach, HEAD, fidelity).first_contact == pytest.approx(
        alone.first_contact, rel=1e-5
    )


def test_a_stiff_spring_joins_the_two_masses(panda: Robot) -> None:
    stiff = impact_model(panda, drives=drives(panda, 9e8))  # from 1e9 on it is rigid
    n = unit_direction([0, 1, 0])
    reduced = stiff.reduced(POSE, n)
    expected = peak_of_one_mass(float(reduced.m_c + reduced.m_a), 1.0, HEAD)
    two = simulate_impact(stiff, Approach(POSE, n, 1.0), HEAD, "two_mass")
    assert two.first_contact == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("fidelity", LINEAR)
def test_force_does_not_know_left_from_right(arm: ImpactModel, fidelity: Fidelity) -> None:
    n = np.array([0.5, -1.0, 0.2])
    there = simulate_impact(arm, Approach(POSE, n, 1.0), HEAD, fidelity)
    back = simulate_impact(arm, Approach(POSE, -3 * n, 1.0), HEAD, fidelity)
    assert back.first_contact == pytest.approx(there.first_contact, rel=1e-9)


@settings(max_examples=15)
@given(
    seed=st.integers(0, 2**32 - 1),
    fidelity=st.sampled_from(LINEAR),
    speed=st.floats(0.02, 2.0),
    factor=st.floats(1.01, 4.0),
)
def test_force_grows_with_speed(seed: int, fidelity: Fidelity, speed: float, factor: float) -> None:
    random = np.random.default_rng(seed)
    robot = load_robot("rr")
    model = impact_model(robot, "P", drives=drives(robot, position_gain=random.uniform(0, 1e4)))
    q = np.array([0.0, 0.0, random.uniform(0.3, 2.8), 0.0])
    approach = Approach(q, np.append(random.normal(size=2), 0.0), speed)
    slow = simulate_impact(model, approach, HEAD, fidelity)
    fast = simulate_impact(model, replace(approach, speed=factor * speed), HEAD, fidelity)
    assert fast.first_contact > slow.first_contact
    # k_f δ^1.5 in series with springs: more than in proportion, less than without them
    assert fast.first_contact < factor**1.3 * slow.first_contact


@pytest.mark.parametrize("clamped", [True, False])
def test_energy_is_kept_without_damping(arm: ImpactModel, clamped: bool) -> None:
    region = replace(body_region("chest"), damping=0.0)
    contact, speed = Contact(region, clamped=clamped), 1.3
    approach = arrival_of(arm, Approach(POSE, np.array([0.0, 1.0, 1.0]), speed))
    scene = linear_scene(arm, approach, contact, Motors("free"), 1e-10)
    end = course_of(scene, SPAN).pieces[0].run
    found = modes(linear_system(arm, approach, "free"))
    size = len(found.shape)
    # modes deviate from the motion before the impact, which bends no spring
    before = speed * found.into @ generalised_velocity(arm, approach.link_velocity)
    y, rate = speed * UNIT_TIME * end.state[:size], speed * end.state[size : 2 * size]
    rate += before[:, None]
    x_0 = speed * UNIT_TIME * end.state[-1]
    body = np.zeros((2, len(x_0))) if clamped else end.state[2 * size + 1 : -1]
    x_h, v_h = speed * UNIT_TIME * body[0], speed * body[1]
    energy = (
        0.5 * (rate**2).sum(axis=0)
        + 0.5 * found.squared_frequency @ y**2
        + 0.4 * contact.hertz_stiffness * np.maximum(end.depth, 0) ** 2.5
        + 0.5 * region.stiffness * (x_0 - x_h) ** 2
        + 0.5 * region.effective_mass * v_h**2
    )
    assert energy[0] == pytest.approx(0.5 * before @ before, rel=1e-12)
    np.testing.assert_allclose(energy, energy[0], rtol=1e-7)
    assert end.force.max() > 100
    np.testing.assert_allclose(end.force, [float(contact.force(d)) for d in end.depth], rtol=1e-12)
