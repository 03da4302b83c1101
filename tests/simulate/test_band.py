# SPDX-License-Identifier: BSD-3-Clause
"""Bands: many impacts whose numbers vary, against each of them built one by one."""

from __future__ import annotations

from dataclasses import fields, replace

import casadi as ca
import numpy as np
import pytest
from impact_cases import ALONG_Y, CHEST, HEAD, POSE, r_min

from softimpact.simulate import Approach
from softimpact.simulate.band import Band, impact_band, varied_peaks
from softimpact.simulate.many import many_peaks
from softimpact.simulate.tolerances import EXACT, Tolerances, error_factors, normal_sequence
from softimpact.symbolic import (
    Contact,
    Curve,
    ImpactModel,
    InvalidValue,
    Motors,
    Robot,
    body_region,
    drives,
    impact_model,
    limits_of,
    load_robot,
)
from softimpact.symbolic.body.devices import measuring_device
from softimpact.symbolic.body.pads import PADS
from softimpact.symbolic.robot.rigid import Inertia

APPROACH = Approach(POSE, ALONG_Y, 0.5)
SHORT = 0.06
"""Horizon [s] that holds the peaks on bodies that give way; a clamped one is followed to 0.6 s."""

MOTORS = {
    "free": Motors("free"),
    "driven": Motors("driven"),
    "stopping": Motors("driven", reaction_time=0.01, reaction="stop", stopping_time=0.03),
    "servo": Motors("servo"),
    "never": Motors("driven", reaction_time=np.inf),
}


@pytest.fixture(scope="module")
def arm(panda: Robot) -> ImpactModel:
    given = drives(panda, 8e3, position_gain=2e3, damping_gain=20.0)
    return impact_model(panda, drives=given, gravity=(0.0, 0.0, -9.81))


@pytest.fixture(scope="module")
def plain(panda: Robot) -> ImpactModel:
    """Return the arm without gains and gravity, whose steps cost a third."""
    return impact_model(panda, drives=drives(panda, 8e3))


def loose(contact: Contact) -> Contact:
    return replace(contact, clamped=False)


@pytest.mark.parametrize("kind", MOTORS)
def test_without_tolerances_all_impacts_are_the_one(arm: ImpactModel, kind: str) -> None:
    motors, contact = MOTORS[kind], loose(HEAD)
    found = varied_peaks(
        arm, APPROACH, contact, motors=motors, tolerances=EXACT, horizon=SHORT, samples=40
    )
    one = many_peaks(arm, APPROACH, contact, 0.5, motors=motors, horizon=SHORT)
    for name in ("peak", "first_contact", "pressing"):
        np.testing.assert_allclose(getattr(found, name), getattr(one, name)[0], rtol=1e-10)


BODIES = {
    "foam": Contact(body_region("chest"), False, cover=Curve([0, 3e-3, 6e-3], [0, 40, 400])),
    "device": loose(Contact(measuring_device(75e3, PADS["sh70"]))),
    "plate": loose(Contact(measuring_device(75e3, PADS["sh30"], 0.4))),
    "clamped": CHEST,
}


@pytest.mark.parametrize("body", BODIES)
def test_every_kind_of_body_has_a_band(plain: ImpactModel, body: str) -> None:
    contact, motors = BODIES[body], Motors("driven")
    options = {"motors": motors, "horizon": SHORT}
    exact = varied_peaks(plain, APPROACH, contact, tolerances=EXACT, samples=40, **options)  # type: ignore[arg-type]
    one = many_peaks(plain, APPROACH, contact, 0.5, **options)  # type: ignore[arg-type]
    np.testing.assert_allclose(exact.peak, one.peak[0], rtol=1e-10)
    band = Band.of(varied_peaks(plain, APPROACH, contact, samples=60, **options).peak)  # type: ignore[arg-type]
    assert band.low < 0.95 * one.peak[0]
    assert band.high > 1.05 * one.peak[0]


@pytest.mark.parametrize("name", ["rr", "rmin", "rigid"])
def test_every_kind_of_robot_has_a_band(name: str, panda: Robot) -> None:
    if name == "rmin":
        model, approach = r_min()
    elif name == "rr":
        rr = load_robot("rr")
        model = impact_model(rr, drives=drives(rr, 1e3, 0.1))
        approach = Approach(np.radians([30.0, 40.0, 20.0, 30.0])[: rr.n], [1, 0, 0], 1.0)
    else:
        model, approach = impact_model(panda), APPROACH
    options = {"motors": Motors("free"), "horizon": SHORT}
    exact = varied_peaks(model, approach, loose(HEAD), tolerances=EXACT, samples=40, **options)  # type: ignore[arg-type]
    one = many_peaks(model, approach, loose(HEAD), approach.speed, **options)  # type: ignore[arg-type]
    np.testing.assert_allclose(exact.peak, one.peak[0], rtol=1e-10)


