# SPDX-License-Identifier: BSD-3-Clause
"""Kinds of files that people have: what of them counts, and what may not stop them.

Masses at the tool are right values by MuJoCo's ``mj_fullM``, Pinocchio, or by hand.
"""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from oracles import Mujoco, assert_near
from robot_files import URDF_LIMIT, Read, felt, two_links, two_links_urdf, urdf_inertial

from softimpact.symbolic import (
    InvalidInertia,
    ModelFileError,
    UnsupportedModel,
    arm_of,
    chain_to,
    impact_model,
    load_robot,
    mass_matrix,
)

Q = [0.3, 1.2]


MOTORS = (
    '<motor joint="j1" gear="100" armature="1e-4"/><motor joint="j2" gear="50" armature="1e-4"/>'
)
COUPLED_TENDON = (
    '<tendon><fixed name="t" {}><joint joint="j1" coef="1"/><joint joint="j2" coef="-1"/></fixed>'
    "</tendon>"
)


@pytest.mark.parametrize(
    ("changes", "mass"),
    [
        ({}, 0.359356),
        ({"after": f"<actuator>{MOTORS}</actuator>"}, 2.411039),
        ({"after": COUPLED_TENDON.format('armature="0.5"')}, 0.883269),
        # a motor on a tendon over one joint is a motor on that joint
        (
            {
                "after": '<tendon><fixed name="t"><joint joint="j2" coef="2"/></fixed></tendon>'
                '<actuator><motor joint="j1" gear="100" armature="1e-4"/>'
                '<motor tendon="t" gear="25" armature="1e-4"/></actuator>'
            },
            2.411039,
        ),
    ],
)
def test_rotors_and_tendons_count(read: Read, changes: dict[str, str], mass: float) -> None:
    assert felt(read(two_links(**changes))) == pytest.approx(mass, abs=1e-6)


def test_a_motor_on_a_tendon_is_a_motor(read: Read) -> None:
    tendon = '<tendon><fixed name="t"><joint joint="j2" coef="1"/></fixed></tendon>'
    both = '<actuator><motor joint="j1"/><motor tendon="t"/></actuator>'
    assert read(two_links(after=tendon + both)).actuated == (True, True)
    shared = COUPLED_TENDON.format("") + '<actuator><motor name="m" tendon="t"/></actuator>'
    robot = read(two_links(after=shared))
    assert robot.actuated == (True, True)
    assert any("motor 'm' drives 'j1', 'j2' together" in line for line in robot.warnings)
    alone = '<actuator><motor joint="j1"/></actuator>'
    assert read(two_links(after=alone)).actuated == (True, False)


def test_hinges_of_a_ball_have_its_numbers(read: Read) -> None:
    ball = (
        '<body name="bob"><joint name="b" type="ball" damping="0.2" armature="0.3"'
        ' frictionloss="0.4"/><geom size=".1"/></body>'
    )
    joints = read(two_links(j1='damping="5" armature="6" frictionloss="7"', on_upper=ball)).joints
    of_ball = [joint for joint in joints if joint.name.startswith("b_")]
    found = [(joint.damping, joint.armature, joint.friction) for joint in of_ball]
    assert found == [(0.2, 0.3, 0.4)] * 3


def test_what_is_unread_several_times_is_counted(read: Read) -> None:
    both = {"on_j1": "<dynamics spring='1'/>", "on_j2": "<dynamics spring='1'/>"}
    robot = read(two_links_urdf(**both), ".urdf")
    assert "'dynamics spring' is not read (2 times)" in robot.warnings


CAMERA = (
    '<link name="camera"><inertial><mass value="0.05"/><inertia ixx="1e-4" ixy="0" ixz="0" '
    'iyy="1e-4" iyz="0" izz="{}"/></inertial></link><joint name="jc" type="fixed">'
    '<parent link="{}"/><child link="camera"/></joint>'
)


