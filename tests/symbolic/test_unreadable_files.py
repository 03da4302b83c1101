# SPDX-License-Identifier: BSD-3-Clause
"""Model files that cannot be read, or hold what a robot cannot."""

from __future__ import annotations

from pathlib import Path

import pytest
from robot_files import URDF, Read, arm

from softimpact.symbolic import (
    FrameNotFound,
    InvalidInertia,
    ModelFileError,
    UnknownName,
    UnsupportedModel,
    load_robot,
)


def test_inertia_from_a_mesh_is_refused(read: Read) -> None:
    """Its shapes alone would give too little."""
    text = """<mujoco><asset><mesh name="m" file="no.stl"/></asset><worldbody>
      <body name="b">{}<geom type="mesh" mesh="m"/><geom size="0.1"/></body></worldbody></mujoco>"""
    with pytest.raises(
        InvalidInertia, match=r"body 'b': takes its inertia from a mesh.*<inertial>"
    ):
        read(text.format("<joint/>"))
    always = text.replace("<asset>", '<compiler inertiafromgeom="true"/><asset>')
    inertial = '<joint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
    with pytest.raises(InvalidInertia, match="takes its inertia from a mesh"):
        read(always.format(inertial))
    assert read(text.format(inertial)).n == 1
    massless = text.replace('mesh="m"/>', 'mesh="m" mass="0"/>')
    assert read(massless.format("<joint/>")).n == 1


@pytest.mark.parametrize("name", ["gone.xml", "gone.urdf"])
def test_missing_file(tmp_path: Path, name: str) -> None:
    with pytest.raises(ModelFileError, match=r"gone\.\w+: no such file") as caught:
        load_robot(tmp_path / name)
    assert caught.value.path.endswith(name)


def test_unknown_robot_lists_the_built_in_ones(tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match=r"'pandas'; known: .*panda.*rr") as caught:
        load_robot("pandas")
    assert "panda" in caught.value.known
    wrong = tmp_path / "robot.sdf"
    wrong.write_text("<sdf/>")
    with pytest.raises(ModelFileError, match=r"robot\.sdf: is SDF; convert it to URDF or MJCF"):
        load_robot(wrong)


def test_a_text_of_another_kind(read: Read) -> None:
    with pytest.raises(
        ModelFileError, match=r"not a URDF or MJCF: it is no XML, nor does its name"
    ):
        read("# A page", ".md")


@pytest.mark.parametrize("suffix", [".xml", ".urdf"])
@pytest.mark.parametrize(
    "text", ["", "<mujoco", "<html/>", "not xml", "<mujoco><nonsense/></mujoco>"]
)
def test_broken_xml(read: Read, text: str, suffix: str) -> None:
    with pytest.raises(ModelFileError, match="not a URDF or MJCF") as caught:
        read(text, suffix)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mass": "-1"}, r"body 'arm': mass is negative \(-1 kg\)"),
        ({"mass": "nan"}, "body 'arm': mass must be a finite number"),
        ({"mass": "inf"}, "body 'arm': mass must be a finite number"),
        (
            {"mass": "0", "inertia": "0 0 0"},
            r"body 'arm': moves but has no mass and inertia > 0.*'j1'; give it an <inertial>",
        ),
        ({"inertia": "1 1 -1"}, "body 'arm': .*negative for joint 'j1'.*not positive definite"),
    ],
)
def test_impossible_inertia_of_mjcf(read: Read, changes: dict[str, str], message: str) -> None:
    with pytest.raises(InvalidInertia, match=message) as caught:
        read(arm(**changes))
    assert caught.value.body == "arm"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mass": -1}, "body 'arm': mass is negative"),
        ({"mass": "nan"}, "body 'arm': mass must be a finite number"),
    ],
)
def test_impossible_inertia_of_urdf(read: Read, changes: dict[str, str], message: str) -> None:
    with pytest.raises(InvalidInertia, match=message):
        read(URDF.format(**{"mass": 1, "izz": 0.04, "kind": "revolute"} | changes), ".urdf")


