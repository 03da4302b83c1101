# SPDX-License-Identifier: BSD-3-Clause
"""Pressure by the shape that touches: bounds that hold, and how far they are from the truth."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from layer_contact import Gap, largest_pressure

from softimpact.symbolic import Edge, Flat, InvalidValue, Sphere
from softimpact.symbolic.body.pads import HARDEST, PADS, young_modulus
from softimpact.symbolic.body.shapes import Shape, force_at_pressure, shape_from

NUMERICAL = 1.01
"""What the grid and the neighbours of a periodic shape may hide."""

SHAPES = st.one_of(
    st.builds(Sphere, st.floats(1e-3, 1)),
    st.builds(Edge, st.floats(1e-3, 1), st.floats(1e-3, 0.3)),
    st.builds(Flat, st.floats(1e-5, 0.1), st.floats(1e-3, 0.1)),
)


def half_width(force: float, radius: float) -> float:
    """Return the radius of contact under a ball [m], on half-space or thin layer, the smaller."""
    E, t = HARDEST.modulus, HARDEST.thickness
    thick = (3 * force * radius / (4 * 4 / 3 * E)) ** (1 / 3)
    return float(min(thick, 1.2 * (32 * radius * t**3 * force / (math.pi * E / 3)) ** (1 / 6)))


@pytest.mark.parametrize("radius", [2e-3, 1e-2, 0.1, 0.5])
@pytest.mark.parametrize("force", [1.0, 30.0, 280.0])
def test_the_bound_under_a_ball_is_near_the_truth(radius: float, force: float) -> None:
    def ball(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.asarray((x**2 + y**2) / (2 * radius))

    exact = largest_pressure(ball, force, HARDEST, 6 * half_width(force, radius))
    assert exact <= NUMERICAL * Sphere(radius).pressure(force) <= 1.3 * exact


def along(length: float, radius: float) -> Gap:
    """Return an edge with rounded ends."""
    return lambda x, y: (x**2 + np.maximum(np.abs(y) - length / 2, 0) ** 2) / (2 * radius)


@pytest.mark.parametrize("radius", [2e-3, 1e-2, 0.05])
@pytest.mark.parametrize(("length", "force"), [(5e-3, 30.0), (2e-2, 10.0), (2e-2, 280.0)])
def test_the_bound_under_an_edge_holds_at_its_ends(
    radius: float, length: float, force: float
) -> None:
    width = length + 4 * half_width(force, radius)
    exact = largest_pressure(along(length, radius), force, HARDEST, width, 256)
    assert exact <= NUMERICAL * Edge(radius, length).pressure(force) <= 2.5 * exact


@pytest.mark.parametrize("rim", [5e-3, 2e-2])
@pytest.mark.parametrize(("side", "force"), [(1e-2, 100.0), (2e-2, 10.0), (2e-2, 280.0)])
def test_the_bound_under_a_flat_face_holds(rim: float, side: float, force: float) -> None:
    def square(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        beyond = [np.maximum(np.abs(u) - side / 2, 0) ** 2 for u in (x, y)]
        return np.asarray((beyond[0] + beyond[1]) / (2 * rim))

    def disc(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.asarray(np.maximum(np.hypot(x, y) - side / 2, 0) ** 2 / (2 * rim))

    for face, area in ((square, side**2), (disc, math.pi * side**2 / 4)):
        exact = largest_pressure(face, force, HARDEST, side + 1.2e-2)
        assert exact <= NUMERICAL * Flat(area, rim).pressure(force) <= 8 * exact


@given(SHAPES, st.floats(1e-3, 1e4), st.floats(1.01, 10))
def test_pressure_rises_with_force_and_can_be_inverted(
    shape: Shape, force: float, more: float
) -> None:
    pressure = shape.pressure(force)
    assert 0 < pressure < shape.pressure(more * force)
    assert force_at_pressure(shape, pressure) == pytest.approx(force, rel=1e-6)
    assert shape.pressure(0.0) == 0.0


@given(SHAPES, st.floats(1, 1e3))
def test_softer_skin_feels_less_pressure(shape: Shape, force: float) -> None:
    soft, medium, hard = (shape.pressure(force, PADS[f"sh{h}"]) for h in (10, 30, 70))
    assert soft < medium < hard


@given(st.floats(1e-3, 0.1), st.floats(1e-3, 0.3), st.floats(1, 1e3), st.floats(1.1, 5))
def test_blunter_is_better(radius: float, length: float, force: float, more: float) -> None:
    ball, edge = Sphere(radius).pressure(force), Edge(radius, length).pressure(force)
    assert edge <= ball
    assert Sphere(more * radius).pressure(force) < ball
    assert Edge(more * radius, length).pressure(force) <= edge
    assert Edge(radius, more * length).pressure(force) <= edge


@given(st.floats(1e-3, 0.1), st.floats(1e-3, 0.3), st.floats(1, 1e3), st.floats(0.3, 3))
def test_bounds_have_the_dimension_of_a_pressure(
    radius: float, length: float, force: float, scale: float
) -> None:
    """Lengths times a number and forces times its square: the same pressure on the same rubber."""
    thick = replace(HARDEST, thickness=scale * HARDEST.thickness)
    for one, other in (
        (Sphere(radius), Sphere(scale * radius)),
        (Edge(radius, length), Edge(scale * radius, scale * length)),
        (Flat(length**2, radius), Flat((scale * length) ** 2, scale * radius)),
    ):
        found = other.pressure(scale**2 * force, thick)
        assert found == pytest.approx(one.pressure(force), rel=1e-9)


@given(st.floats(1e-2, 0.1), st.floats(1e-2, 0.3), st.floats(1, 1e3))
def test_a_face_is_twice_its_mean_and_its_rim(radius: float, side: float, force: float) -> None:
    """The rim is an edge without ends, as long as a round face's, of a formula of its own here."""
    f, E, t = force / (2 * side * math.sqrt(math.pi)), HARDEST.modulus, HARDEST.thickness
    hertz = math.sqrt(f * 4 / 3 * E / (math.pi * radius))  # Johnson, Eq. 4.45
    a = (15 * radius * t**3 * f / (2 * E / 3)) ** (1 / 5)  # a thin layer that cannot give way
    rim = hertz + 15 * f / (16 * a)
    face = Flat(side**2, radius).pressure(force)
    assert face == pytest.approx(2 * force / side**2 + rim, rel=1e-9)
    edge, ball = Edge(radius, side).pressure(force), Sphere(radius).pressure(force)
    alone = Edge(radius, 2 * side * math.sqrt(math.pi)).pressure(force)
    assert alone <= 1.5 * rim * (1 + 1e-9)  # Edge's ends: half as much again, at most a ball's
    assert edge <= ball