@pytest.mark.parametrize(
    ("changes", "mass"),
    [
        ({}, 0.473499),
        ({"after": CAMERA.format("0.01", "base")}, 0.473499),  # never moves
        ({"after": CAMERA.format("1e-2", "upper").replace("0.05", "1e-9")}, None),  # heavier parent
        ({"fore": urdf_inertial("1", "0.15", "0", "0.0075", "0.0075")}, 0.330596),  # a thin rod
        ({"upper": ""}, 0.472764),  # nothing between the joints
        ({"tool": "<visual><geometry><mesh filename='no.dae'/></geometry></visual>"}, 0.473499),
        ({"tool": "<collision><geometry><box size='1 1 1'/></geometry></collision>"}, 0.473499),
        ({"fore": urdf_inertial("1", "0.15") + "<visual><box/><nonsense/></visual>"}, 0.473499),
        ({"before": "<material name='a'/><material name='a'/>"}, 0.473499),
        ({"after": "<drake:thing x='1'/>"}, 0.473499),  # a prefix that nobody declares
        ({"after": "<!-- a -- b -->"}, 0.473499),
        # a gripper without mass, off the arm
        (
            {
                "after": '<link name="cup"/><joint name="jc" type="prismatic">'
                '<parent link="upper"/><child link="cup"/><axis xyz="0 0 1"/></joint>'
            },
            0.473499,
        ),
    ],
)
def test_nothing_but_the_masses_of_the_arm_counts(
    read: Read, changes: dict[str, str], mass: float | None
) -> None:
    found = felt(read(two_links_urdf(**changes), ".urdf"))
    assert mass is None or found == pytest.approx(mass, abs=1e-6)


def test_missing_inertias_are_named_together(read: Read) -> None:
    wrist = (
        '<link name="wrist"/><joint name="j3" type="revolute"><parent link="tool"/>'
        f'<child link="wrist"/><axis xyz="1 0 0"/>{URDF_LIMIT}</joint><link name="end"/>'
        f'<joint name="j4" type="revolute"><parent link="wrist"/><child link="end"/>'
        f'<axis xyz="0 1 0"/>{URDF_LIMIT}</joint>'
    )
    robot = read(two_links_urdf(after=wrist), ".urdf")
    with pytest.raises(InvalidInertia, match=r"'wrist'.*\(so do 'end'\)"):
        chain_to(robot, "end")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"limit": URDF_LIMIT.replace("-3", "4")}, "'j1': its lower limit 4 is above its upper 3"),
        ({"second": "j1"}, "two joints go by 'j1'"),
        ({"on_j1": '<axis xyz="0 0 0"/>'}, None),
        ({"limit": '<limit lower="a" upper="3"/>'}, "joint 'j1': lower: 'a' is not a number"),
        ({"upper": "<inertial><inertia/></inertial>"}, "body 'upper': its <inertial> has no <mass"),
        ({"after": '<link name="fore"/>'}, "two links go by 'fore'"),
        ({"before": '<!DOCTYPE x [<!ENTITY a "b">]>'}, "not a URDF or MJCF"),
        ({"type1": "ball"}, "unknown type of joint 'j1' 'ball'"),
        ({"on_j2": '<mimic joint="j2"/>'}, "joint 'j2' mimics itself"),
        ({"second": ""}, "a joint has no name"),
    ],
)  # fmt: skip
def test_urdfs_that_are_wrong(read: Read, changes: dict[str, str], message: str | None) -> None:
    from softimpact.symbolic import SoftImpactError

    if message is None:  # the first axis counts
        assert read(two_links_urdf(**changes), ".urdf").n == 2
        return
    with pytest.raises(SoftImpactError, match=message) as caught:
        read(two_links_urdf(**changes), ".urdf")
    assert "\n" not in str(caught.value)


def test_reversed_limits_of_mjcf(read: Read) -> None:
    with pytest.raises(ModelFileError, match="joint 'j1': its lower limit 2 is above its upper -2"):
        read(two_links(j1='range="2 -2"'))


MESH = '<geom type="mesh" mesh="m" group="3"/>'
CAPSULE = '<geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.04"/>'
ASSET = '<asset><mesh name="m" file="nothere.stl"/></asset>'


def test_meshes_outside_the_groups_that_count(read: Read) -> None:
    groups = {"compiler": 'inertiagrouprange="0 2"', "inertial": "", "on_fore": CAPSULE + MESH}
    assert felt(read(two_links(after=ASSET, **groups))) == pytest.approx(0.654916, abs=1e-6)
    with pytest.raises(InvalidInertia, match=r"body 'fore'.*mesh.*nothere\.stl"):
        read(two_links(after=ASSET, inertial="", on_fore=CAPSULE + MESH))


