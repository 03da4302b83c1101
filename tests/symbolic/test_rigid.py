# SPDX-License-Identifier: BSD-3-Clause
"""Placements and inertias."""

import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from oracles import assert_near
from random_robots import inertias, placements

from softimpact.symbolic.robot.rigid import (
    ROTATION_NOISE,
    Inertia,
    Placement,
    rotation_about_z,
    rotation_from_axis,
)

ROUNDED = 10 * ROTATION_NOISE


@given(placements(), placements())
def test_placements_form_a_group(a: Placement, b: Placement) -> None:
    back = a @ a.inverse()
    assert_near(back.rotation, np.eye(3), ROUNDED)
    assert_near(back.translation, np.zeros(3))
    both, x = a @ b, np.array([0.1, -0.2, 0.3])
    inner = b.rotation @ x + b.translation
    assert_near(both.rotation @ x + both.translation, a.rotation @ inner + a.translation, ROUNDED)


def test_noise_of_a_rotation_is_snapped_and_small_angles_are_not() -> None:
    noisy = Placement(rotation_from_axis(np.array([1.0, 0, 0]), np.pi / 2 + 1e-15), np.zeros(3))
    assert np.array_equal(noisy.rotation, [[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    assert not np.signbit(noisy.rotation[0]).any()
    small = Placement(rotation_about_z(1e-5), np.zeros(3))
    assert small.rotation[1, 0] == pytest.approx(1e-5)


def test_data_are_frozen() -> None:
    place, body = Placement.identity(), Inertia.zero()
    for array in (place.rotation, place.translation, body.first_moment, body.about_origin):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        setattr(place, "rotation", np.eye(3))  # noqa: B010 - a type checker sees it too


def test_frozen_data_do_not_alias_their_source() -> None:
    source = np.zeros(3)
    place = Placement(np.eye(3), source)
    source[0] = 1.0
    assert place.translation[0] == 0.0


@pytest.mark.parametrize("angle", [-3.0, 0.0, 0.4, np.pi])
def test_rotations_agree_with_pinocchio(angle: float) -> None:
    axis = np.array([0.6, -0.64, 0.48])
    assert_near(rotation_from_axis(axis, angle), pin.AngleAxis(angle, axis).matrix(), 1e-14)
    assert_near(rotation_about_z(angle), rotation_from_axis(np.array([0, 0, 1.0]), angle), 1e-14)


@given(inertias(), placements())
def test_a_moved_inertia_agrees_with_pinocchio(body: Inertia, place: Placement) -> None:
    def of(inertia: Inertia) -> pin.Inertia:
        com = inertia.first_moment / inertia.mass
        steiner = inertia.mass * (com @ com * np.eye(3) - np.outer(com, com))
        return pin.Inertia(inertia.mass, com, inertia.about_origin - steiner)

    moved = pin.SE3(np.array(place.rotation), np.array(place.translation)).act(of(body))
    ours = of(body.seen_from(place))
    assert_near(ours.lever, moved.lever)
    assert_near(ours.inertia, moved.inertia)


@given(inertias(), inertias(), placements())
def test_inertias_add_and_subtract_in_any_frame(a: Inertia, b: Inertia, place: Placement) -> None:
    both = (a + b).seen_from(place)
    parts = a.seen_from(place) + b.seen_from(place)
    assert_near(both.about_origin, parts.about_origin)
    assert_near((both - b.seen_from(place)).first_moment, a.seen_from(place).first_moment)


def test_from_center_of_mass_is_steiners_theorem() -> None:
    body = Inertia.from_center_of_mass(2.0, [0.0, 0.0, 0.5], np.diag([1.0, 2.0, 3.0]))
    assert_near(body.first_moment, [0, 0, 1.0])
    assert_near(body.about_origin, np.diag([1.5, 2.5, 3.0]))
