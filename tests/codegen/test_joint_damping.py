# SPDX-License-Identifier: BSD-3-Clause
"""Joints' own damping in C: forces as Python and SciPy have them, bounds that hold."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from compiled_impacts import BOUNDED, DRIVEN, FREE, OK, SERVO, Impacts, Motion, impacts
from compiled_packages import Generated, tool
from impact_models import model_of
from independent_impacts import arm_of, force_by_scipy
from small_arm import ARM

from softimpact.codegen import generate_package
from softimpact.simulate import Approach, simulate_impact
from softimpact.symbolic import Contact, Motors, body_region, load_robot

pytestmark = pytest.mark.slow
DAMPING = {"turn": 8.0, "lift": 3.0, "bend": 0.5}
KINDS: dict[int, Any] = {FREE: "free", DRIVEN: "driven", SERVO: "servo"}


@pytest.fixture(scope="module")
def damped(tmp_path_factory: pytest.TempPathFactory) -> Generated:
    """An arm of three joints that damp as much as gears with cold grease."""
    folder = tmp_path_factory.mktemp("damped")
    text = ARM
    for name, damping in DAMPING.items():
        text = text.replace(f"name='{name}'", f"name='{name}' damping='{damping}'", 1)
    (folder / "arm.xml").write_text(text)
    robot = load_robot(folder / "arm.xml")
    gcc = [tool("gcc")]  # runs the package's own test
    manifest = generate_package(robot, folder / "package", tip="tool", name="thick", compiler=gcc)
    return Generated(robot, "tool", folder / "package", manifest)


def test_forces_are_pythons_and_bounds_hold(damped: Generated) -> None:
    bounded = 0
    for k, case in enumerate(impacts(damped, 3, seed=61)):
        kind = (FREE, DRIVEN, SERVO)[k % 3]
        compiled = Impacts(damped, ("double", "float")[k % 2])
        region = compiled.region("hand", clamped=k % 2 == 0)
        motion = Motion(kind, 0.02, 0.1, 1_000_000)
        status, (force, _) = compiled.call("peak_force", case.sample, 0.4, region, motion)
        right = simulate_impact(
            model_of(compiled, case.sample),
            Approach(case.sample.q, case.sample.n, 0.4),
            Contact(body_region("hand"), clamped=k % 2 == 0),
            motors=Motors(KINDS[kind], 0.02),
            horizon=0.1,
        ).peak
        assert status == OK
        assert force == pytest.approx(right, rel=2e-3)
        few = replace(motion, steps=5)
        status, (bound, _) = compiled.call("peak_force", case.sample, 0.4, region, few)
        assert status in (OK, BOUNDED)
        assert status == OK or bound >= right
        bounded += status == BOUNDED
    assert bounded > 0


def test_scipy_finds_the_same(damped: Generated) -> None:
    compiled = Impacts(damped, "double")
    case = impacts(damped, 2, seed=62)[1]
    contact, times = Contact(body_region("chest")), np.linspace(0, 0.1, 4001)
    parted = []
    for kind in (FREE, SERVO):
        region, motion = compiled.region("chest", clamped=True), Motion(kind, 0.02, 0.1, 1_000_000)
        status, (force, _) = compiled.call("peak_force", case.sample, 0.5, region, motion)
        approach, motors = Approach(case.sample.q, case.sample.n, 0.5), Motors(KINDS[kind], 0.02)
        arm = arm_of(model_of(compiled, case.sample), approach, full=False)
        right = force_by_scipy(arm, contact, motors, times, 1e-8).max()
        assert status == OK
        assert force == pytest.approx(right, rel=2e-3)
        bare = replace(arm, damping=0 * arm.damping)
        without = force_by_scipy(bare, contact, motors, times, 1e-8).max()
        parted.append(abs(without / right - 1))
    assert max(parted) > 0.003, parted  # it would be missed