def test_meshes_count_where_they_are_there(read: Read) -> None:
    from oracles import Mujoco

    vertices = '<asset><mesh name="m" vertex="0 0 0 .1 0 0 0 .1 0 0 0 .4"/></asset>'
    text = two_links(after=vertices, inertial="", on_fore='<geom type="mesh" mesh="m"/>')
    robot = read(text)
    M = impact_model(arm_of(robot, "tool").robot).mass_matrix(Q)
    assert_near(M, Mujoco(text).at(np.array(Q)).mass_matrix())
    broken = vertices.replace(".1 0 0 0 .1 0 0 0 .4", "0 0 0")
    with pytest.raises(ModelFileError, match="mesh"):
        read(two_links(after=broken, inertial="", on_fore='<geom type="mesh" mesh="m"/>'))


CUBE = '<body name="cube" pos="1 0 0"><freejoint/><geom type="box" size=".1 .1 .1"/></body>'
MOCAP = '<body name="target" mocap="true"><geom size=".1"/></body>'


def test_materials_of_all_that_has_them(read: Read) -> None:
    """What only rendering needs goes, and takes nothing along: sites and lights use it, too."""
    looks = (
        '<asset><texture name="t" type="2d" builtin="flat" width="8" height="8"/>'
        '<material name="m" texture="t"/></asset>'
    )
    seen = '<site name="s" material="m"/><light type="image" texture="t"/>'
    shapes = '<geom type="box" size="0.1 0.05 0.02" material="m"/>'
    text = two_links(before=looks, beside=seen, on_upper=seen.replace('"s"', '"s2"'),
                     inertial="", on_fore=shapes)  # fmt: skip
    q = np.array([0.3, 1.2])
    assert_near(
        mass_matrix(chain_to(read(text), "tool"), q), Mujoco(text).at(q).mass_matrix(), 1e-12
    )


@pytest.mark.parametrize("kind", ["hinge", "slide"])
def test_springs_by_their_time_constant(read: Read, kind: str) -> None:
    """MuJoCo finds stiffness and damping from inertias; a file without its meshes has none."""
    text = two_links(
        j1='springdamper="0.1 0.7" armature="0.2"', j2=f'springdamper="0.05 1" type="{kind}"'
    )
    model = mujoco.MjModel.from_xml_string(text)
    joints = read(text).joints
    assert_near([joint.stiffness for joint in joints], model.jnt_stiffness, 1e-12)
    assert_near([joint.damping for joint in joints], model.dof_damping, 1e-12)
    mesh = '<asset><mesh name="far" file="nowhere.stl"/></asset>'
    shape = '<geom type="mesh" mesh="far"/>'
    with pytest.raises(UnsupportedModel, match=r"'j1': springdamper needs .*nowhere\.stl"):
        read(text.replace("<worldbody>", f"{mesh}<worldbody>{shape}", 1))


def test_what_stands_beside_the_robot(read: Read) -> None:
    plain = felt(read(two_links()))
    robot = read(two_links(beside=CUBE + '<geom type="plane" size="1 1 1"/>'))
    assert felt(robot) == pytest.approx(plain)
    assert any("'cube'" in line for line in robot.warnings)
    tied = two_links(beside=MOCAP, after='<equality><weld body1="target" body2="fore"/></equality>')
    robot = read(tied)
    assert felt(robot) == pytest.approx(plain)
    assert any("ties the robot to what stands beside it" in line for line in robot.warnings)
    ball = '<body name="bob"><joint name="b" type="ball"/><geom size=".001"/></body>'
    robot = read(two_links(on_upper=ball))
    assert felt(robot) == pytest.approx(plain, rel=1e-3)
    with pytest.raises(UnsupportedModel, match="'b' is a ball joint"):
        chain_to(robot, "bob")


def test_several_roots(read: Read) -> None:
    other = (
        '<body name="other" pos="0 2 0"><joint name="o" axis="0 0 1"/><geom size=".1"/>'
        '<site name="o_tool" pos="0.5 0 0"/></body>'
    )
    robot = read(two_links(beside=other))
    assert felt(robot) == pytest.approx(felt(read(two_links())))
    assert chain_to(robot, "o_tool").joint_names == ("o",)
    urdf = two_links_urdf(after='<link name="stray"/>')
    robot = read(urdf, ".urdf")
    assert felt(robot) == pytest.approx(0.473499, abs=1e-6)
    assert "has 2 roots: base, stray" in robot.warnings


STANDING = two_links(beside="").replace(
    '<body name="upper" >',
    '<body name="trunk" pos="0 0 0.5" euler="0 0 1"><freejoint name="f"/><geom size=".2"/>'
    '<body name="upper">',
).replace("</worldbody>", "</body></worldbody>")  # fmt: skip


