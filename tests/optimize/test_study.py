# SPDX-License-Identifier: BSD-3-Clause
"""Study files: what they mean, and one clear error for every field that may be wrong."""

from __future__ import annotations

import math
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from robot_files import many_joints
from studies import PANDA_24, changed, content, study_of, written

from softimpact.optimize import load_study
from softimpact.robots import FOLDER
from softimpact.symbolic import InvalidValue, arm_of, impact_model, load_robot

NAN, INF = math.nan, math.inf


def refused(path: Path, *words: str) -> str:
    """Return the message of the error that a study file must raise; it names the file."""
    with pytest.raises(InvalidValue) as caught:
        load_study(path)
    message = str(caught.value)
    assert str(path) in message
    for word in words:
        assert word in message, message
    assert "\n" not in message
    return message


def test_the_built_in_study() -> None:
    study = load_study(PANDA_24)
    assert [pose.name for pose in study.poses] == [f"q{i}" for i in range(1, 25)]
    assert [pose.name for pose in study.poses if pose.recovered] == ["q19"]
    assert study.task_pose.name == "q9"
    assert study.robot.tip == "hand_tcp"
    np.testing.assert_array_equal(study.lower, np.full(7, 300.0))
    np.testing.assert_array_equal(study.upper, np.full(7, 1e5))
    np.testing.assert_array_equal(np.array(study.model.drives.springs).ravel(), study.nominal)
    assert all(study.model.drives.elastic)
    assert study.contact.region.name == "chest"
    assert study.contact.clamped
    assert study.exact


def test_defaults(tmp_path: Path) -> None:
    sparse = {
        "robot": {"tip": None, "rotor_inertia": None, "position_gain": None},
        "impact": {"clamped": None},
        "task": {"exact": None},
    }
    file = changed(sparse)
    del file["title"]
    study = load_study(written(tmp_path, file))
    assert study.title == "study"
    assert study.robot.tip == "hand_tcp"
    rotors = np.array(study.model.drives.rotors).ravel()
    np.testing.assert_array_equal(rotors, study.robot.armature)
    assert not np.any(np.array(study.model.drives.gains))
    assert study.model.drives.computed_torque_gain is None
    assert study.contact.clamped
    assert study.exact


def test_one_number_for_all_joints_or_one_for_each(tmp_path: Path) -> None:
    each = [100, 200.0, 300, 400, 500, 600, 700]
    study = study_of(tmp_path, {"stiffness": {"lower": each}, "robot": {"rotor_inertia": 0.2}})
    np.testing.assert_array_equal(study.lower, each)
    np.testing.assert_array_equal(np.array(study.model.drives.rotors).ravel(), np.full(7, 0.2))


def test_direction_becomes_a_unit_vector(tmp_path: Path) -> None:
    study = study_of(tmp_path, {"impact": {"direction": [0, 3, -4]}})
    np.testing.assert_allclose(study.direction, [0.0, 0.6, -0.8], atol=1e-15)


def test_a_byte_order_mark_is_no_content(tmp_path: Path) -> None:
    """Editors on Windows begin a file with one."""
    marked = written(tmp_path, content())
    marked.write_text(marked.read_text("utf-8"), encoding="utf-8-sig")
    assert load_study(marked).title == load_study(PANDA_24).title


def test_robot_file_beside_the_study(tmp_path: Path) -> None:
    shutil.copy(FOLDER / "panda.xml", tmp_path / "mine.xml")
    study = study_of(tmp_path, {"robot": {"model": "mine.xml"}})
    assert study.robot.digest() == load_study(PANDA_24).robot.digest()


@pytest.mark.parametrize("section", ["robot", "impact", "stiffness", "accuracy", "task", "poses"])
def test_missing_section(tmp_path: Path, section: str) -> None:
    study = content()
    del study[section]
    refused(written(tmp_path, study), section, "is missing")


@pytest.mark.parametrize(
    ("section", "field"),
    [
        ("robot", "model"),
        ("impact", "region"),
        ("impact", "direction"),
        ("impact", "speed"),
        ("stiffness", "lower"),
        ("stiffness", "upper"),
        ("stiffness", "nominal"),
        ("accuracy", "forces"),
        ("accuracy", "max_deflection"),
        ("task", "pose_of"),
    ],
)
def test_missing_field(tmp_path: Path, section: str, field: str) -> None:
    refused(
        written(tmp_path, changed({section: {field: None}})), f"{section}.{field}", "is missing"
    )


