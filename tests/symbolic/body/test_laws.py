# SPDX-License-Identifier: BSD-3-Clause
"""Laws of contact: what every law keeps, and series of them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq
from symbol_kinds import KINDS

from softimpact.symbolic import Contact, Curve, InvalidValue, Law, Matrix, PowerLaw, body_region
from softimpact.symbolic import in_series as series
from softimpact.symbolic.body.laws import Series
from softimpact.symbolic.body.laws.law import form_of, numbers_of, with_numbers
from softimpact.symbolic.body.laws.series import points_of
from softimpact.symbolic.robot.rigid import Array

FOAM = Curve([0, 2e-3, 5e-3, 8e-3], [0, 20, 120, 600])
LAWS: dict[str, Law] = {
    "hertz": PowerLaw(1.9e7),
    "linear": PowerLaw(3e5, 1.0),
    "curve": FOAM,
    "two powers": series(PowerLaw(1.9e7), PowerLaw(3e5, 1.0)),
    "foam on skin": series(FOAM, PowerLaw(1.9e7)),
    "three": series(FOAM, PowerLaw(1.9e7), PowerLaw(1e9, 2.0)),
}
EVERY = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)


def force(law: Law, depth: ArrayLike) -> Array:
    return np.array(law.force(ca.DM(np.atleast_1d(depth)))).ravel()


@st.composite
def curves(draw: st.DrawFn) -> Curve:
    steps = st.lists(st.floats(1e-5, 5e-3), min_size=1, max_size=8)
    depths = draw(steps)
    forces = draw(st.lists(st.floats(0.1, 500), min_size=len(depths), max_size=len(depths)))
    return Curve([0, *np.cumsum(depths)], [0, *np.cumsum(forces)])


@EVERY
def test_a_law_is_zero_before_touch_and_rises_after(law: Law) -> None:
    assert (force(law, [-1.0, -1e-9, 0.0]) == 0).all()
    depths = np.geomspace(1e-6, 2e-2, 500)
    assert (np.diff(force(law, depths)) > 0).all()


@EVERY
def test_a_law_is_an_expression_of_any_kind(law: Law) -> None:
    depths = np.array([-1e-3, 1e-4, 3e-3, 9e-3])
    for kind in KINDS:
        x = kind.sym("x", len(depths))
        found = ca.Function("f", [x], [law.force(x)])(depths)
        np.testing.assert_allclose(np.array(found).ravel(), force(law, depths), rtol=1e-12)


@EVERY
def test_numbers_are_those_of_the_expression(law: Law) -> None:
    points, depths = points_of(law), np.array([0.0, 1e-5, 1e-3, 2e-3, 4e-3, 8e-3, 8.1e-3])
    found, slope = points.evaluated(depths)
    np.testing.assert_allclose(found, force(law, depths), rtol=1e-4, atol=1e-6)
    for depth, force_there, slope_there in zip(depths, found, slope, strict=True):
        one = points.at(depth)
        assert one[0] == pytest.approx(force_there, rel=1e-12)
        if depth not in points.depth[1:]:  # at a corner either slope will do
            assert one[1] == pytest.approx(slope_there, rel=1e-12)
    inside = np.array([1e-5, 1e-3, 4e-3])
    steps = 1e-6 * inside
    rise = (points.evaluated(inside + steps)[0] - points.evaluated(inside - steps)[0]) / (2 * steps)
    np.testing.assert_allclose(points.evaluated(inside)[1], rise, rtol=1e-5)
    assert (slope[1:] > 0).all()


@EVERY
def test_a_law_has_a_slope_without_jumps(law: Law) -> None:
    """Also at the points of a curve, where two cubics meet."""
    x = ca.SX.sym("x")
    slope = ca.Function("s", [x], [ca.jacobian(law.force(x), x)])
    for depth in (1e-4, 2e-3, 5e-3, 6.5e-3):
        step = 1e-9
        difference = (force(law, depth + step) - force(law, depth - step)) / (2 * step)
        assert float(slope(depth)) == pytest.approx(float(difference[0]), rel=1e-4)
    assert float(slope(-1e-3)) == 0.0
    assert np.isfinite(float(slope(0.0)))


@given(curves())
def test_a_curve_goes_through_its_points_and_never_falls(curve: Curve) -> None:
    np.testing.assert_allclose(force(curve, curve.depths), curve.forces, rtol=1e-9)
    inside = np.linspace(0, curve.depths[-1] * 1.1, 400)
    assert (np.diff(force(curve, inside)) >= -1e-9 * curve.reach).all()


@given(curves())
@example(FOAM)
@example(Curve([0, 1, 2, 3], [0, 0.1, 2, 2.1]))  # whose ends' three-point formulas would fall
def test_a_curve_agrees_with_scipy(curve: Curve) -> None:
    depths = np.linspace(0, curve.depths[-1], 101)
    theirs = PchipInterpolator(curve.depths, curve.forces)(depths)
    np.testing.assert_allclose(force(curve, depths), theirs, rtol=1e-9, atol=1e-9)


def test_beyond_its_points_a_curve_is_as_good_as_solid() -> None:
    """Nothing is known there: foam that is squeezed flat does not help any more."""
    assert FOAM.reach == 600
    assert force(FOAM, 8.1e-3) > 1e4
    skin = PowerLaw(1.9e7)
    hard = force(skin, 1.5e-3) - 600
    covered = force(series(FOAM, skin), 8e-3 + 1.5e-3) - 600
    assert covered == pytest.approx(hard, rel=0.02)


def test_beyond_its_points_a_curve_is_no_softer_than_at_its_end() -> None:
    rock = Curve((0, 1e-5, 2e-5), (0, 10, 1e4))  # 1e9 N/m at its end
    assert force(rock, 2.1e-5) - 1e4 >= 1e-6 * (1e4 - 10) / 1e-5
    assert force(FOAM, 8.1e-3) - force(FOAM, 8e-3) == pytest.approx(1e4)  # 1e8 N/m, as if solid


def test_power_laws_of_one_exponent_make_another() -> None:
    law = series(PowerLaw(1.9e7), PowerLaw(2e6), PowerLaw(5e6))
    assert isinstance(law, PowerLaw)
    assert law.exponent == 1.5
    soft = sum(k ** (-2 / 3) for k in (1.9e7, 2e6, 5e6))
    assert law.stiffness == pytest.approx(soft**-1.5)
    halves = series(PowerLaw(2e5, 1.0), PowerLaw(2e5, 1.0))
    assert isinstance(halves, PowerLaw)
    assert halves.stiffness == pytest.approx(1e5)


def exact_series(laws: tuple[Law, ...], depth: float) -> float:
    """Return the force at a depth, by bisection over the force and in each law."""

    def total(f: float) -> float:
        parts = [brentq(lambda x, law=law: force(law, x)[0] - f, 0, 10, xtol=1e-18) for law in laws]
        return float(sum(parts) - depth)

    return float(brentq(total, 1e-9, 1e5, rtol=1e-13))


@pytest.mark.parametrize("name", ["two powers", "foam on skin", "three"])
def test_a_series_agrees_with_bisection(name: str) -> None:
    law = LAWS[name]
    assert isinstance(law, Series)
    for depth in np.geomspace(1e-5, 9e-3, 12):
        expected = exact_series(law.laws, depth)
        assert force(law, depth)[0] == pytest.approx(expected, rel=1e-4)


@pytest.mark.slow
@settings(max_examples=15)
@given(curves(), st.floats(1e4, 1e9), st.sampled_from([1.0, 1.5, 2.0]))
def test_a_series_is_softer_than_each_part(curve: Curve, stiffness: float, exponent: float) -> None:
    skin = PowerLaw(stiffness, exponent)
    depths = np.geomspace(1e-5, 1e-2, 20)
    both = force(series(curve, skin), depths)
    assert (both <= 1.0001 * np.minimum(force(curve, depths), force(skin, depths)) + 1e-3).all()
    assert (np.diff(both) > 0).all()


def test_a_series_rises_from_first_touch_on_however_steep_its_laws() -> None:
    """Below the least force of its shape, too, where a cubic with the exact slope would fall."""
    law = series(PowerLaw(1e20, 6.0), FOAM)
    points = points_of(law)
    assert (np.diff(force(law, np.linspace(0, points.depth[1], 50))) > 0).all()


@pytest.mark.parametrize("name", ["two powers", "foam on skin", "three"])
def test_a_series_has_few_points_and_one_slope_at_each(name: str) -> None:
    """Corners are a curve's last point, and what the bisection leaves of a slope."""
    points = points_of(LAWS[name])
    assert len(points.depth) < 200
    jumps = np.abs(points.slope_after[1:-1] / points.slope_before[1:-1] - 1) > 1e-4
    assert (np.isin(points.forces[1:-1][jumps], FOAM.forces)).all()


