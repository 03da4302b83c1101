# SPDX-License-Identifier: BSD-3-Clause
"""Every built-in robot follows docs/adding-a-robot.md."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import mujoco
import numpy as np
import pytest
from oracles import Mujoco, assert_near, configurations

from softimpact.robots import FOLDER, built_in_robots
from softimpact.symbolic import (
    Robot,
    bias_torques,
    frame_jacobian,
    impact_model,
    load_robot,
    mass_matrix,
)

LICENSE_LINE = "<!-- SPDX-License-Identifier: BSD-3-Clause -->"
LIGHTEST, HEAVIEST = 0.1, 500.0
"""Mass of a whole robot [kg]."""


@pytest.fixture(params=built_in_robots(), scope="module")
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def path(name: str) -> Path:
    return built_in_robots()[name]


@pytest.fixture(scope="module")
def robot(name: str) -> Robot:
    return load_robot(name)


def test_there_are_robots() -> None:
    assert {"panda", "rr"} <= set(built_in_robots())


def test_file_starts_with_its_licence_and_cites_sources(path: Path) -> None:
    text = path.read_text()
    assert text.splitlines()[0] == LICENSE_LINE
    comments = re.findall(r"<!--(.*?)-->", text.split("<mujoco")[0], re.DOTALL)[1:]
    cited = " ".join(comments)
    assert len(cited.split()) >= 15, "say where the numbers come from"
    assert re.search(r"\b(19|20)\d\d\b|\w+/\w+", cited), "name a year or a repository's file"


def test_model_is_named_like_the_file_and_needs_no_other(path: Path) -> None:
    root = ET.parse(path).getroot()
    assert root.tag == "mujoco"
    assert root.get("model") == path.stem
    assert not [element.tag for element in root.iter() if "file" in element.attrib]


def test_tip_is_a_site_that_moves(path: Path, robot: Robot) -> None:
    sites = {site.get("name") for site in ET.parse(path).getroot().iter("site")}
    assert robot.tip in sites
    assert robot.tip is not None
    q = next(configurations(robot, 1))
    assert np.linalg.norm(frame_jacobian(robot, robot.tip, q)[:3, :].full()) > 0


def test_every_joint_has_a_name_of_its_own(path: Path, robot: Robot) -> None:
    names = [joint.get("name") for joint in ET.parse(path).getroot().iter("joint")]
    assert tuple(names) == robot.joint_names
    assert len(set(names)) == robot.n


def test_limits_are_sane(robot: Robot) -> None:
    for joint in robot.joints:
        assert joint.lower < joint.upper
        assert np.isinf(joint.lower) == np.isinf(joint.upper)


def test_rotors_are_sane(robot: Robot) -> None:
    assert (robot.armature >= 0).all()
    for values in robot.rotor_inertia_sets.values():
        assert len(values) == robot.n
        assert min(values) > 0
    if robot.rotor_inertia_sets and robot.armature.any():  # all zero says: unknown
        sets = robot.rotor_inertia_sets.values()
        assert any(np.array_equal(values, robot.armature) for values in sets)


def test_a_placeholder_is_not_taken_as_a_rotor(name: str, path: Path, robot: Robot) -> None:
    """Menagerie's class default of 0.1 is no data; the UR5e's is used, with a word about it."""
    if name != "ur5e":
        assert not np.allclose(robot.armature, 0.1)
    if any(np.allclose(values, 0.1) for values in robot.rotor_inertia_sets.values()):
        assert re.search("placeholder|class default without a source", path.read_text())


ROTOR_PER_TORQUE = 0.03
"""Most reflected rotor inertia over largest torque [s²] of arms whose rotors somebody states."""


def test_rotors_are_no_larger_than_the_upper_estimate(name: str, robot: Robot) -> None:
    """So that it may stand for rotors that are unknown."""
    if np.isinf(robot.torque_limits).any():
        return
    upper = ROTOR_PER_TORQUE * robot.torque_limits
    if robot.armature.any():
        assert (robot.armature <= upper).all()
    else:
        np.testing.assert_allclose(robot.rotor_inertia_set("upper_estimate"), upper)


def test_limits_of_speed_are_sane(robot: Robot) -> None:
    assert (robot.speed_limits > 0).all()
    assert np.isinf(robot.speed_limits).all() == np.isinf(robot.speed_limits).any()


def test_limits_of_torque_are_the_same_to_both_sides(path: Path) -> None:
    model = mujoco.MjModel.from_xml_path(str(path))
    for limited, (lower, upper) in zip(model.jnt_actfrclimited, model.jnt_actfrcrange, strict=True):
        assert not limited or lower == -upper < 0


def test_masses_are_sane(path: Path) -> None:
    model = mujoco.MjModel.from_xml_path(str(path))
    assert LIGHTEST < model.body_mass.sum() < HEAVIEST


def test_mujoco_agrees_about_the_dynamics(path: Path, robot: Robot) -> None:
    assert robot.tip is not None
    oracle = Mujoco(path)
    random = np.random.default_rng(0)
    for q in configurations(robot, 3):
        velocity = random.normal(size=robot.n)
        oracle.at(q, velocity)
        M = mass_matrix(robot, q).full() + np.diag(robot.armature)
        assert_near(M, oracle.mass_matrix())
        assert_near(bias_torques(robot, q, velocity, oracle.model.opt.gravity), oracle.bias())
        assert_near(frame_jacobian(robot, robot.tip, q), oracle.site_jacobian(robot.tip))


def test_it_can_hit_something(robot: Robot) -> None:
    model = impact_model(robot)
    assert robot.tip is not None
    q = next(configurations(robot, 1))
    moves = np.linalg.svd(model.jacobian(q).full())[0][:, 0]  # where the tip moves most easily
    assert 0 < float(model.reflected_mass(q, moves)) < HEAVIEST


def test_built_in_robots_ship_with_the_package() -> None:
    assert all(path.parent == FOLDER for path in built_in_robots().values())