@pytest.mark.parametrize("section", ["robot", "impact", "stiffness", "accuracy", "task"])
def test_unknown_field(tmp_path: Path, section: str) -> None:
    refused(written(tmp_path, changed({section: {"colour": 1}})), f"{section}.colour")


def test_unknown_section(tmp_path: Path) -> None:
    refused(written(tmp_path, changed({"paint": {"colour": 1}})), "paint")


BAD: list[tuple[str, str, Any]] = [
    ("robot", "model", 7),
    ("robot", "model", "pandora"),
    ("robot", "model", ""),
    ("robot", "tip", "elbow"),
    ("robot", "tip", 3),
    ("robot", "tip", "link0"),
    ("robot", "tip", ""),
    ("robot", "rotor_inertia", "no_such_set"),
    ("robot", "rotor_inertia", -0.1),
    ("robot", "rotor_inertia", 0.0),
    ("robot", "rotor_inertia", [0.1, 0.1, 0.1, 0.0, 0.1, 0.1, 0.1]),
    ("robot", "rotor_inertia", NAN),
    ("robot", "rotor_inertia", INF),
    ("robot", "rotor_inertia", [0.1] * 6),
    ("robot", "rotor_inertia", True),
    ("robot", "position_gain", -1.0),
    ("robot", "position_gain", NAN),
    ("robot", "position_gain", [1.0] * 8),
    ("robot", "position_gain", "high"),
    ("robot", "computed_torque_gain", -1.0),
    ("robot", "computed_torque_gain", INF),
    ("robot", "computed_torque_gain", [6050.0] * 7),
    ("impact", "region", "toe"),
    ("impact", "region", 1),
    ("impact", "clamped", "no"),
    ("impact", "clamped", 1),
    ("impact", "direction", [0.0, 0.0, 0.0]),
    ("impact", "direction", [0.0, 1.0]),
    ("impact", "direction", [0.0, 1.0, 0.0, 0.0]),
    ("impact", "direction", [0.0, NAN, 0.0]),
    ("impact", "direction", [INF, 0.0, 0.0]),
    ("impact", "direction", "up"),
    ("impact", "direction", 1.0),
    ("impact", "speed", 0.0),
    ("impact", "speed", -1.0),
    ("impact", "speed", NAN),
    ("impact", "speed", INF),
    ("impact", "speed", "1.0"),
    ("impact", "speed", True),
    ("stiffness", "lower", 0.0),
    ("stiffness", "lower", -300.0),
    ("stiffness", "lower", NAN),
    ("stiffness", "lower", [300.0] * 6),
    ("stiffness", "lower", [300.0] * 6 + [0.0]),
    ("stiffness", "lower", 2e5),
    ("stiffness", "lower", [300.0] * 6 + [2e5]),
    ("stiffness", "upper", INF),
    ("stiffness", "upper", NAN),
    ("stiffness", "upper", []),
    ("stiffness", "upper", "stiff"),
    ("stiffness", "nominal", 0.0),
    ("stiffness", "nominal", 299.0),
    ("stiffness", "nominal", 1.1e5),
    ("stiffness", "nominal", [15000.0] * 8),
    ("accuracy", "forces", []),
    ("accuracy", "forces", [[1.0, 2.0]]),
    ("accuracy", "forces", [30.0, 0.0, 0.0]),
    ("accuracy", "forces", [[30.0, NAN, 0.0]]),
    ("accuracy", "max_deflection", 0.0),
    ("accuracy", "max_deflection", -0.001),
    ("accuracy", "max_deflection", NAN),
    ("accuracy", "max_deflection", "1 mm"),
    ("task", "pose_of", "q25"),
    ("task", "pose_of", 9),
    ("task", "exact", "yes"),
]


@pytest.mark.parametrize(("section", "field", "value"), BAD)
def test_bad_field(tmp_path: Path, section: str, field: str, value: Any) -> None:
    refused(written(tmp_path, changed({section: {field: value}})), f"{section}.{field}")


def test_what_is_known_is_listed(tmp_path: Path) -> None:
    for section, field, known in (
        ("robot", "model", "panda"),
        ("robot", "tip", "hand_tcp"),
        ("robot", "rotor_inertia", "drake_fr3"),
        ("impact", "region", "chest"),
    ):
        path = written(tmp_path, changed({section: {field: "none"}}))
        refused(path, f"{section}.{field}", "'none'", known)