def test_the_order_of_a_series_does_not_matter() -> None:
    skin, foam = PowerLaw(1.9e7), FOAM
    nested = series(series(skin, foam), PowerLaw(2e6))
    assert force(nested, 4e-3) == pytest.approx(force(series(PowerLaw(2e6), skin, foam), 4e-3))
    assert nested.reach == 600
    assert series(skin) == skin
    with pytest.raises(InvalidValue, match="at least one law"):
        series()


def test_a_law_that_never_gets_stiff_has_no_series() -> None:
    @dataclass(frozen=True)
    class Soft(Law):
        def force(self, depth: Matrix) -> Matrix:
            return ca.fmax(depth, 0)

    with pytest.raises(InvalidValue, match="less than 200000 N at a depth of 10 m"):
        series(Soft(), FOAM).force(1e-3)


def test_a_contact_is_cover_and_skin_in_series() -> None:
    chest = body_region("chest")
    bare, padded = Contact(chest), Contact(chest, cover=PowerLaw(2e6))
    assert bare.law == PowerLaw(1.9e7)
    assert padded.law == series(PowerLaw(1.9e7), PowerLaw(2e6))
    assert padded.series_stiffness == pytest.approx(padded.law.stiffness)  # type: ignore[attr-defined]
    assert padded.force(1e-3) < bare.force(1e-3)
    with pytest.raises(InvalidValue, match="Hertz"):
        _ = Contact(chest, cover=FOAM).series_stiffness
    with pytest.raises(InvalidValue, match="plate_mass"):
        _ = Contact(replace(chest, plate_mass=0.1)).series_stiffness


