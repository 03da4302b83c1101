# SPDX-License-Identifier: BSD-3-Clause
"""Own bodies and covers by file, and measuring devices."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from softimpact.symbolic import Contact, Curve, InvalidValue, PowerLaw, body_region
from softimpact.symbolic.body.bodies import BODIES
from softimpact.symbolic.body.body_file import load_body, load_cover
from softimpact.symbolic.body.devices import DEVICES, SPRINGS, measuring_device
from softimpact.symbolic.body.laws import Series
from softimpact.symbolic.body.pads import PADS


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "own.toml"


def body(file: Path, text: str) -> object:
    file.write_text(text, encoding="utf-8")
    return load_body(file)


def test_there_is_a_device_for_every_spring_under_every_pad() -> None:
    assert [k / 1e3 for k in SPRINGS] == [10, 25, 30, 35, 40, 50, 60, 75]
    assert len(DEVICES) == 24
    device = body_region("device_75_sh30")
    assert (device.stiffness, device.damping, device.skin) == (75e3, 0, PADS["sh30"].law)
    assert device.plate_mass == 0
    assert Contact(device).law == PADS["sh30"].law


def test_every_body_can_be_hit() -> None:
    for known in BODIES.values():
        Contact(known).check()


@pytest.mark.parametrize("permitted", ["", "[limits]\npermitted = false"])
def test_a_body_of_a_region_that_is_never_permitted_is_not_either(
    file: Path, permitted: str
) -> None:
    found = body(file, f'name = "helmet"\nregion = "head"\n{permitted}')
    assert not found.permitted  # type: ignore[attr-defined]


def test_a_file_may_say_that_contact_is_permitted_where_it_is(file: Path) -> None:
    assert body(file, 'name = "a"\nregion = "chest"\n[limits]\npermitted = true') is not None


def test_a_device_that_stands_for_a_region_has_its_limits_and_mass() -> None:
    hand = body_region("hand")
    device = measuring_device(75e3, PADS["sh70"], 0.3, hand)
    assert (device.force_limit, device.effective_mass, device.plate_mass) == (280, 0.6, 0.3)
    assert device.transient_pressure == hand.transient_pressure


def test_a_file_changes_what_it_names_and_keeps_the_regions_rest(file: Path) -> None:
    found = body(
        file,
        """
        name = "our rig"
        region = "palm_dominant"
        plate_mass = 0.4
        damping = 0.0
        pad = "sh30"
        [limits]
        force_transient = 200.0
        pressure_quasi_static = 100
        """,
    )
    palm = body_region("palm_dominant")
    assert found.name == found.title == "our rig"  # type: ignore[attr-defined]
    assert vars(found) == vars(palm) | {
        "name": "our rig",
        "title": "our rig",
        "plate_mass": 0.4,
        "damping": 0.0,
        "skin": PADS["sh30"].law,
        "transient_limit": 200.0,
        "quasi_static_pressure": 1e6,
    }


def test_a_body_without_a_region_stands_alone(file: Path) -> None:
    text = 'name = "dummy"\nstiffness = 5e4\neffective_mass = 12\n[skin]\nkind = "power"\n'
    found = body(file, text + "stiffness = 1e7\n")
    assert (found.stiffness, found.effective_mass) == (5e4, 12)  # type: ignore[attr-defined]
    assert found.skin == PowerLaw(1e7)  # type: ignore[attr-defined]
    assert found.quasi_static_limit == math.inf  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('region = "chest"', "name: is missing"),
        ('name = "a"', "stiffness: missing"),
        ('name = "a"\nstiffness = 1e4', "effective_mass: missing"),
        ('name = "a"\nregion = "chest"\nstiffness = -1.0', "stiffness: .*greater than 0"),
        ('name = "a"\nregion = "chest"\nstiffness = nan', "stiffness: .*finite"),
        ('name = "a"\nregion = "chest"\nplate_mass = -1', "plate_mass: .*greater than or equal"),
        ('name = "a"\nregion = "chset"', "region: unknown body region 'chset'; known: chest"),
        ('name = "a"\nregion = "chest"\nstifness = 1e4', "stifness: Extra inputs"),
        ('name = "a"\nregion = "chest"\npad = "sh50"', "pad: unknown pad 'sh50'; known: sh10"),
        ('name = "a"\nregion = "chest"\nskin = 5', r"skin: must be a table, \[skin\]"),
        (
            'name = "a"\nregion = "chest"\npad = "sh70"\n[skin]\nkind = "power"\nstiffness = 1e6',
            "skin: excludes 'pad'",
        ),
        (
            'name = "a"\nregion = "head"\n[limits]\npermitted = true',
            "limits.permitted: contact with 'head' is never permitted",
        ),
        ('name = "a"\nregion = "chest"\n[limits]\nforce_transient = 0', "limits.force_transient"),
        ("name = ", "not valid TOML"),
    ],
)
def test_bodies_that_cannot_be_are_refused_by_file_and_field(
    file: Path, text: str, message: str
) -> None:
    with pytest.raises(InvalidValue, match=f"own.toml: {message}"):
        body(file, text)


def cover(file: Path, text: str) -> object:
    file.write_text(text, encoding="utf-8")
    return load_cover(file)


def test_a_cover_is_a_law_or_several(file: Path) -> None:
    power = 'name = "gel"\n[law]\nkind = "power"\nstiffness = 2e6\n'
    assert cover(file, power) == PowerLaw(2e6)
    curve = '\ufeff[[law]]\nkind = "curve"\ndepths = [0, 2e-3, 5e-3]\nforces = [0, 20, 300]\n'
    assert cover(file, curve) == Curve([0, 2e-3, 5e-3], [0, 20, 300])
    both = cover(file, curve + '[[law]]\nkind = "power"\nstiffness = 2e6\nexponent = 1\n')
    assert isinstance(both, Series)
    assert set(both.laws) == {PowerLaw(2e6, 1), Curve([0, 2e-3, 5e-3], [0, 20, 300])}
    assert load_cover("sh10") == PADS["sh10"].law


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('name = "gel"', "law: is missing"),
        ("law = []", r"law: must be a table, \[law\], or several"),
        ("law = 3", r"law: must be a table"),
        ("[law]\nstiffness = 1e6", "law.kind: must be one of curve, .*power.*, not None"),
        ('[law]\nkind = "spring"', "law.kind: must be one of curve, .*power.*, not 'spring'"),
        ('[law]\nkind = "power"', "law.stiffness: missing; 'power' needs it"),
        ('[law]\nkind = "power"\nstiffness = -2e6', "law.stiffness: must be finite and greater"),
        ('[law]\nkind = "power"\nstiffness = "2e6"', "law.stiffness: must hold numbers"),
        ('[law]\nkind = "power"\nstiffness = [1, 2]', "law.power: one of its fields"),
        ('[law]\nkind = "power"\nstiffness = true', "law.stiffness: must hold numbers"),
        ('[law]\nkind = "power"\nstiffness = 1\nk = 2', "law.k: unknown; 'power' has stiffness"),
        ('[law]\nkind = "curve"\ndepths = 1\nforces = 2', "law.curve: one of its fields"),
        (
            '[[law]]\nkind = "curve"\ndepths = [0, 1e-3]\nforces = [0, 0]',
            r"law\[0\].forces: must rise throughout",
        ),
    ],
)
def test_covers_without_a_law_are_refused(file: Path, text: str, message: str) -> None:
    with pytest.raises(InvalidValue, match=f"own.toml: {message}"):
        cover(file, text)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InvalidValue, match=r"absent.toml: no such file"):
        load_body(tmp_path / "absent.toml")
    with pytest.raises(InvalidValue, match=r"absent.toml: no such file, nor a pad \(sh10"):
        load_cover(tmp_path / "absent.toml")
    with pytest.raises(InvalidValue, match="cannot be read"):
        load_cover(tmp_path)