def test_bounds_that_contradict_each_other_name_the_joint(tmp_path: Path) -> None:
    lower = [300.0] * 3 + [2e5] + [300.0] * 3
    path = written(tmp_path, changed({"stiffness": {"lower": lower}}))
    refused(path, "stiffness.lower", "200000", "100000", "joint4")


def test_both_kinds_of_gain(tmp_path: Path) -> None:
    gains = {"position_gain": 100.0, "computed_torque_gain": 6050.0}
    refused(written(tmp_path, changed({"robot": gains})), "robot.computed_torque_gain", "excludes")


BAD_POSES: list[tuple[dict[str, Any], tuple[str, ...]]] = [
    ({"q": [0.0] * 6}, ("poses.q1.q", "6 values", "7")),
    ({"q": [0.0] * 8}, ("poses.q1.q", "8 values")),
    ({"q": [NAN] + [0.0] * 6}, ("poses.0.q.0",)),
    ({"q": "home"}, ("poses.0.q",)),
    ({"q": ["0"] * 7}, ("poses.0.q",)),
    ({"q": [-2.01, 1.76, 0.96, 0.1, -0.51, 2.15, -1.06]}, ("q1", "joint4", "-3.0718", "0.1")),
    ({"name": "q2"}, ("poses", "more than once", "q2")),
    ({"name": 1}, ("poses.0.name",)),
    ({"recovered": "yes"}, ("poses.0.recovered",)),
    ({"weight": 1.0}, ("poses.0.weight",)),
]


@pytest.mark.parametrize(("fields", "words"), BAD_POSES)
def test_bad_pose(tmp_path: Path, fields: dict[str, Any], words: tuple[str, ...]) -> None:
    study = content()
    study["poses"][0].update(fields)
    refused(written(tmp_path, study), *words)


@pytest.mark.parametrize("field", ["name", "q"])
def test_incomplete_pose(tmp_path: Path, field: str) -> None:
    study = content()
    del study["poses"][3][field]
    refused(written(tmp_path, study), f"poses.3.{field}", "is missing")


def test_no_poses(tmp_path: Path) -> None:
    study = content()
    study["poses"] = []
    refused(written(tmp_path, study), "poses")


def test_direction_in_which_a_pose_cannot_move(tmp_path: Path) -> None:
    robot = tmp_path / "column.xml"
    robot.write_text(
        "<mujoco><compiler angle='radian'/><worldbody><body><joint name='turn' axis='0 0 1'"
        " armature='0.1'/><inertial mass='1' pos='0.3 0 0' diaginertia='1 1 1'/>"
        "<site name='end' pos='0.5 0 0'/></body></worldbody></mujoco>"
    )
    file = changed({"robot": {"model": "column.xml", "tip": "end", "rotor_inertia": None}})
    file["poses"] = [{"name": "here", "q": [0.0]}, {"name": "there", "q": [0.5]}]
    file["task"]["pose_of"] = "here"
    path = written(tmp_path, file)
    refused(path, "impact.direction", "there", "cannot move")  # along +y only at angle zero


@pytest.mark.parametrize(("joint", "held"), [("stiffness='100'", True), ("", False)])
def test_what_has_neither_motor_nor_spring_is_refused(
    tmp_path: Path, joint: str, held: bool
) -> None:
    body = "<inertial mass='1' pos='0.3 0 0' diaginertia='1 1 1'/>"
    (tmp_path / "loose.xml").write_text(
        "<mujoco><worldbody><body><joint name='other' armature='0.1'/>"
        f"{body}<body><joint name='loose' armature='0.1' {joint}/>{body}"
        "<site name='end' pos='0.5 0 0'/></body></body></worldbody>"
        "<actuator><motor joint='other'/></actuator></mujoco>"
    )
    study = changed({"robot": {"model": "loose.xml", "tip": "end"}})
    what = "robot.rotor_inertia: unknown" if held else "robot.model: joint 'loose'"
    refused(written(tmp_path, study), what)