def test_laws_that_differ_in_numbers_alone_share_a_form() -> None:
    assert form_of(PowerLaw(1.9e7)) == form_of(PowerLaw(2e6))
    assert form_of(PowerLaw(1.9e7)) != form_of(PowerLaw(1.9e7, 2.0))
    assert form_of(FOAM) == FOAM
    law = PowerLaw(1.9e7)
    assert with_numbers(form_of(law), numbers_of(law)) == law


@pytest.mark.parametrize(
    ("depths", "forces", "reason"),
    [
        ([0, 1e-3], [0, 1, 2], "as many values"),
        ([0], [0], "at least two"),
        ([1e-3, 2e-3], [0, 1], "depths: must start at 0"),
        ([0, 1e-3], [1, 2], "forces: must start at 0"),
        ([0, 1e-3, 1e-3], [0, 1, 2], "depths: must rise"),
        ([0, 1e-3, 2e-3], [0, 2, 1], "forces: must rise"),
        ([0, float("nan")], [0, 1], "depths: must hold finite"),
    ],
)
def test_points_that_are_no_law_are_refused(
    depths: list[float], forces: list[float], reason: str
) -> None:
    with pytest.raises(InvalidValue, match=reason):
        Curve(depths, forces)


@pytest.mark.parametrize(
    ("law", "field"),
    [
        (PowerLaw(-1.0), "stiffness"),
        (PowerLaw(float("inf")), "stiffness"),
        (PowerLaw(1e6, 0.5), "exponent"),
        (PowerLaw(1e6, float("nan")), "exponent"),
    ],
)
def test_impossible_power_laws_are_refused(law: Law, field: str) -> None:
    with pytest.raises(InvalidValue, match=field):
        law.check()
    with pytest.raises(InvalidValue, match=rf"cover\.{field}"):
        Contact(body_region("chest"), cover=law).check()


def test_anything_above_nothing_is_a_stiffness() -> None:
    for law in (PowerLaw(1e-6), PowerLaw(1e12), PowerLaw(1e6, 1.0)):
        law.check()


def test_a_new_law_is_a_class_of_its_own() -> None:
    """As docs/bodies.md shows it: nothing else is touched."""

    @dataclass(frozen=True)
    class Stiffening(Law):
        slope: float
        growth: float

        def force(self, depth: Matrix) -> Matrix:
            return self.slope * self.growth * (ca.exp(ca.fmax(depth, 0) / self.growth) - 1)

    law = Stiffening(1e5, 2e-3)
    both = series(law, PowerLaw(1.9e7))
    expected = exact_series((law, PowerLaw(1.9e7)), 3e-3)
    assert force(both, 3e-3)[0] == pytest.approx(expected, rel=1e-4)
