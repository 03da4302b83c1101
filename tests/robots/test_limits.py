# SPDX-License-Identifier: BSD-3-Clause
"""Limits of the built-in arms, written a second time as their makers print them."""

from __future__ import annotations

from typing import NamedTuple

import mujoco
import numpy as np
import pytest

from softimpact.robots import built_in_robots
from softimpact.symbolic.robot.rigid import Array

SPEED = "speed_limit"


class Limits(NamedTuple):
    """Of each joint: range [rad or degrees], greatest speed, greatest torque [N·m]."""

    unit: float
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    speed: tuple[float, ...]
    torque: tuple[float, ...]


DEGREES, RADIANS = np.pi / 180, 1.0
ENDLESS = np.inf


def symmetric(unit: float, upper: tuple[float, ...], *rest: tuple[float, ...]) -> Limits:
    """Return limits whose range is the same to both sides."""
    return Limits(unit, tuple(-x for x in upper), upper, *rest)


LIMITS = {
    "panda": Limits(
        RADIANS,
        (-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973),
        (2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973),
        (2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61),
        (87, 87, 87, 87, 12, 12, 12),
    ),
    "fr3": Limits(
        RADIANS,
        (-2.7437, -1.7837, -2.9007, -3.0421, -2.8065, 0.5445, -3.0159),
        (2.7437, 1.7837, 2.9007, -0.1518, 2.8065, 4.5169, 3.0159),
        (2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26),
        (87, 87, 87, 87, 12, 12, 12),
    ),
    "ur5e": symmetric(
        DEGREES, (360, 360, 180, 360, 360, 360), 6 * (180,), (150, 150, 150, 28, 28, 28)
    ),
    "ur10e": symmetric(
        DEGREES,
        (360, 360, 180, 360, 360, 360),
        (120, 120, 180, 180, 180, 180),
        (330, 330, 150, 56, 56, 56),
    ),
    "iiwa14": symmetric(
        DEGREES,
        (170, 120, 170, 120, 170, 120, 175),
        (85, 85, 100, 75, 130, 135, 135),
        (320, 320, 176, 176, 110, 40, 40),
    ),
    "gen3": symmetric(
        DEGREES,
        (ENDLESS, 128.9, ENDLESS, 147.8, ENDLESS, 120.3, ENDLESS),
        (80, 80, 80, 80, 70, 70, 70),
        (105, 105, 105, 105, 52, 52, 52),
    ),
    "xarm7": Limits(
        DEGREES,
        (-360, -118, -360, -11, -360, -97, -360),
        (360, 120, 360, 225, 360, 180, 360),
        7 * (180,),
        (50, 50, 30, 30, 30, 20, 20),
    ),
}

ROUNDED = 3e-3
"""Relative difference between a source's degrees and its radians (-118° is -2.059 for the xArm)."""


@pytest.fixture(params=LIMITS, scope="module")
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def model(name: str) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(str(built_in_robots()[name]))


def speed_limits(model: mujoco.MjModel) -> Array:
    """Return the custom numeric."""
    at = int(model.numeric(SPEED).id)
    first, size = int(model.numeric_adr[at]), int(model.numeric_size[at])
    return np.array(model.numeric_data[first : first + size])


def test_ranges(name: str, model: mujoco.MjModel) -> None:
    limits = LIMITS[name]
    for side, printed in enumerate((limits.lower, limits.upper)):
        expected = limits.unit * np.array(printed, dtype=float)
        has_one = np.isfinite(expected)
        np.testing.assert_array_equal(model.jnt_limited.astype(bool), has_one)
        found = model.jnt_range[has_one, side]
        np.testing.assert_allclose(found, expected[has_one], rtol=ROUNDED)


def test_speeds(name: str, model: mujoco.MjModel) -> None:
    limits = LIMITS[name]
    expected = limits.unit * np.array(limits.speed)
    np.testing.assert_allclose(speed_limits(model), expected, rtol=ROUNDED)


def test_torques(name: str, model: mujoco.MjModel) -> None:
    assert model.jnt_actfrclimited.all()
    torques = np.array(LIMITS[name].torque, dtype=float)
    np.testing.assert_array_equal(model.jnt_actfrcrange, np.stack([-torques, torques], axis=1))


def test_every_arm_with_a_data_sheet_is_here() -> None:
    """The robots of papers print no limits."""
    assert set(built_in_robots()) - set(LIMITS) == {"mini_cheetah", "rr", "rmin"}
