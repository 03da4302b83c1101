# SPDX-License-Identifier: BSD-3-Clause
"""Laws of what motors do in an impact."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from impact_cases import CHEST, EARTH, FREE_HEAD, HEAD, POSE

from softimpact.simulate import Approach, largest_safe_speed, simulate_impact
from softimpact.simulate.many import many_peaks
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    InvalidValue,
    Motors,
    Robot,
    drives,
    impact_model,
    load_robot,
)
from softimpact.symbolic.impact.motors import MotorKind

PANDA = load_robot("panda")
README = np.array([0, 0.3, 0, -2, 0, 2, 0.8])
ALONG_Y = np.array([0.0, 1.0, 0.0])
CONTACTS = st.sampled_from([HEAD, FREE_HEAD, CHEST])
SEEDS = st.integers(0, 2**32 - 1)
UNTIL = 0.08


def random_arm(seed: int, **options: object) -> tuple[ImpactModel, Approach]:
    """Return the Panda near an easy pose, with springs of two decades."""
    random = np.random.default_rng(seed)
    springs = 10 ** random.uniform(3, 5, 7)
    model = impact_model(PANDA, drives=drives(PANDA, springs, **options))  # type: ignore[arg-type]
    q = POSE + random.uniform(-0.4, 0.4, 7)
    return model, Approach(q, random.normal(size=3), random.uniform(0.1, 1.0))


def peak(
    model: ImpactModel, approach: Approach, contact: Contact, motors: Motors, until: float = UNTIL
) -> float:
    found = many_peaks(model, approach, contact, [approach.speed], motors=motors, horizon=until)
    return float(found.peak[0])


@settings(max_examples=3)
@given(SEEDS, CONTACTS, st.sampled_from([0.02, 0.05]))
def test_a_stiff_servo_is_driven(seed: int, contact: Contact, reaction_time: float) -> None:
    servo, driven = Motors("servo", reaction_time), Motors("driven", reaction_time)
    forces = []
    for gain in (1e5, 1e7, 1e9):
        model, approach = random_arm(seed, position_gain=gain, damping_gain=0.02 * gain)
        forces.append(peak(model, approach, contact, servo))
    wanted = peak(model, approach, contact, driven)
    errors = [abs(force / wanted - 1) for force in forces]
    assert errors[2] < max(0.1 * errors[0], 1e-5)
    assert errors[2] < 1e-3


@settings(max_examples=3)
@given(SEEDS, CONTACTS)
def test_heavy_rotors_are_driven_until_the_reaction_and_after(seed: int, contact: Contact) -> None:
    """Free rotors of great inertia go on as motors do that are driven for ever."""
    model, approach = random_arm(seed)
    wanted = peak(model, approach, contact, Motors("driven", inf))
    errors = []
    for factor in (1e2, 1e4, 1e6):
        heavy = model.with_drives(replace(model.drives, rotors=factor * model.drives.rotors))
        errors.append(abs(peak(heavy, approach, contact, Motors("free")) / wanted - 1))
    assert errors[2] < max(0.1 * errors[0], 1e-5)
    assert errors[2] < 1e-3


@settings(max_examples=3)
@given(SEEDS, CONTACTS)
def test_driven_motors_need_no_rotors(seed: int, contact: Contact) -> None:
    motors = Motors("driven", inf)
    forces = []
    for rotors in (None, 0.0, 3.0):
        model, approach = random_arm(seed, rotor_inertia=rotors)
        forces.append(peak(model, approach, contact, motors))
    assert forces[1] == pytest.approx(forces[0], rel=1e-9)
    assert forces[2] == pytest.approx(forces[0], rel=1e-9)


def test_nor_do_they_in_the_nonlinear_robot() -> None:
    motors, (model, approach) = Motors("driven", inf), random_arm(0, rotor_inertia=0.0)
    full = simulate_impact(model, approach, FREE_HEAD, "full", motors=motors, horizon=0.02)
    with_rotors, _ = random_arm(0)
    other = simulate_impact(with_rotors, approach, FREE_HEAD, "full", motors=motors, horizon=0.02)
    assert full.peak == pytest.approx(other.peak, rel=1e-9)
    with pytest.raises(InvalidValue, match="rotor_inertia"):
        simulate_impact(model, approach, FREE_HEAD, motors=Motors("free"))


@settings(max_examples=4)
@given(SEEDS, CONTACTS, st.sampled_from([0.0, 0.02, inf]))
def test_without_gains_a_servo_is_free(seed: int, contact: Contact, reaction_time: float) -> None:
    model, approach = random_arm(seed)
    idle = peak(model, approach, contact, Motors("servo", reaction_time))
    free = peak(model, approach, contact, Motors("free"))
    assert idle == pytest.approx(free, rel=1e-3 if np.isfinite(reaction_time) else 1e-9)


@settings(max_examples=4)
@given(SEEDS, CONTACTS)
def test_motors_that_react_at_once_are_free(seed: int, contact: Contact) -> None:
    model, approach = random_arm(seed, position_gain=1e5)
    free = peak(model, approach, contact, Motors("free"))
    for kind in ("servo", "driven"):
        assert peak(model, approach, contact, Motors(kind, 0.0)) == pytest.approx(free, rel=1e-3)


KINDS: tuple[MotorKind, ...] = ("free", "servo", "driven")


@settings(max_examples=4)
@given(SEEDS, CONTACTS, st.sampled_from(KINDS), st.sampled_from([0.01, 0.02, 0.05]))
def test_the_peak_grows_with_speed(
    seed: int, contact: Contact, kind: MotorKind, reaction_time: float
) -> None:
    model, approach = random_arm(seed, position_gain=3e3, damping_gain=60.0)
    speeds = np.linspace(0.05, 1.5, 60)
    motors = Motors(kind, reaction_time)
    found = many_peaks(model, approach, contact, speeds, motors=motors, horizon=0.1)
    assert (np.diff(found.peak) > -1e-3 * found.peak[:-1]).all()
    assert (found.peak >= found.first_contact * (1 - 1e-12)).all()
    assert (found.first_contact >= found.first_peak * (1 - 1e-12)).all()


@pytest.mark.parametrize("law", ["free", "servo", "driven", "held"])
def test_a_chain_of_full_order_is_the_linearised_robot(law: MotorKind) -> None:
    springs = np.array([2e4, 1e4, 8e3, 1.5e4, 5e3, 3e3, 4e3])
    given = drives(PANDA, springs, position_gain=2e3)
    model = impact_model(PANDA, drives=given, gravity=EARTH)
    approach, motors = Approach(POSE, np.array([0.4, 1.0, -0.3]), 0.6), Motors(law, 0.012)
    whole, chain = (
        simulate_impact(model, approach, CHEST, f, motors=motors, horizon=0.06, order=model.size)
        for f in ("linearised", "chain")
    )
    assert chain.peak == pytest.approx(whole.peak, rel=1e-6)
    assert np.interp(chain.time, whole.time, whole.force) == pytest.approx(
        chain.force, abs=1e-5 * whole.peak
    )


@pytest.mark.parametrize("motors", [Motors("servo", 0.017), Motors("driven", 0.017, "stop", 0.02)])
def test_tolerances_and_horizons_change_nothing(motors: Motors) -> None:
    model, approach = random_arm(1, position_gain=3e3, damping_gain=60.0)
    fine = simulate_impact(model, approach, FREE_HEAD, motors=motors, tolerance=1e-12)
    assert fine.time_of_peak < 0.2
    for horizon, tolerance in ((0.5, 1e-8), (0.2, 1e-10), (0.3337, 1e-9)):
        other = simulate_impact(
            model, approach, FREE_HEAD, motors=motors, horizon=horizon, tolerance=tolerance
        )
        assert other.peak == pytest.approx(fine.peak, rel=1e-5)
        assert other.first_contact == pytest.approx(fine.first_contact, rel=1e-5)


@pytest.mark.parametrize(
    ("stiffness", "gain", "force"),
    [
        (1e4, 0.0, 139.2153420),
        (1e4, 1e4, 132.8617683),
        (1e5, 1e5, 81.4276713),
        (1e7, 1e6, 21.3550535),
    ],
)
def test_first_contacts_of_held_motors_are_those_of_version_0_1(
    stiffness: float, gain: float, force: float
) -> None:
    """Panda, README pose, chest clamped, 0.5 m/s: more gain, less force, as if they helped."""
    model = impact_model(PANDA, drives=drives(PANDA, stiffness, position_gain=gain))
    approach = Approach(README, ALONG_Y, 0.5)
    held = simulate_impact(model, approach, CHEST, motors=Motors("held"), horizon=None)
    assert held.first_contact == pytest.approx(force, rel=1e-7)
    free, servo, driven = (
        peak(model, approach, CHEST, Motors(k, 0.05), 0.05) for k in ("free", "servo", "driven")
    )
    assert free * (1 - 1e-4) <= servo < driven
    assert servo >= held.first_contact * (1 - 1e-3)


@pytest.mark.parametrize("gain", [0.0, 1e4])
def test_held_motors_give_no_safe_speed(panda: Robot, gain: float) -> None:
    model = impact_model(panda, drives=drives(panda, 1e4, position_gain=gain))
    with pytest.raises(InvalidValue, match="'held' cannot give a safe speed"):
        largest_safe_speed(model, Approach(POSE, ALONG_Y, 0.5), CHEST, 100.0, motors=Motors("held"))


def test_a_safe_first_contact_is_safe_at_all_lower_speeds() -> None:
    """At lower speed a contact may merge with the next hit and be the harder one for it."""
    q = [-1.044873, -1.101723, 0.999723, -2.486088, 0.45017, 2.252942, 2.679557]
    approach = Approach(q, [0.848110, -0.501178, 0.171844], 0.12)
    model, motors = impact_model(PANDA, drives=drives(PANDA, 365.507)), Motors("free")
    speeds = np.linspace(0.05, 0.12, 29)
    found = many_peaks(model, approach, HEAD, speeds, motors=motors, horizon=0.06).first_contact
    fall = int(np.argmin(np.diff(found)))
    assert found[fall + 1] < 0.95 * found[fall]
    limit = 0.5 * (found[fall] + found[fall + 1])  # met twice
    safe = largest_safe_speed(
        model, approach, HEAD, float(limit), definition="first_contact", motors=motors
    )
    below = many_peaks(
        model, approach, HEAD, np.linspace(0.2, 1, 40) * safe, motors=motors, horizon=0.06
    )
    assert safe < speeds[fall]
    assert below.first_contact.max() < limit * 1.002
