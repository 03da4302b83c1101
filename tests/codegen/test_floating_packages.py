# SPDX-License-Identifier: BSD-3-Clause
"""Packages with a function for the robot with its base set free."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from command_line import refusal, run_json
from compiled_packages import Generated
from oracles import example_urdf
from package_oracle import OK, assert_agrees

from softimpact.codegen import generate_package
from softimpact.codegen.inputs.samples import draw_samples
from softimpact.symbolic import InvalidValue, MasslessBase, Robot, load_robot

LEG = """
<mujoco model="leg">
  <worldbody>
    <body name="trunk" pos="0 0 1"><freejoint/>
      <inertial mass="6" pos="0.02 0 0.01" diaginertia=".04 .09 .1"/>
      <body name="hip" pos=".2 .1 0"><joint name="abduction" axis="1 0 0" armature=".02"/>
        <inertial mass=".7" pos="0 .02 0" diaginertia=".001 .001 .001"/>
        <body name="thigh" pos="0 .08 0"><joint name="pitch" axis="0 1 0" armature=".02"/>
          <inertial mass="1" pos="0 0 -.1" diaginertia=".006 .006 .001"/>
          <body name="shank" pos="0 0 -.2"><joint name="knee" axis="0 1 0" armature=".03"/>
            <inertial mass=".2" pos="0 0 -.1" diaginertia=".001 .001 .0001"/>
            <site name="foot" pos=".01 0 -.2"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def leg(tmp_path_factory: pytest.TempPathFactory) -> Generated:
    """A leg under a trunk, generated from the command line."""
    folder = tmp_path_factory.mktemp("leg")
    path = folder / "leg.xml"
    path.write_text(LEG)
    options = ("--floating", "--order", 2, "--out", folder / "c")
    run_json("generate", path, "--tip", "foot", *options)
    robot = load_robot(path, "foot", floating=True)
    manifest = generate_package(robot, folder / "called", tip="foot", chain_order=2, floating=True)
    for file in manifest.files:
        assert (folder / "c" / file).read_bytes() == (folder / "called" / file).read_bytes()
    return Generated(robot, "foot", folder / "c", manifest)


@pytest.mark.slow
@pytest.mark.parametrize("real", ["double", "float"])
def test_c_agrees_with_the_floating_model(leg: Generated, real: str, tmp_path: Path) -> None:
    samples = draw_samples(leg.robot, leg.parameters, 20, seed=97)
    assert assert_agrees(leg.load(real), samples) > 0.9 * len(samples) * len(leg.functions)
    assert leg.manifest.digest == leg.robot.digest(floating=True) != leg.robot.digest()
    assert leg.run_own_test("gcc", real, tmp_path / "test").endswith("all passed\n")


@pytest.mark.slow
def test_factors_are_shares(leg: Generated) -> None:
    (function,) = [f for f in leg.functions if f.name == "impact_mitigation"]
    library = leg.load("double")
    for sample in draw_samples(leg.robot, leg.parameters, 50, seed=5):
        status, (imf, Xi, giaf, real, locked) = library.call(function, sample)
        assert status == OK
        assert 0 <= imf <= 1
        assert 0 < giaf <= 1
        assert np.linalg.det(Xi) == pytest.approx(float(imf), abs=1e-9)
        assert np.linalg.eigvalsh(locked - real).min() > -1e-9  # joints only take inertia away


@pytest.mark.slow
def test_a_quadruped_fits(tmp_path: Path) -> None:
    robot = load_robot(example_urdf("go2.urdf"), "FL_foot", floating=True)
    robot = robot.with_armature([0.02] * robot.n)
    manifest = generate_package(robot, tmp_path / "c", name="go2", chain_order=2, floating=True)
    package = Generated(robot, "FL_foot", tmp_path / "c", manifest)
    samples = draw_samples(robot, package.parameters, 10, seed=97)
    assert assert_agrees(package.load("double"), samples) > 0
    assert {f.name: f.flops for f in manifest.functions}["go2_impact_mitigation"] < 5000


def test_bases_that_cannot_float_are_refused(tmp_path: Path, panda: Robot) -> None:
    with pytest.raises(MasslessBase):
        generate_package(panda, tmp_path / "c", floating=True)
    with pytest.raises(InvalidValue, match="floating"):
        generate_package(load_robot("rmin"), tmp_path / "c", floating=True)
    assert "no mass" in refusal("generate", "panda", "--floating", "--out", tmp_path / "c")
    assert not (tmp_path / "c").exists()
