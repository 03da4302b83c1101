# SPDX-License-Identifier: BSD-3-Clause
"""Limits of the built-in arms, written a second time as their makers print them."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from softimpact.robots import built_in_robots
from softimpact.symbolic import ModelFileError, Robot, load_robot


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


WITHOUT_LIMITS = {"mini_cheetah", "rr", "rmin"}
"""Robots whose sources print none: those of papers, and a leg."""


@pytest.fixture(params=LIMITS, scope="module")
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def robot(name: str) -> Robot:
    return load_robot(name)


def test_ranges(name: str, robot: Robot) -> None:
    limits = LIMITS[name]
    for found, printed in zip(robot.limits, (limits.lower, limits.upper), strict=True):
        expected = limits.unit * np.array(printed, dtype=float)
        np.testing.assert_allclose(found, expected, rtol=ROUNDED)


def test_speeds(name: str, robot: Robot) -> None:
    limits = LIMITS[name]
    expected = limits.unit * np.array(limits.speed)
    np.testing.assert_allclose(robot.speed_limits, expected, rtol=ROUNDED)


def test_torques(name: str, robot: Robot) -> None:
    np.testing.assert_array_equal(robot.torque_limits, np.array(LIMITS[name].torque, dtype=float))


def test_a_robot_without_limits_has_none() -> None:
    assert np.isinf(load_robot("rr").speed_limits).all()
    assert np.isinf(load_robot("rr").torque_limits).all()


@pytest.mark.parametrize(
    ("data", "reason"), [("1", "1 values for 2 joints"), ("1 0", "must be greater than 0")]
)
def test_speed_limits_that_do_not_fit(tmp_path: Path, data: str, reason: str) -> None:
    text = """<mujoco><custom><numeric name="speed_limit" data="DATA"/></custom><worldbody>
      <body><joint/><inertial mass="1" pos="0.1 0 0" diaginertia="1 1 1"/>
      <body><joint/><inertial mass="1" pos="0.1 0 0" diaginertia="1 1 1"/></body></body>
      </worldbody></mujoco>"""
    path = tmp_path / "two.xml"
    path.write_text(text.replace("DATA", data))
    with pytest.raises(ModelFileError, match=reason):
        load_robot(path)


def test_every_arm_with_a_data_sheet_is_here() -> None:
    missing = set(built_in_robots()) - set(LIMITS) - WITHOUT_LIMITS
    assert not missing, (
        f"{sorted(missing)}: transcribe the data sheet's limits into LIMITS of this file, with "
        "their source, or add the name to WITHOUT_LIMITS if it prints none (step 7 of "
        "docs/adding-a-robot.md)"
    )
    assert set(built_in_robots()) >= WITHOUT_LIMITS
