# SPDX-License-Identifier: BSD-3-Clause
"""The limits that protect people, against a second transcription of ISO/TS 15066, Annex A.

Written down apart from ``symbolic/body/data``, region by region, in the standard's own units and
with the factor between quasi-static and transient limits that it gives. Do not make one from the
other: a slip in either must show.
"""

from __future__ import annotations

import re

import pytest

from softimpact.symbolic import AREAS, REGIONS, BodyRegion, UnknownName, body_region
from softimpact.symbolic.body.verdict import QUASI_STATIC_FROM

# region: quasi-static force in N, spring in N/mm, mass in kg; then each area's pressure in N/cm²
PERMITTED = """
neck:       150 N,  50 N/mm,  1.2 kg; neck_muscle 140, seventh_neck_muscle 210
back:       210 N,  35 N/mm,   40 kg; shoulder_joint 160, fifth_lumbar_vertebra 210
chest:      140 N,  25 N/mm,   40 kg; sternum 120, pectoral_muscle 170
abdomen:    110 N,  10 N/mm,   40 kg; abdominal_muscle 140
pelvis:     180 N,  25 N/mm,   40 kg; pelvic_bone 210
upper_arm:  150 N,  30 N/mm,    3 kg; deltoid_muscle 190, humerus 220
lower_arm:  160 N,  40 N/mm,    2 kg; radial_bone 190, forearm_muscle 180, arm_nerve 180
hand:       140 N,  75 N/mm,  0.6 kg; forefinger_pad_dominant 300, forefinger_pad_non_dominant 270,
            forefinger_end_joint_dominant 280, forefinger_end_joint_non_dominant 220,
            thenar_eminence 200, palm_dominant 260, palm_non_dominant 260,
            back_of_hand_dominant 200, back_of_hand_non_dominant 190
thigh:      220 N,  50 N/mm,   75 kg; thigh_muscle 250, kneecap 220
lower_leg:  130 N,  60 N/mm,   75 kg; middle_of_shin 220, calf_muscle 210
"""
FORBIDDEN = """
head:       130 N, 150 N/mm,  4.4 kg; middle_of_forehead 130, temple 110
face:        65 N,  75 N/mm,  4.4 kg; masticatory_muscle 110
"""
TRANSIENT = 2
"""Factor from quasi-static to transient limits, of force and of pressure."""

ENERGY = {  # J
    "face": 0.11,
    "hand": 0.49,
    "lower_arm": 1.3,
    "upper_arm": 1.5,
    "chest": 1.6,
    "abdomen": 2.4,
    "back": 2.5,
}

Numbers = tuple[float, float, float]
Table = dict[str, tuple[Numbers, dict[str, float]]]


def transcribed(text: str) -> Table:
    """Return force, spring and mass of each region, and the pressures of its areas."""
    table: Table = {}
    for entry in re.split(r"\n(?=\w)", text.strip()):
        name, rest = entry.split(":")
        numbers, areas = rest.split(";")
        force, spring, mass = (float(part.split()[0]) for part in numbers.split(","))
        pressures = (area.split() for area in areas.split(","))
        table[name] = (force, spring, mass), {area: float(value) for area, value in pressures}
    return table


TABLE = transcribed(PERMITTED) | transcribed(FORBIDDEN)


def test_every_region_and_area_is_there_and_no_other() -> None:
    assert set(REGIONS) == set(TABLE)
    assert set(AREAS) == {area for _, areas in TABLE.values() for area in areas}
    assert len(REGIONS) == 12
    assert len(AREAS) == 29


def has_numbers(body: BodyRegion, numbers: Numbers, permitted: bool) -> None:
    force, spring, mass = numbers
    assert body.quasi_static_limit == force
    assert body.transient_limit == (TRANSIENT * force if permitted else None)
    assert body.force_limit == (TRANSIENT * force if permitted else force)
    assert body.stiffness == spring * 1000
    assert body.effective_mass == mass
    assert body.permitted is permitted
    assert body.damping == 10
    assert body.skin is None
    assert body.plate_mass == 0


def has_pressure(body: BodyRegion, pressure: float, permitted: bool) -> None:
    assert body.quasi_static_pressure == pressure * 1e4
    assert body.transient_pressure == (TRANSIENT * pressure * 1e4 if permitted else None)


@pytest.mark.parametrize("name", TABLE)
def test_a_region_has_the_standards_numbers(name: str) -> None:
    numbers, areas = TABLE[name]
    permitted = name not in transcribed(FORBIDDEN)
    for found in (name, *areas):
        body = body_region(found)
        assert body.name == found
        assert body.region == name
        has_numbers(body, numbers, permitted)
        assert body.energy_limit == ENERGY.get(name)
        has_pressure(body, areas.get(found, min(areas.values())), permitted)


def test_contact_with_skull_forehead_and_face_is_not_permitted() -> None:
    never = {name for name, body in (AREAS | REGIONS).items() if not body.permitted}
    assert never == {"head", "face", "middle_of_forehead", "temple", "masticatory_muscle"}


@pytest.mark.parametrize("name", TABLE)
def test_energies_are_those_of_the_force_limits(name: str) -> None:
    """F²/2k at the transient limit, on which public codes agree to 6 % and rounding."""
    body = body_region(name)
    if body.energy_limit is not None:
        force = 2 * body.quasi_static_limit
        assert body.energy_limit == pytest.approx(force**2 / (2 * body.stiffness), rel=0.07)


def test_titles_are_as_in_the_standard() -> None:
    assert body_region("head").title == "Skull and forehead"
    assert body_region("upper_arm").title == "Upper arms and elbow joints"
    assert body_region("palm_non_dominant").title == "Palm (non-dominant)"


@pytest.mark.parametrize(
    ("typed", "nearest"),
    [("sternun", "sternum"), ("palm", "palm_dominant"), ("knee_cap", "kneecap"), ("hed", "head")],
)
def test_unknown_names_show_the_nearest(typed: str, nearest: str) -> None:
    with pytest.raises(UnknownName) as error:
        body_region(typed)
    assert nearest in error.value.known[:3]


def test_unknown_names_that_are_near_nothing_show_the_regions() -> None:
    with pytest.raises(UnknownName, match=r"unknown body region 'nose'; known: head, face") as e:
        body_region("nose")
    assert e.value.known == tuple(REGIONS)


def test_the_transient_limit_counts_for_half_a_second() -> None:
    """ISO/TS 15066: contact is transient for less than 0.5 s; pressing is quasi-static after it."""
    assert QUASI_STATIC_FROM == 0.5