def test_a_ball_on_a_half_space_is_hertzs() -> None:
    """Johnson, Eq. 4.24, by hand: E* = 9.404 MPa, R = 1 mm, 0.1 N: a = 0.2 mm, 1.2 MPa."""
    assert HARDEST.modulus * 4 / 3 == pytest.approx(9.404e6, rel=1e-3)
    a = (3 * 0.1 * 1e-3 / (4 * 9.404e6)) ** (1 / 3)
    assert Sphere(1e-3).pressure(0.1) == pytest.approx(3 * 0.1 / (2 * math.pi * a**2), rel=0.03)


def test_rubber_by_its_hardness() -> None:
    """Gent's relation, at the points usually tabulated: 30 ShA 1.1 MPa, 70 ShA 5.5 MPa."""
    assert young_modulus(30) == pytest.approx(1.14e6, rel=0.01)
    assert young_modulus(70) == pytest.approx(5.52e6, rel=0.01)


@pytest.mark.parametrize("name", PADS)
def test_pads_that_were_not_measured_follow_from_the_one_that_was(name: str) -> None:
    pad, nominal = PADS[name], young_modulus(70)
    assert pad.law.exponent == 1.5
    if name != "sh70":
        assert pad.law.stiffness == pytest.approx(1.9e7 * pad.modulus / nominal, rel=2e-3)


@pytest.mark.parametrize(
    ("text", "shape"),
    [
        ("sphere:0.01", Sphere(0.01)),
        ("edge:2e-3,0.05", Edge(2e-3, 0.05)),
        ("flat:4e-3,0.005", Flat(4e-3, 0.005)),
    ],
)
def test_shapes_have_a_short_form(text: str, shape: Shape) -> None:
    assert shape_from(text) == shape


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("cone:1", "shape: must be sphere:RADIUS, edge:RADIUS,LENGTH, .* not 'cone:1'"),
        ("", "shape: must be sphere"),
        ("sphere", "shape: must be sphere:RADIUS, with numbers"),
        ("sphere:big", "shape: must be sphere:RADIUS"),
        ("edge:0.01", "shape: must be edge:RADIUS,LENGTH"),
        ("sphere:0.01,2", "shape: must be sphere:RADIUS"),
        ("edge:0.01,-1", "shape.length: must be finite and greater than 0"),
        ("sphere:nan", "shape.radius: must be finite"),
    ],
)
def test_short_forms_that_say_no_shape(text: str, message: str) -> None:
    with pytest.raises(InvalidValue, match=message):
        shape_from(text)


@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_impossible_shapes_are_refused(value: float) -> None:
    for build in (
        lambda: Sphere(value),
        lambda: Edge(1e-3, value),
        lambda: Edge(value, 1e-3),
        lambda: Flat(value, 1e-3),
        lambda: Flat(1e-3, value),
    ):
        with pytest.raises(InvalidValue, match="greater than 0"):
            build()
