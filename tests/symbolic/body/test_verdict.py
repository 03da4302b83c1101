# SPDX-License-Identifier: BSD-3-Clause
"""Verdicts: which limit binds, and what is never permitted."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from softimpact.symbolic import (
    AREAS,
    REGIONS,
    Edge,
    Flat,
    InvalidValue,
    Sphere,
    body_region,
    judge,
    limits_of,
)

BODIES = st.sampled_from(list((REGIONS | AREAS).values()))
SHAPES = st.sampled_from([None, Sphere(5e-3), Edge(1e-2, 0.1), Flat(2e-3, 5e-3)])


def test_a_clamped_chest_is_judged_twice() -> None:
    limits = limits_of(body_region("chest"), clamped=True)
    assert (limits.transient.force, limits.transient.quantity) == (280, "force")
    assert limits.quasi_static is not None
    assert (limits.quasi_static.force, limits.quasi_static.quantity) == (140, "force")
    kept = judge(limits, 200, 100)
    assert (kept.ruling, kept.binding) == ("kept", "transient force")
    assert kept.share == pytest.approx(200 / 280)
    pressed = judge(limits, 106, 218)  # findings: an impedance-controlled arm that goes on pressing
    assert (pressed.ruling, pressed.binding) == ("exceeded", "quasi-static force")
    assert pressed.share == pytest.approx(218 / 140)


def test_a_free_body_is_never_pressed() -> None:
    limits = limits_of(body_region("chest"), clamped=False)
    assert limits.quasi_static is None
    assert judge(limits, 279).ruling == "kept"
    assert judge(limits, 281).ruling == "exceeded"


def test_a_limit_may_be_reached_but_not_passed() -> None:
    limits = limits_of(body_region("pelvis"), clamped=True)
    assert judge(limits, 360, 180).ruling == "kept"
    assert judge(limits, math.nextafter(360, math.inf), 180).ruling == "exceeded"
    assert judge(limits, 360, math.nextafter(180, math.inf)).ruling == "exceeded"


def test_a_clamped_body_needs_what_presses_later() -> None:
    with pytest.raises(InvalidValue, match="pressing"):
        judge(limits_of(body_region("chest"), clamped=True), 100)


@pytest.mark.parametrize("name", ["head", "face", "temple", "masticatory_muscle"])
def test_contact_with_the_head_is_not_permitted_however_soft(name: str) -> None:
    limits = limits_of(body_region(name), clamped=True)
    assert judge(limits, 1e-3, 0.0).ruling == "not permitted"
    assert limits.transient.force == limits.quasi_static.force  # type: ignore[union-attr]


def test_the_hands_energy_binds_before_its_force() -> None:
    """√(2 · 75 N/mm · 0.49 J) = 271 N, below 280 N."""
    limits = limits_of(body_region("hand"), clamped=True)
    assert limits.transient.quantity == "energy"
    assert limits.transient.force == pytest.approx(math.sqrt(2 * 75e3 * 0.49))
    assert judge(limits, 275, 0).binding == "transient energy"


def test_a_sharp_tool_is_judged_by_pressure() -> None:
    sternum, tool = body_region("sternum"), Sphere(2e-3)
    limits = limits_of(sternum, clamped=True, shape=tool)
    assert limits.transient.quantity == "pressure"
    assert tool.pressure(limits.transient.force) == pytest.approx(240e4, rel=1e-6)
    assert limits.quasi_static is not None
    assert tool.pressure(limits.quasi_static.force) == pytest.approx(120e4, rel=1e-6)
    blunt = limits_of(sternum, clamped=True, shape=Sphere(10.0))
    assert blunt.transient.quantity == "force"


@given(BODIES, st.booleans(), SHAPES, st.floats(1, 500), st.floats(1, 500))
def test_more_force_is_never_judged_milder(
    body: object, clamped: bool, shape: object, peak: float, pressing: float
) -> None:
    limits = limits_of(body, clamped, shape)  # type: ignore[arg-type]
    verdict, harder = judge(limits, peak, pressing), judge(limits, 1.1 * peak, 1.1 * pressing)
    assert harder.share > verdict.share
    assert verdict.ruling != "exceeded" or harder.ruling == "exceeded"


@given(BODIES, st.booleans(), SHAPES)
def test_knowing_more_only_lowers_limits(body: object, clamped: bool, shape: object) -> None:
    bare = limits_of(body, clamped)  # type: ignore[arg-type]
    shaped = limits_of(body, clamped, shape)  # type: ignore[arg-type]
    assert shaped.transient.force <= bare.transient.force <= body.force_limit  # type: ignore[attr-defined]
    if shaped.quasi_static is not None and bare.quasi_static is not None:
        assert shaped.quasi_static.force <= bare.quasi_static.force


def test_what_has_no_limit_is_not_called_safe() -> None:
    limits = limits_of(body_region("device_75_sh70"), clamped=True)
    assert judge(limits, 100, 50).ruling == "no limit"
    only_force = replace(body_region("device_75_sh70"), quasi_static_limit=140.0)
    assert judge(limits_of(only_force, clamped=True), 100, 50).ruling == "kept"


def test_a_region_may_lack_one_limit_of_pressure() -> None:
    """The quasi-static one holds for the transient, too; where neither is stated, none counts."""
    sharp, hand = Sphere(1e-3), replace(body_region("hand"), energy_limit=None)
    both = limits_of(hand, True, sharp)
    assert both.quasi_static is not None
    assert (both.transient.quantity, both.quasi_static.quantity) == ("pressure", "pressure")
    assert both.transient.force > both.quasi_static.force
    no_transient = limits_of(replace(hand, transient_pressure=None), True, sharp)
    assert no_transient.transient == both.quasi_static
    no_pressing = limits_of(replace(hand, quasi_static_pressure=None), True, sharp)
    assert no_pressing.transient == both.transient
    assert no_pressing.quasi_static is not None
    assert no_pressing.quasi_static.quantity == "force"
    none = replace(hand, transient_pressure=None, quasi_static_pressure=None)
    assert limits_of(none, True, sharp).transient.quantity == "force"