def test_robots_that_float_or_stand(tmp_path: Path) -> None:
    path = tmp_path / "standing.xml"
    path.write_text(STANDING)
    with pytest.raises(UnsupportedModel, match=r"'f' is a free joint.*--hold-base.*--floating"):
        load_robot(path)
    held = load_robot(path, hold_base=True)
    turned = [np.cos(1.0), np.sin(1.0), 0.0]
    assert felt(held, Q, turned) == pytest.approx(0.359356, abs=1e-6)
    assert_near(held.frame("trunk").placement.translation, [0, 0, 0.5])
    free = load_robot(path, floating=True)
    assert_near(free.frame("trunk").placement.translation, [0, 0, 0])
    assert free.base_inertia.mass > 0


def test_a_floor_is_no_part_of_what_floats(tmp_path: Path) -> None:
    path = tmp_path / "standing.xml"
    table = '<geom type="plane" size="1 1 1"/><body name="table"><geom size="1"/></body>'
    path.write_text(STANDING.replace("<worldbody>", f"<worldbody>{table}"))
    free = load_robot(path, floating=True)
    path.write_text(STANDING)
    assert free.base_inertia.mass == pytest.approx(
        load_robot(path, floating=True).base_inertia.mass
    )


def test_nameless_bodies_go_by_their_number(read: Read) -> None:
    text = two_links().replace('name="upper"', "").replace('name="fore"', "")
    assert {"body1", "body2", "tool"} == set(read(text).frames)


@pytest.mark.parametrize(
    ("text", "suffix", "doubt"),
    [
        (two_links(j1='armature="0.1"', j2='armature="0.1"',
                   on_fore='<body><joint armature="0.1"/><geom size=".1"/></body>'), ".xml",
         "an armature of 0.1 at every joint looks like a placeholder"),
        (two_links_urdf(limit=URDF_LIMIT.replace("3", "180")), ".urdf", "look like degrees"),
        (two_links_urdf(fore=urdf_inertial("1", "0.1", "1e-7", "1e-7", "1e-7")), ".urdf",
         "implausible density: 'fore'"),
        (two_links_urdf(limit='<limit effort="1" velocity="1"/>'), ".urdf", "'j1' has no limits"),
        (two_links_urdf(limit=URDF_LIMIT.replace("-3", "3")), ".urdf", "'j1' leave it no room"),
        (two_links_urdf(upper=""), ".urdf", "without mass between or after joints: 'upper'"),
        (two_links_urdf(after="<transmission/>"), ".urdf", "transmissions are not read"),
        (two_links_urdf(on_j1="<dynamics spring='1'/>"), ".urdf", "'dynamics spring' is not read"),
    ],
)  # fmt: skip
def test_what_looks_wrong_is_said(read: Read, text: str, suffix: str, doubt: str) -> None:
    assert any(doubt in line for line in read(text, suffix).warnings)


def test_joints_welded_outside_their_limits(read: Read) -> None:
    far = URDF_LIMIT.replace("-3", "0.5")
    robot = read(two_links_urdf(limit2=far), ".urdf")
    assert chain_to(robot, "upper").warnings[-1] == (
        "joints welded outside their limits: 'j2' at 0"
    )
    assert not any("outside" in line for line in chain_to(robot, "tool").warnings)


def test_numbers_of_the_drives_are_read(read: Read) -> None:
    urdf = two_links_urdf(on_j1='<dynamics damping="3" friction="0.5"/>')
    joint = read(urdf, ".urdf").joints[0]
    assert (joint.damping, joint.friction) == (3.0, 0.5)
    assert (joint.torque_limit, joint.speed_limit) == (50.0, 2.0)
    actuators = (
        '<actuator><position joint="j1" kp="100" kv="7" gear="2" forcerange="-5 4"/>'
        '<motor joint="j2" gear="10" ctrlrange="-2 3" ctrllimited="true"/></actuator>'
    )
    first, second = read(two_links(j1='damping="1.5"', after=actuators)).joints
    assert (first.position_gain, first.velocity_gain, first.torque_limit) == (400.0, 28.0, 10.0)
    assert (first.damping, second.torque_limit, second.position_gain) == (1.5, 30.0, 0.0)
    limited = two_links(j2='actuatorfrcrange="-9 9"', after=actuators)
    assert read(limited).joints[1].torque_limit == 9.0
