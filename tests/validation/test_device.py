# SPDX-License-Identifier: BSD-3-Clause
"""Forces that others measured on a device, as docs/validation.md reports them."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from softimpact.papers.measurements.foretold import Servo, foretold, two_body_force
from softimpact.papers.measurements.setups import (
    DOWN,
    HEIGHT,
    MOST_TILT,
    REACH,
    SVARNY,
    UR10E_POSE,
    iiwa_posture,
)
from softimpact.symbolic import Motors, body_region, frame_pose, load_robot

PAGE = Path(__file__).parents[2] / "docs/validation.md"

SLOW_UR, FAST_UR, _ = SVARNY

ROWS = {
    "free": (Motors("free"), None),
    "driven 10 ms, then released": (Motors("driven", 0.01), None),
    "driven 20 ms": (Motors("driven", 0.02), None),
    "driven 30 ms": (Motors("driven", 0.03), None),
    "driven 40 ms": (Motors("driven", 0.04), None),
    "driven 50 ms": (Motors("driven", 0.05), None),
    "servo of 30 rad/s, 20 ms": (Motors("servo", 0.02), Servo(30)),
    "servo of 100 rad/s, 20 ms": (Motors("servo", 0.02), Servo(100)),
    "servo of 100 rad/s, 50 ms": (Motors("servo", 0.05), Servo(100)),
    "driven 20 ms, then stop within 100 ms": (Motors("driven", 0.02, "stop"), None),
}
"""What each row of the page's table is of."""

RECOMPUTED = (
    "free",
    "driven 20 ms",
    "driven 40 ms",
    "servo of 100 rad/s, 50 ms",
    "driven 20 ms, then stop within 100 ms",
)
"""Rows that the tests compute anew; examples/05_validation.py prints them all."""

FEW = 60
"""Draws in quick tests, whose bands are rougher than the page's."""


def cells(row: str) -> list[str]:
    """Return a row of the page's table."""
    (line,) = [text for text in PAGE.read_text().splitlines() if text.startswith(f"| {row} |")]
    return [cell.strip() for cell in line.split("|")[2:-1]]


@pytest.mark.parametrize(
    ("name", "q"),
    [("ur10e", UR10E_POSE), *(("iiwa14", iiwa_posture(t)) for t in (0.0, 0.5, MOST_TILT))],
)
def test_flanges_are_at_the_device(name: str, q: np.ndarray) -> None:
    at = np.array(frame_pose(load_robot(name), "flange", q).position).ravel()
    assert np.hypot(at[0], at[1]) == pytest.approx(REACH, abs=1e-3)
    assert at[2] == pytest.approx(HEIGHT, abs=1e-3)


@pytest.mark.parametrize("tilt", [0.0, 0.5])
def test_the_iiwas_flange_points_where_it_should(tilt: float) -> None:
    axis = np.array(frame_pose(load_robot("iiwa14"), "flange", iiwa_posture(tilt)).rotation)[:, 2]
    assert axis @ DOWN == pytest.approx(np.cos(tilt))


def test_postures_are_within_the_joints_limits() -> None:
    for tilt in np.linspace(0, MOST_TILT, 7):
        lower, upper = load_robot("iiwa14").limits
        q = iiwa_posture(tilt)
        assert ((lower < q) & (q < upper)).all()


def test_the_device_is_the_one_that_was_used() -> None:
    assert {m.device for m in SVARNY} == {"device_75_sh70"}
    assert body_region("device_75_sh70").stiffness == 75e3


def test_free_motors_foretell_too_little_for_the_ur10e() -> None:
    assert foretold(FAST_UR, Motors("free"), count=FEW).high < FAST_UR.force


def test_motors_that_drive_on_hold_what_was_measured() -> None:
    assert foretold(FAST_UR, Motors("driven", 0.03), count=FEW).holds(FAST_UR.force)


@pytest.mark.slow
def test_motors_that_only_stop_foretell_too_much() -> None:
    found = foretold(SLOW_UR, Motors("driven", 0.02, "stop"), count=FEW)
    assert found.low > SLOW_UR.force


def test_two_body_formula_is_the_pages() -> None:
    found = [f"{two_body_force(measured):.0f}" for measured in SVARNY]
    assert cells("two-body formula of ISO/TS 15066") == found


def test_the_page_has_what_was_measured() -> None:
    assert cells("**measured**") == [f"**{measured.force:g}**" for measured in SVARNY]


@pytest.mark.parametrize("row", ROWS)
def test_bold_cells_hold_what_was_measured(row: str) -> None:
    for measured, cell in zip(SVARNY, cells(row), strict=True):
        low, high, _ = (float(x) for x in re.findall(r"\d+", cell))
        assert (low <= measured.force <= high) == cell.startswith("**")


@pytest.mark.slow
@pytest.mark.parametrize("row", RECOMPUTED)
def test_the_pages_bands(row: str) -> None:
    motors, servo = ROWS[row]
    for measured, cell in zip(SVARNY, cells(row), strict=True):
        found = foretold(measured, motors, servo)
        low, high, middle = (float(x) for x in re.findall(r"\d+", cell))
        for ours, theirs in zip(
            (found.low, found.middle, found.high), (low, middle, high), strict=True
        ):
            assert ours == pytest.approx(theirs, rel=5e-3, abs=0.6)