@pytest.mark.parametrize("kind", ["free", "stopping", "servo"])
def test_each_impact_is_that_of_a_robot_built_with_its_numbers(arm: ImpactModel, kind: str) -> None:
    motors, contact, wild = MOTORS[kind], loose(HEAD), Tolerances()
    found = varied_peaks(
        arm, APPROACH, contact, motors=motors, tolerances=wild, horizon=SHORT, samples=40
    )
    sampled = error_factors(wild, arm.robot.n, 40)
    # gravity's share in K0 stays with the links as they are
    still = replace(arm, gravity=(0.0, 0.0, 0.0))
    for s in (0, 17, 39):
        joints = tuple(
            replace(
                joint,
                inertia=Inertia(
                    k * joint.inertia.mass,
                    k * joint.inertia.first_moment,
                    k * joint.inertia.about_origin,
                ),
            )
            for k, joint in zip(sampled.links[s], arm.robot.joints, strict=True)
        )
        own = replace(
            arm.drives,
            rotors=arm.drives.rotors * ca.DM(sampled.rotors[s]),
            springs=arm.drives.springs * ca.DM(sampled.springs[s]),
            gains=arm.drives.gains * sampled.position_gains[s],
            damping_gains=arm.drives.damping_gains * sampled.damping_gains[s],
        )
        region = replace(
            contact.region,
            stiffness=contact.region.stiffness * sampled.body[s],
            damping=contact.region.damping * sampled.damping[s],
        )
        one = many_peaks(
            replace(still, robot=replace(arm.robot, joints=joints), drives=own),
            APPROACH,
            Contact(region, False, contact.hertz_stiffness * sampled.law[s]),
            0.5,
            motors=replace(motors, reaction_time=motors.reaction_time * sampled.reaction_time[s]),
            horizon=SHORT,
        )
        # steps are as fine as the stiffest of all samples needs
        assert found.peak[s] == pytest.approx(one.peak[0], rel=2e-3)
        assert found.first_contact[s] == pytest.approx(one.first_contact[0], rel=2e-3)


def test_a_band_is_always_the_same_and_wider_for_more_doubt(plain: ImpactModel) -> None:
    limits, ends = limits_of(HEAD.region, clamped=False), [Motors("free"), Motors("driven")]
    bands = [
        impact_band(
            plain, APPROACH, loose(HEAD), ends, limits, tolerances=t, horizon=0.04, samples=100
        )
        for t in (Tolerances(), Tolerances(), Tolerances(body=0.5), EXACT)
    ]
    assert bands[0] == bands[1]
    assert bands[2].peak.high > 1.05 * bands[0].peak.high
    assert bands[2].peak.low < bands[0].peak.low
    assert bands[3].peak.low == pytest.approx(bands[3].peak.high)
    assert bands[0].pressing is None
    assert bands[0].share.high == pytest.approx(bands[0].peak.high / 130)


def test_of_each_impact_the_worse_end_counts(plain: ImpactModel) -> None:
    limits, ends = limits_of(CHEST.region, clamped=True), [Motors("free"), Motors("driven")]
    both = impact_band(plain, APPROACH, CHEST, ends, limits, samples=40)
    for end in ends:
        alone = impact_band(plain, APPROACH, CHEST, [end], limits, samples=40)
        assert both.peak.high >= alone.peak.high
        assert both.share.low >= alone.share.low
    assert both.pressing is not None


@pytest.mark.slow
def test_chance_finds_the_same_band(plain: ImpactModel, monkeypatch: pytest.MonkeyPatch) -> None:
    """A thousand samples of the sequence beside three thousand random ones."""
    options = {"motors": Motors("driven"), "horizon": 0.03}
    ours = Band.of(varied_peaks(plain, APPROACH, loose(CHEST), **options).peak)  # type: ignore[arg-type]
    random = np.random.default_rng(0)
    monkeypatch.setattr(
        "softimpact.simulate.tolerances.normal_sequence",
        lambda samples, dimensions: random.normal(size=(samples, dimensions)),
    )
    theirs = Band.of(varied_peaks(plain, APPROACH, loose(CHEST), samples=3000, **options).peak)  # type: ignore[arg-type]
    assert ours.low == pytest.approx(theirs.low, rel=0.03)
    assert ours.high == pytest.approx(theirs.high, rel=0.03)


def test_the_sequence_is_normal_in_each_dimension_and_uncorrelated() -> None:
    found = normal_sequence(1000, 30)
    assert abs(found.mean(axis=0)).max() < 0.05
    assert abs(found.std(axis=0) - 1).max() < 0.05
    outside = (abs(found) > 1.959964).mean(axis=0)
    assert abs(outside - 0.05).max() < 0.02
    assert abs(np.corrcoef(found.T) - np.eye(30)).max() < 0.06


@pytest.mark.parametrize("field", [field.name for field in fields(Tolerances)])
@pytest.mark.parametrize("value", [-0.1, 3.0, float("nan"), float("inf")])
def test_impossible_tolerances_are_refused(field: str, value: float) -> None:
    with pytest.raises(InvalidValue, match=rf"tolerances\.{field}: must be from 0"):
        replace(EXACT, **{field: value})


def test_too_few_samples_hold_no_band(plain: ImpactModel) -> None:
    with pytest.raises(InvalidValue, match="samples: must be at least 40"):
        varied_peaks(plain, APPROACH, HEAD, motors=Motors("free"), samples=39)