def test_a_misspelt_field_is_named_before_the_missing_one(tmp_path: Path) -> None:
    study = changed({"accuracy": {"max_deflection": None, "max_deflecton": 1e-3}})
    refused(
        written(tmp_path, study),
        "accuracy.max_deflecton: unknown; did you mean 'max_deflection'?",
        "and 1 more; softimpact check lists all",
    )


def test_built_in_studies_go_by_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert load_study("panda_24_poses").source == PANDA_24
    refused(Path("panda_24"), "no such study file; built in: cover_panda, leg_mini_cheetah")


def test_joints_that_are_locked_leave_the_arm(tmp_path: Path) -> None:
    """Coupled arms, too: the joint that follows a locked one stays where that puts it."""
    mimic = '<mimic joint="j1" multiplier="-1"/>'
    text = many_joints(7).replace("</joint>", f"{mimic}</joint>", 2).replace(mimic, "", 1)
    (tmp_path / "arm.urdf").write_text(text)
    robot = {"model": "arm.urdf", "tip": "tool", "rotor_inertia": 0.1, "lock": {"j1": 0.3}}
    content = changed({"robot": robot}, ("q9",))
    content["poses"] = [{"name": "q9", "q": [0.1, 0.2, 0.3, 0.4, 0.5]}]
    study = load_study(written(tmp_path, content))
    assert study.robot.joint_names == ("j3", "j4", "j5", "j6", "j7")
    whole = load_robot(tmp_path / "arm.urdf", "tool")
    same = arm_of(whole, "tool", locked={"j1": 0.3, "j2": -0.3}).robot
    q, n = [0.1, 0.2, 0.3, 0.4, 0.5], [0.0, 1.0, 0.0]
    found = study.model.reflected_mass(q, n)
    assert float(found) == pytest.approx(float(impact_model(same).reflected_mass(q, n)), rel=1e-12)
    content["robot"]["lock"] = {"j9": 0.0}
    refused(written(tmp_path, content), "unknown joint (robot.lock) 'j9'")


def test_missing_file(tmp_path: Path) -> None:
    refused(tmp_path / "none.toml", "no such study file")


def test_a_folder_is_no_study(tmp_path: Path) -> None:
    refused(tmp_path, "cannot be read")


def test_broken_toml(tmp_path: Path) -> None:
    path = tmp_path / "broken.toml"
    path.write_text("[robot\nmodel = 'panda'")
    refused(path, "not valid TOML", "line 1")


def test_not_utf_8(tmp_path: Path) -> None:
    path = tmp_path / "latin.toml"
    path.write_bytes(PANDA_24.read_bytes().replace(b"Franka", b"Fr\xe4nka"))
    refused(path, "cannot be read")


def test_empty_file(tmp_path: Path) -> None:
    path = tmp_path / "empty.toml"
    path.write_text("")
    refused(path, "robot", "is missing")


def test_a_section_that_is_no_table(tmp_path: Path) -> None:
    path = tmp_path / "flat.toml"
    path.write_text("impact = 'chest'\n" + PANDA_24.read_text().replace("[impact]", "[task2]"))
    refused(path, "impact")
    with pytest.raises(InvalidValue, match="impact"):
        load_study(path, {"impact": {"region": "head"}})


def test_robot_file_that_is_broken(tmp_path: Path) -> None:
    (tmp_path / "broken.xml").write_text("<mujoco><worldbody>")
    refused(written(tmp_path, changed({"robot": {"model": "broken.xml"}})), "robot", "broken.xml")


def test_overrides_replace_fields() -> None:
    study = load_study(PANDA_24, {"impact": {"region": "head", "speed": 0.25}})
    assert (study.contact.region.name, study.speed) == ("head", 0.25)
    np.testing.assert_array_equal(study.direction, [0.0, 1.0, 0.0])


@pytest.mark.parametrize(
    ("overrides", "field"),
    [
        ({"impact": {"region": "toe"}}, "impact.region"),
        ({"impact": {"speed": -1.0}}, "impact.speed"),
        ({"impact": {"speed": NAN}}, "impact.speed"),
        ({"impact": {"colour": 1}}, "impact.colour"),
        ({"paint": {"colour": 1}}, "paint"),
    ],
)
def test_overrides_are_checked_too(overrides: dict[str, dict[str, Any]], field: str) -> None:
    with pytest.raises(InvalidValue) as caught:
        load_study(PANDA_24, overrides)
    assert f"{PANDA_24}: {field}" in str(caught.value)
