# SPDX-License-Identifier: BSD-3-Clause
"""What a robot file is, told by its content, whatever its name."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from robot_files import two_links, two_links_urdf, urdf_inertial

from softimpact.symbolic import (
    ModelFileError,
    Robot,
    arm_of,
    impact_model,
    load_robot,
    mass_matrix,
)


def felt(robot: Robot) -> float:
    """Mass felt at the tool along x with rigid joints [kg]."""
    arm = arm_of(robot, "tool").robot
    return float(impact_model(arm).reflected_mass([0.3, 1.2], [1.0, 0.0, 0.0]))


@pytest.mark.parametrize(
    ("name", "start", "end"),
    [
        ("robot.URDF", b"", b""),
        ("robot.xml", b"", b""),
        ("robot", b"", b""),
        ("robot.urdf", b"\xef\xbb\xbf", b""),
        ("robot.urdf", b"\n \n", b"\n\n"),
        ("robot.urdf", b"<!-- <mujoco/> -->", b""),
    ],
)
def test_content_decides_and_not_the_name(
    tmp_path: Path, name: str, start: bytes, end: bytes
) -> None:
    text = two_links_urdf().encode()
    text = text.removeprefix(b'<?xml version="1.0"?>') if start.startswith(b"<") else text
    for content in (start + text + end, (start + text + end).replace(b"\n", b"\r\n")):
        path = tmp_path / name
        path.write_bytes(content)
        assert felt(load_robot(path)) == pytest.approx(0.473499, abs=1e-6)
    if not start.startswith(b"\xef"):
        path.write_text((start + text).decode().strip(), encoding="utf-16")
        assert felt(load_robot(path)) == pytest.approx(0.473499, abs=1e-6)


@pytest.mark.parametrize("start", [b"\xef\xbb\xbf", b""])
def test_mjcf_whatever_it_is_called(tmp_path: Path, start: bytes) -> None:
    path = tmp_path / "robot.urdf"
    path.write_bytes(start + two_links().strip().encode().replace(b"\n", b"\r\n"))
    assert felt(load_robot(path)) == pytest.approx(0.359356, abs=1e-6)


XACRO = two_links_urdf(
    top='xmlns:xacro="http://www.ros.org/wiki/xacro"',
    before='<xacro:property name="m" value="2"/>',
    upper=urdf_inertial("${m}", "0.2"),
)


def test_xacro_is_expanded(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    path = tmp_path / "arm.urdf.xacro"
    path.write_text(XACRO)
    assert felt(load_robot(path)) == pytest.approx(0.473499, abs=1e-6)
    path.write_text(XACRO.replace("${m}", "${nothing}"))
    with pytest.raises(ModelFileError, match=r"arm\.urdf\.xacro: xacro does not expand"):
        load_robot(path)


def test_xacro_of_several_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Includes beside the file and of a package above it; missing meshes do not stop it."""
    pytest.importorskip("xacrodoc")
    described = tmp_path / "two_description"
    (described / "urdf").mkdir(parents=True)
    (described / "package.xml").write_text("<package><name>two_description</name></package>")
    space = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
    mass = f'<robot {space}><xacro:property name="m" value="${{1 + 1}}"/></robot>'
    (described / "mass.xacro").write_text(mass)
    visual = '<visual><geometry><mesh filename="package://nowhere/a.dae"/></geometry></visual>'
    path = described / "urdf/arm.xacro"
    monkeypatch.chdir(tmp_path.parent)
    for include in ("../mass.xacro", "$(find two_description)/mass.xacro"):
        named = f'<xacro:include filename="{include}"/>'
        text = XACRO.replace('<xacro:property name="m" value="2"/>', named)
        path.write_text(text.replace("</link>", f"{visual}</link>", 1))
        assert felt(load_robot(path)) == pytest.approx(0.473499, abs=1e-6)
    path.write_text(path.read_text().replace("two_description)", "nowhere)"))
    with pytest.raises(ModelFileError, match=r"not found: nowhere; put the package"):
        load_robot(path)


def test_each_xacro_has_its_own_packages(tmp_path: Path) -> None:
    """By the names of folders, which need no package.xml; the file before leaves nothing behind."""
    pytest.importorskip("xacrodoc")
    include = '<xacro:include filename="$(find two_masses)/urdf/mass.xacro"/>'
    text = XACRO.replace('<xacro:property name="m" value="2"/>', include)
    space = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
    found = []
    for mass in ("2", "5"):
        for package, file in (("two_masses", "mass"), ("two_description", "arm")):
            (tmp_path / mass / package / "urdf").mkdir(parents=True)
            body = f'<robot {space}><xacro:property name="m" value="{mass}"/></robot>'
            path = tmp_path / mass / package / "urdf" / f"{file}.xacro"
            path.write_text(text if file == "arm" else body)
        found.append(sum(joint.inertia.mass for joint in load_robot(path).joints))
    assert found[1] - found[0] == pytest.approx(3)


def test_xacro_without_its_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "xacrodoc", None)
    path = tmp_path / "arm.xacro"
    path.write_text(XACRO)
    with pytest.raises(ModelFileError, match="is xacro: install xacrodoc"):
        load_robot(path)


def test_names_of_robot_descriptions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "robot_descriptions"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (tmp_path / "two.urdf").write_text(two_links_urdf())
    path = str(tmp_path / "two.urdf")
    (package / "two_links_description.py").write_text(f"URDF_PATH = {path!r}\n")
    (package / "offline_description.py").write_text("raise OSError('no network')\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert felt(load_robot("two_links_description")) == pytest.approx(0.473499, abs=1e-6)
    with pytest.raises(ModelFileError, match="cannot fetch it: no network"):
        load_robot("offline_description")


@pytest.mark.parametrize("axis", ["1 0 0", "0 0 1"])
def test_balanced_inertias_are_their_mean(tmp_path: Path, axis: str) -> None:
    """MJCF's ``balanceinertia``: moments that no body can have become their mean."""
    path = tmp_path / "thin.xml"
    path.write_text(
        "<mujoco><compiler balanceinertia='true'/><worldbody><body>"
        f"<joint name='turn' axis='{axis}'/>"
        "<inertial mass='2' pos='0 0 0' diaginertia='.01 .02 .54'/>"
        "<site name='tip' pos='.1 .1 .1'/></body></worldbody></mujoco>"
    )
    robot = load_robot(path, "tip")
    M = float(mass_matrix(robot, [0.0]))
    compiled = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(compiled)
    mujoco.mj_forward(compiled, data)
    theirs = np.zeros((1, 1))
    mujoco.mj_fullM(compiled, data, theirs)
    assert pytest.approx(0.57 / 3) == M
    assert pytest.approx(theirs[0, 0]) == M
