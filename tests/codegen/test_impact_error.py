# SPDX-License-Identifier: BSD-3-Clause
"""What a package states of its impacts, also where many of them are hard."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from compiled_impacts import OK, UNRESOLVED, Impacts, record_of
from compiled_packages import Generated

from softimpact.codegen import generate_package, impact
from softimpact.codegen.impact_error import draw_impacts
from softimpact.codegen.inputs import parameters_of
from softimpact.symbolic import load_robot

LIGHT_FOOT = """
<mujoco model="leg">
  <compiler angle="radian"/>
  <worldbody>
    <body name="thigh"><joint name="hip" axis="0 1 0" range="-1 1" armature=".03"/>
      <inertial mass=".5" pos="0 0 -.1" diaginertia=".002 .002 .0003"/>
      <body name="shank" pos="0 0 -.2">
        <joint name="knee" axis="0 1 0" range=".3 2" armature=".03"/>
        <inertial mass=".03" pos="0 0 -.08" diaginertia="{inertia} {inertia} {inertia}"/>
        <site name="foot" pos="0 0 -.2"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def leg(folder: Path, inertia: float) -> Generated:
    """Return the package of a leg with a foot of a few grams."""
    path = folder / "leg.xml"
    path.write_text(LIGHT_FOOT.format(inertia=inertia))
    robot = load_robot(path)
    manifest = generate_package(robot, folder / "leg", tip="foot")
    return Generated(robot, "foot", folder / "leg", manifest)


@pytest.mark.slow
def test_a_light_foot_states_how_many_impacts_do_not_end(tmp_path: Path) -> None:
    package = leg(tmp_path, inertia=2e-5)
    record = record_of(package)
    assert 0 < record.unresolved < 0.1
    assert record.chain_error_usual < 0.01
    for real in ("double", "float"):
        said = package.run_own_test("gcc", real, tmp_path / "own_test")
        assert said.endswith("all passed\n")
    stated = f"{record.unresolved} "
    assert stated in (package.folder / "README.md").read_text()
    assert stated in (package.folder / "include/leg.h").read_text()
    compiled, directions = Impacts(package, "double"), np.array([[1.0, 0, 0], [0, 0, 1]])
    drawn = draw_impacts(package.robot, parameters_of(package.robot), directions, 400, seed=8)
    found = [compiled.peak_force(case)[0] for case in drawn]
    share = found.count(UNRESOLVED) / (found.count(UNRESOLVED) + found.count(OK))
    assert share == pytest.approx(record.unresolved, abs=0.05)


def test_references_end_where_steps_in_c_do_not() -> None:
    """Of a mode that moves itself, and is too fast for as many steps as C takes."""
    frequency, weight, velocity = (np.array(x) for x in ([0.0, 2e5], [1.0, 0.1], [0.9, 0.1]))
    modes = impact.Modes(frequency**2, weight, velocity)
    body = impact.Body(25e3, 10.0, None, 1.9e7)
    assert np.isnan(impact.peak_force(modes, 0.5, body).force)
    found, finer = (impact.peak_force(modes, 0.5, body, factor) for factor in (2.0, 4.0))
    assert found.nodes > 2 * impact.STEPS
    assert finer.force == pytest.approx(found.force, rel=1e-3)


def test_a_leg_that_hardly_leaves_its_singularity_has_no_impacts(tmp_path: Path) -> None:
    path = tmp_path / "leg.xml"
    path.write_text(LIGHT_FOOT.format(inertia=1e-4).replace("radian", "degree"))
    manifest = generate_package(load_robot(path), tmp_path / "leg", tip="foot", chain_order=1)
    assert manifest.impact is None
    assert not list(tmp_path.glob("leg/src/*peak_force.c"))
