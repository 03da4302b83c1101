# SPDX-License-Identifier: BSD-3-Clause
"""Histories, peaks and their definitions, durations, the safe speed, and bad input."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from impact_cases import ALONG_Y, FREE_HEAD, HEAD, POSE

from softimpact.simulate import (
    Approach,
    Fidelity,
    ImpactHistory,
    PeakDefinition,
    SimulationFailed,
    largest_safe_speed,
    scaled_springs,
    simulate_impact,
)
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    InvalidValue,
    Motors,
    Robot,
    SingularDirection,
    SoftImpactError,
    UnknownName,
    WrongLength,
    drives,
    impact_model,
    load_robot,
)

AHEAD = Approach(POSE, np.array([0.0, 1.0, 0.0]), 1.0)


@pytest.fixture(scope="module")
def arm(panda: Robot) -> ImpactModel:
    return impact_model(panda, drives=drives(panda, 1e4))


@pytest.fixture(scope="module")
def two_peaks() -> ImpactHistory:
    """A light link bounces off the head before its motor arrives (MSM, RR in scenario a)."""
    return straight_rr(HEAD, None)


def straight_rr(contact: Contact, horizon: float | None) -> ImpactHistory:
    robot = load_robot("rr")
    model = impact_model(robot, "P", drives=drives(robot, computed_torque_gain=6050.0))
    approach = Approach(np.zeros(4), np.array([0.0, 1.0, 0.0]), 1.0, np.array([1.0, 0, 0, 0]))
    return simulate_impact(model, approach, contact, motors=Motors("held"), horizon=horizon)


def test_the_two_definitions_of_the_peak_part(two_peaks: ImpactHistory) -> None:
    first, highest = two_peaks.force_of("first_peak"), two_peaks.force_of("first_contact")
    assert first < 0.8 * highest
    assert two_peaks.time_of_first_peak is not None
    assert two_peaks.time_of_first_peak < two_peaks.time_of_first_contact_peak
    assert two_peaks.separation is not None
    assert two_peaks.time_of_first_contact_peak < two_peaks.separation < two_peaks.time[-1]
    with pytest.raises(UnknownName, match="first_contact, first_peak"):
        two_peaks.force_of("mean")  # type: ignore[arg-type]


def test_peaks_lie_on_the_curve(two_peaks: ImpactHistory) -> None:
    time, force = two_peaks.time, two_peaks.force
    assert len(time) >= 400
    assert time[0] == force[0] == 0
    assert np.all(np.diff(time) > 0)
    assert two_peaks.separation is not None
    assert two_peaks.time_of_first_peak is not None
    before = time < two_peaks.separation
    assert np.all(force[before][1:] > 0)
    assert force[~before][0] == 0
    for at, peak in (
        (two_peaks.time_of_first_peak, two_peaks.force_of("first_peak")),
        (two_peaks.time_of_first_contact_peak, two_peaks.first_contact),
    ):
        near = abs(time - at) < 1e-4
        around = np.polynomial.Polynomial.fit(time[near], force[near], 2)
        assert around.deriv().roots()[0] == pytest.approx(at, abs=5e-6)
        assert force[near].max() <= peak * (1 + 1e-9)
        assert force[near].max() == pytest.approx(peak, rel=2e-5)


def test_peaks_do_not_depend_on_the_time_grid(arm: ImpactModel) -> None:
    ended = simulate_impact(arm, AHEAD, FREE_HEAD, horizon=None)
    assert ended.separation is not None
    for duration in (0.0331, 0.071):
        other = simulate_impact(arm, AHEAD, FREE_HEAD, horizon=duration)
        assert other.time[-1] == pytest.approx(duration, rel=1e-12)
        assert other.first_contact == pytest.approx(ended.first_contact, rel=1e-8)
        assert other.time_of_first_peak == pytest.approx(ended.time_of_first_peak, rel=1e-6)
        assert other.separation == pytest.approx(ended.separation, rel=1e-8)


def test_a_short_simulation_says_what_it_has_seen(arm: ImpactModel) -> None:
    whole = simulate_impact(arm, AHEAD, FREE_HEAD, horizon=None)
    until = 1.1 * whole.time_of_first_contact_peak
    short = simulate_impact(arm, AHEAD, FREE_HEAD, horizon=until)
    assert short.separation is None
    assert short.first_contact == pytest.approx(whole.first_contact, rel=1e-8)
    assert whole.time_of_first_peak is not None
    shorter = simulate_impact(arm, AHEAD, FREE_HEAD, horizon=0.5 * whole.time_of_first_peak)
    assert shorter.first_peak is shorter.time_of_first_peak is None
    assert shorter.peak == shorter.first_contact == shorter.force[-1]
    with pytest.raises(InvalidValue, match="first_peak: does not exist: the force rises"):
        shorter.force_of("first_peak")


def test_a_second_rise_cut_short_counts_as_far_as_it_went() -> None:
    whole = straight_rr(FREE_HEAD, None)
    cut = straight_rr(FREE_HEAD, 0.97 * whole.time_of_first_contact_peak)
    assert cut.first_peak == pytest.approx(whole.first_peak, rel=1e-8)
    assert cut.peak == cut.first_contact == cut.force[-1]
    assert cut.first_peak is not None
    assert cut.first_peak < cut.first_contact < whole.first_contact


@pytest.mark.parametrize(
    "fidelity", ["one_mass", "linearised", pytest.param("full", marks=pytest.mark.slow)]
)
@pytest.mark.parametrize("limit", [20.0, 280.0])
def test_the_safe_speed_meets_the_limit(arm: ImpactModel, fidelity: Fidelity, limit: float) -> None:
    speed = largest_safe_speed(arm, AHEAD, HEAD, limit, fidelity)
    again = simulate_impact(arm, replace(AHEAD, speed=speed), HEAD, fidelity)
    assert again.first_contact == pytest.approx(limit, rel=1e-6)


@pytest.mark.parametrize("definition", ["first_contact", "first_peak"])
def test_the_safe_speed_does_not_depend_on_the_guess(
    arm: ImpactModel, definition: PeakDefinition
) -> None:
    speeds = [
        largest_safe_speed(
            arm, replace(AHEAD, speed=guess), HEAD, 130.0, "chain", definition, order=2
        )
        for guess in (1e-3, 0.2, 5.0)
    ]
    np.testing.assert_allclose(speeds, speeds[0], rtol=1e-6)


@pytest.mark.parametrize(
    "guess", [0.8, *(pytest.param(guess, marks=pytest.mark.slow) for guess in (0.3, 1.0, 3.0))]
)
def test_a_safe_first_peak_is_safe_at_all_lower_speeds(guess: float) -> None:
    """These peaks are one up to 0.9 m/s and part above, so that 390 N are met twice."""
    robot = load_robot("rr")
    model, straight = scaled_springs(impact_model(robot, "P"), 2.456), [1.0, 0.0, 0.0, 0.0]
    approach = Approach(np.zeros(4), ALONG_Y, guess, straight)
    found = largest_safe_speed(model, approach, HEAD, 390.0, definition="first_peak")

    def peak(speed: float) -> float:
        found = simulate_impact(model, replace(approach, speed=speed), HEAD)
        return found.force_of("first_peak")

    assert peak(found) == pytest.approx(390.0, rel=1e-7)
    assert max(peak(v) for v in np.linspace(0.1, 0.999, 12) * found) < 390.0
    assert peak(1.18) < 390.0 < peak(0.85)


def test_direction_and_link_velocity_are_scaled(arm: ImpactModel) -> None:
    plain = simulate_impact(arm, AHEAD, HEAD)
    longer = simulate_impact(arm, replace(AHEAD, direction=7 * AHEAD.direction), HEAD)
    assert longer.first_contact == pytest.approx(plain.first_contact, rel=1e-9)


NAN = float("nan")
BAD: list[tuple[dict[str, Any], type[SoftImpactError], str]] = [
    ({"speed": 0.0}, InvalidValue, "speed"),
    ({"speed": -1.0}, InvalidValue, "speed"),
    ({"speed": NAN}, InvalidValue, "speed"),
    ({"q": POSE[:6]}, WrongLength, "q: has 6 values, but 7"),
    ({"q": np.full(7, NAN)}, InvalidValue, "q: must"),
    ({"direction": np.zeros(3)}, InvalidValue, "direction"),
    ({"direction": np.array([NAN, 0, 1])}, InvalidValue, "direction"),
    ({"link_velocity": np.ones(3)}, WrongLength, "link_velocity"),
    ({"link_velocity": np.full(7, NAN)}, InvalidValue, "link_velocity: must hold finite"),
    ({"link_velocity": np.eye(7)[0]}, InvalidValue, "link_velocity: must move"),
]


@pytest.mark.parametrize(("change", "error", "message"), BAD)
@pytest.mark.parametrize("run", [simulate_impact, largest_safe_speed])
def test_bad_approaches_are_rejected(
    arm: ImpactModel,
    change: dict[str, Any],
    error: type[SoftImpactError],
    message: str,
    run: Callable[..., object],
) -> None:
    more = (100.0,) if run is largest_safe_speed else ()
    with pytest.raises(error, match=message):
        run(arm, replace(AHEAD, **change), HEAD, *more)


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({"fidelity": "exact"}, UnknownName),
        ({"fidelity": "chain", "order": 0}, InvalidValue),
        ({"fidelity": "chain", "order": 15}, InvalidValue),
        ({"fidelity": "chain", "end": "fixed"}, UnknownName),
        ({"horizon": 0.0}, InvalidValue),
        ({"horizon": -0.1}, InvalidValue),
        ({"horizon": np.inf}, InvalidValue),
        ({"horizon": NAN}, InvalidValue),
        ({"motors": Motors("asleep")}, UnknownName),  # type: ignore[arg-type]
        ({"motors": Motors("driven", -1e-9)}, InvalidValue),
        ({"motors": Motors("driven", NAN)}, InvalidValue),
        ({"motors": Motors("driven", reaction="run")}, UnknownName),  # type: ignore[arg-type]
        ({"motors": Motors("driven", stopping_time=0.0)}, InvalidValue),
        ({"motors": Motors("driven", stopping_time=np.inf)}, InvalidValue),
        ({"tolerance": 0.0}, InvalidValue),
        ({"tolerance": NAN}, InvalidValue),
    ],
)
def test_bad_options_are_rejected(
    arm: ImpactModel, options: dict[str, Any], error: type[SoftImpactError]
) -> None:
    with pytest.raises(error):
        simulate_impact(arm, AHEAD, HEAD, **options)


def test_an_impact_that_never_peaks_is_followed_for_two_seconds(panda: Robot) -> None:
    heavy = impact_model(panda, drives=drives(panda, rotor_inertia=1e9))
    found = simulate_impact(heavy, AHEAD, HEAD, horizon=None)
    assert found.first_peak is found.separation is None
    assert found.time[-1] == pytest.approx(2.0)
    assert found.peak == found.force[-1]
    with pytest.raises(InvalidValue, match=r"first_peak: does not exist"):
        largest_safe_speed(heavy, AHEAD, HEAD, 100.0, definition="first_peak")


def test_lists_will_do(arm: ImpactModel) -> None:
    listed = Approach(AHEAD.q.tolist(), AHEAD.direction.tolist(), AHEAD.speed)
    ours, theirs = simulate_impact(arm, listed, HEAD), simulate_impact(arm, AHEAD, HEAD)
    assert ours.first_contact == theirs.first_contact


@pytest.mark.parametrize("limit", [0.0, -5.0, NAN])
def test_a_limit_must_be_positive(arm: ImpactModel, limit: float) -> None:
    with pytest.raises(InvalidValue, match="limit"):
        largest_safe_speed(arm, AHEAD, HEAD, limit)


def test_a_direction_out_of_reach_is_singular() -> None:
    model = impact_model(load_robot("rr"), "P")
    with pytest.raises(SingularDirection):
        simulate_impact(model, Approach(np.zeros(4), np.array([0.0, 0.0, 1.0]), 1.0), HEAD)


def test_an_integrator_that_gives_up_is_reported(arm: ImpactModel) -> None:
    absurd = replace(HEAD, hertz_stiffness=1e300)
    with pytest.raises(SimulationFailed, match=r"CV_.*check the stiffnesses"):
        simulate_impact(arm, AHEAD, absurd)


@pytest.mark.parametrize("value", [-1.0, 0.0, NAN, float("inf")])
@pytest.mark.parametrize("field", ["hertz_stiffness", "stiffness", "effective_mass", "damping"])
def test_an_impossible_body_is_rejected(arm: ImpactModel, field: str, value: float) -> None:
    options: dict[str, Any] = {field: value}
    if field == "hertz_stiffness":
        contact = replace(HEAD, **options)
    else:
        contact = replace(HEAD, region=replace(HEAD.region, **options))
    if field == "damping" and value == 0:
        assert simulate_impact(arm, AHEAD, contact).first_contact > 0
        return
    with pytest.raises(InvalidValue, match=field):
        simulate_impact(arm, AHEAD, contact)
