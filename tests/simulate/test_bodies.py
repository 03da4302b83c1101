# SPDX-License-Identifier: BSD-3-Clause
"""One mass against every kind of body, beside SciPy with the equations written down again."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from impact_cases import ALONG_Y, POSE
from scipy.integrate import solve_ivp

from softimpact.simulate import Approach, simulate_impact
from softimpact.simulate.events import Peaks, course_of, peaks_of
from softimpact.simulate.many import many_peaks
from softimpact.simulate.mechanism import BodyKind, Mechanism
from softimpact.simulate.scene import Run, Scene, one_stage
from softimpact.simulate.simulator import build_simulator
from softimpact.symbolic import (
    Contact,
    Curve,
    ImpactModel,
    Motors,
    PowerLaw,
    Robot,
    body_region,
    drives,
    impact_model,
    in_series,
)
from softimpact.symbolic.body.devices import measuring_device
from softimpact.symbolic.body.pads import PADS
from softimpact.symbolic.robot.rigid import Array

MASS, SPEED = 4.0, 0.6
FOAM = Curve([0, 2e-3, 5e-3, 8e-3], [0, 20, 120, 900])
HAND = body_region("hand")
RIG = measuring_device(75e3, PADS["sh30"], 0.35, HAND)
BODIES = {
    "skin": Contact(HAND),
    "skin, free": Contact(HAND, clamped=False),
    "cover": Contact(HAND, cover=PowerLaw(2e6)),
    "foam": Contact(HAND, cover=FOAM),
    "foam, free": Contact(HAND, clamped=False, cover=FOAM),
    "squeezed flat": Contact(HAND, cover=Curve([0, 1e-3, 2e-3], [0, 10, 50])),
    "linear cover": Contact(body_region("chest"), cover=PowerLaw(2e5, 1.0)),
    "device": Contact(replace(RIG, plate_mass=0.0)),
    "device with plate": Contact(RIG),
    "device with plate and damper": Contact(replace(RIG, damping=20.0)),
    "sliding device with plate": Contact(RIG, clamped=False),
    "plate under foam": Contact(RIG, cover=FOAM),
}


def impact(contact: Contact) -> tuple[Run, Peaks]:
    """Return the run of an impact until the first contact has ended, and its peaks."""
    x, v, f = (ca.SX.sym(name) for name in ("x", "v", "f"))
    robot = Mechanism(x, v, f, ca.SX(0, 1), -f / MASS, x)
    simulator = build_simulator(robot, BodyKind.of(contact), 1e-10)
    stages, still = one_stage(simulator, np.zeros(0), np.ones(1))
    course = course_of(Scene(stages, still, SPEED, contact), None)
    return course.run, peaks_of(course, None)


def highest(contact: Contact) -> float:
    """Return the largest force of the first contact [N]."""
    return impact(contact)[1].first_contact.force


def by_scipy(contact: Contact, times: Array) -> Array:
    """Return the contact force at some times [N].

    Where the node between skin and spring has no mass, a tiny damper or the region's own moves it.
    """
    region, x = contact.region, ca.SX.sym("x")
    law = ca.Function("law", [x], [contact.law.force(x)])
    k, c, m_h, m_p = region.stiffness, region.damping, region.effective_mass, region.plate_mass

    def rate(_: float, state: Array) -> list[float]:
        x, v, x_0, v_0, x_h, v_h = state
        f = float(law(x - x_0))
        if m_p:
            held = k * (x_0 - x_h) + c * (v_0 - v_h)
            node, plate = v_0, (f - held) / m_p
        else:
            node, plate = v_h + (f - k * (x_0 - x_h)) / max(c, 0.02), 0.0
            held = f
        away = 0.0 if contact.clamped else held / m_h
        return [v, -f / MASS, node, plate, v_h, away]

    start = [0, SPEED, 0, 0, 0, 0]
    found = solve_ivp(
        rate, (0, times[-1]), start, "Radau", times, rtol=1e-8, atol=1e-11, max_step=2e-4
    )
    return np.array(law(found.y[[0]] - found.y[[2]])).ravel()


@pytest.mark.parametrize("name", BODIES)
def test_agrees_with_scipy(name: str) -> None:
    contact = BODIES[name]
    run, found = impact(contact)
    at = np.linspace(0, len(run.time) - 1, 60).astype(int)
    expected = by_scipy(contact, run.time[at])
    peak = found.first_contact.force
    # a node without mass or damper follows a damper of 0.02 N·s/m in SciPy
    tolerance = 1e-3 if contact.region.damping == contact.region.plate_mass == 0 else 2e-5
    np.testing.assert_allclose(run.force[at], expected, rtol=0, atol=tolerance * peak)
    assert expected.max() <= peak * (1 + 1e-4)


@pytest.fixture(scope="module")
def arm(panda: Robot) -> ImpactModel:
    return impact_model(panda, drives=drives(panda, 1e4))


HEAVY = Contact(measuring_device(75e3, PADS["sh70"], 2.0))


@pytest.mark.parametrize("contact", [*BODIES.values(), HEAVY], ids=[*BODIES, "heavy plate"])
def test_many_impacts_at_once_are_those_of_sundials(arm: ImpactModel, contact: Contact) -> None:
    loose, motors = replace(contact, clamped=False), Motors("driven", 0.01)
    for speed in (0.2, 0.8):
        approach = Approach(POSE, ALONG_Y, speed)
        one = simulate_impact(arm, approach, loose, motors=motors, horizon=0.04)
        many = many_peaks(arm, approach, loose, speed, motors=motors, horizon=0.04)
        assert many.peak[0] == pytest.approx(one.peak, rel=1e-3)
        assert many.first_contact[0] == pytest.approx(one.first_contact, rel=1e-3)


def test_a_light_plate_does_not_matter() -> None:
    bare = highest(Contact(replace(RIG, plate_mass=0.0)))
    light = highest(Contact(replace(RIG, plate_mass=1e-5)))
    assert light == pytest.approx(bare, rel=1e-3)


def test_a_plate_makes_the_first_touch_harder() -> None:
    """The pad has to move it, before the spring below has anything to say."""
    peaks = [impact(Contact(replace(RIG, plate_mass=m)))[1].first_peak for m in (0.0, 5.0)]
    assert peaks[0] is not None
    assert peaks[1] is not None
    assert peaks[1].force > 1.05 * peaks[0].force


def test_a_device_reads_the_force_in_its_spring() -> None:
    """f_c less what the plate takes, by differences of the reading's own motion."""
    contact = BODIES["device with plate"]
    run, _ = impact(contact)
    k, m = contact.region.stiffness, contact.region.plate_mass
    step = float(np.ptp(run.time[:3])) / 2
    inner = slice(1, 399)
    x_0 = run.reading / k
    acceleration = (x_0[2:400] - 2 * x_0[1:399] + x_0[:398]) / step**2
    error = run.force[inner] - run.reading[inner] - m * acceleration
    assert abs(error).max() < 2e-3 * run.force.max()
    bare, _ = impact(BODIES["skin"])
    np.testing.assert_array_equal(bare.reading, bare.force)


def test_covers_help_and_thicker_ones_more() -> None:
    peaks = [highest(Contact(HAND, cover=cover)) for cover in (None, FOAM, in_series(FOAM, FOAM))]
    assert peaks[0] > 1.05 * peaks[1] > 1.05**2 * peaks[2]


def test_one_integrator_serves_all_power_laws() -> None:
    kinds = {BodyKind.of(BODIES[name]) for name in ("skin", "cover")}
    assert len(kinds) == 1
    assert BodyKind.of(BODIES["foam"]) != BodyKind.of(BODIES["skin"])