@pytest.mark.parametrize(
    ("inertia", "doubt"),
    [
        ("1 1 3", "violates the triangle inequality"),
        ("1 -1 1", "has a negative moment of inertia"),
        ("1 1 2.000001", "violates the triangle inequality"),
    ],
)
def test_impossible_inertia_that_the_joint_cannot_feel(
    read: Read, inertia: str, doubt: str
) -> None:
    """The mass matrix stays positive definite: a warning."""
    robot = read(arm(inertia=inertia))
    assert any("body 'arm'" in line and doubt in line for line in robot.warnings)


def test_urdf_without_inertia(read: Read) -> None:
    text = URDF.format(mass=1, izz=0.04, kind="revolute")
    start, end = text.index("<inertial>"), text.index("</inertial>") + len("</inertial>")
    with pytest.raises(InvalidInertia, match="body 'arm': moves but has no mass and inertia"):
        read(text[:start] + text[end:], ".urdf")


@pytest.mark.parametrize(
    "changes",
    [
        {"inertia": "nan 1 1"},
        {"com": "nan 0 0"},
        {"joint": 'armature="nan"'},
        {"joint": 'axis="0 nan 1"'},
        {"joint": 'range="nan 1"'},
    ],
)
def test_nan_anywhere(read: Read, changes: dict[str, str]) -> None:
    with pytest.raises(ModelFileError, match="NaN"):
        read(arm(**changes))


@pytest.mark.parametrize("field", ["armature", "stiffness"])
def test_negative_armature_and_stiffness(read: Read, field: str) -> None:
    with pytest.raises(ModelFileError, match=f"joint 'j1': {field} is negative"):
        read(arm(joint=f'{field}="-0.1"'))


@pytest.mark.parametrize("field", ["armature", "stiffness", "ref", "springref"])
def test_infinity_anywhere(read: Read, field: str) -> None:
    with pytest.raises(ModelFileError, match="a number is infinite"):
        read(arm(joint=f'{field}="inf"'))


def test_names_that_are_not_utf_8(tmp_path: Path) -> None:
    path = tmp_path / "robot.xml"
    path.write_bytes(arm(inside='<site name="Füße"/>').encode("latin-1"))
    with pytest.raises(ModelFileError, match="names are not in UTF-8"):
        load_robot(path)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"joint": 'type="ball"'}, "joint 'j1' is a ball joint; write it as three hinges"),
        ({"joint": 'type="free"'}, "joint 'j1' is a free joint; .* floating=True"),
        ({"after": '<equality><weld body1="arm"/></equality>'}, "equality weld.*connect"),
        ({"joint": 'stiffness="100 5 7"'}, "springs whose stiffness depends on the deflection"),
    ],
)
def test_unsupported_models(read: Read, changes: dict[str, str], message: str) -> None:
    with pytest.raises(UnsupportedModel, match=message):
        read(arm(**changes))


def test_floating_urdf_base(read: Read) -> None:
    text = URDF.format(mass=1, izz=0.04, kind="floating")
    with pytest.raises(UnsupportedModel, match="'j1' is a free joint"):
        read(text, ".urdf")


def test_a_model_without_joints(read: Read) -> None:
    with pytest.raises(ModelFileError, match="has no joints"):
        read('<mujoco><worldbody><geom size="1"/></worldbody></mujoco>')


def test_a_tip_that_is_not_there(read: Read) -> None:
    with pytest.raises(FrameNotFound, match="'finger'; known: arm, hand"):
        read(arm(), tip="finger")
    with pytest.raises(FrameNotFound, match="'palm'"):
        read(arm().replace('data="hand"', 'data="palm"'))


def test_reading_leaves_nothing_behind(
    read: Read, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """MuJoCo writes its warnings to a log in the working directory if it is let."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ModelFileError):
        read(arm(mass="nan"))
    assert [path.name for path in tmp_path.iterdir()] == ["robot.xml"]
