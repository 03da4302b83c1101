# SPDX-License-Identifier: BSD-3-Clause
"""Reading URDF and MJCF, against MuJoCo's own dynamics."""

from __future__ import annotations

import numpy as np
import pytest
from oracles import Mujoco, assert_near, example_urdf
from robot_files import URDF, Read, arm

from softimpact.symbolic import (
    ModelFileError,
    bias_torques,
    frame_jacobian,
    frame_pose,
    gravity_torques,
    load_robot,
    mass_matrix,
)
from softimpact.symbolic.robot.robot import JointKind

AWKWARD = """
<mujoco model="awkward">
  <compiler angle="degree" eulerseq="zyx"/>
  <default><joint armature="0.2"/></default>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <site name="on_the_floor" pos="1 2 0"/>
    <body name="base" pos="0.1 0.2 0.3" euler="10 20 30">
      <geom type="box" size="0.1 0.1 0.1"/>
      <body name="carriage" pos="0 0 0.1" quat="1 2 3 4">
        <joint name="x" type="slide" axis="1 0 0.5" pos="0.3 0 0" range="-1 1"/>
        <joint name="y" type="slide" axis="0 1 0" ref="0.25" armature="0"/>
        <joint name="turn" axis="1 1 1" pos="0.05 0.1 -0.1" ref="40" springref="20" stiffness="7"/>
        <joint name="tilt" axis="0 -1 0" pos="-0.1 0 0.2" stiffness="3"/>
        <geom type="capsule" fromto="0 0 0 0.2 0.3 0.1" size="0.05" density="900"/>
        <geom type="sphere" pos="0.3 0 0" size="0.08" mass="2"/>
        <body name="bracket" pos="0.1 0 0" euler="0 90 0">
          <inertial mass="0.7" pos="0.02 0.01 0" fullinertia="0.03 0.02 0.04 0.001 -0.002 0.003"/>
          <body name="camera" pos="0 0.05 0.02" axisangle="1 0 1 33">
            <inertial mass="0.2" pos="0 0 0.01" diaginertia="1e-3 2e-3 2.5e-3"/>
            <site name="lens" pos="0 0 0.03" euler="5 6 7"/>
          </body>
        </body>
        <body name="left" pos="0 0.3 0">
          <joint name="left" axis="0 0 -1" pos="0 0 0.4"/>
          <geom type="ellipsoid" size="0.1 0.05 0.2"/>
          <site name="left_tip" pos="0.3 0 0" quat="1 1 0 0"/>
        </body>
        <body name="right" pos="0 -0.3 0" euler="180 0 0">
          <joint name="right" type="slide" axis="0.3 0 1" pos="1 2 3" ref="-0.1" springref="0.05"
                 stiffness="50"/>
          <geom type="cylinder" size="0.1 0.2"/>
          <site name="right_tip" pos="0 0.2 0.1"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint="turn"/><position joint="left" kp="10"/></actuator>
</mujoco>
"""
"""Several joints on one body, anchors off its origin, references that are not zero, bodies without
joints in between, inertias from geoms, branches."""


def test_awkward_mjcf_agrees_with_mujoco(read: Read) -> None:
    robot, oracle = read(AWKWARD), Mujoco(AWKWARD)
    gravity = tuple(oracle.model.opt.gravity)
    random = np.random.default_rng(3)
    for _ in range(5):
        q, velocity = random.uniform(-1, 1, (2, robot.n))
        oracle.at(q, velocity)
        M = np.array(mass_matrix(robot, q)) + np.diag(robot.armature)
        assert_near(M, oracle.mass_matrix())
        assert_near(bias_torques(robot, q, velocity, gravity), oracle.bias())
        # the potential includes the file's springs, the bias torques do not
        gravity_only = bias_torques(robot, q, 0 * q, gravity)
        springs = np.array(gravity_torques(robot, q, gravity) - gravity_only).ravel()
        assert_near(-springs, oracle.spring_torques())
        for site in ("on_the_floor", "lens", "left_tip", "right_tip"):
            assert_near(frame_jacobian(robot, site, q), oracle.site_jacobian(site))
            assert_near(frame_pose(robot, site, q).position, oracle.site_position(site))
            theirs = oracle.data.site(site).xmat.reshape(3, 3)
            assert_near(frame_pose(robot, site, q).rotation, theirs)


def test_awkward_mjcf_is_read_in_the_files_order(read: Read) -> None:
    robot = read(AWKWARD)
    assert robot.joint_names == ("x", "y", "turn", "tilt", "left", "right")
    assert [j.kind for j in robot.joints[:3]] == [JointKind.SLIDE, JointKind.SLIDE, JointKind.HINGE]
    assert [j.parent for j in robot.joints] == [-1, 0, 1, 2, 3, 3]
    assert robot.actuated == (False, False, True, False, True, False)
    assert_near(robot.armature, [0.2, 0.0, 0.2, 0.2, 0.2, 0.2])
    lower, upper = robot.limits
    assert (lower[0], upper[0], lower[1]) == (-1, 1, -np.inf)
    assert robot.name == "awkward"
    assert robot.tip is None
    assert {"base", "carriage", "bracket", "camera", "lens", "left_tip"} <= set(robot.frames)


def test_built_in_robots_agree_with_mujoco_itself() -> None:
    from softimpact.robots import built_in_robots

    for name, path in built_in_robots().items():
        robot, oracle = load_robot(name), Mujoco(path)
        random = np.random.default_rng(4)
        q, velocity = random.uniform(-1, 1, (2, robot.n))
        oracle.at(q, velocity)
        M = np.array(mass_matrix(robot, q)) + np.diag(robot.armature)
        assert_near(M, oracle.mass_matrix())
        assert_near(bias_torques(robot, q, velocity), oracle.bias())


def test_urdf_needs_no_meshes(read: Read) -> None:
    robot = read(URDF.format(mass=1, izz=0.04, kind="revolute"), ".urdf")
    assert robot.joint_names == ("j1",)
    assert_near(robot.limits, [[-1], [2]])
    assert set(robot.frames) == {"arm", "tool"}
    assert_near(frame_pose(robot, "tool", [0.0]).position, [0, 0, 0.5])
    # roll, pitch and yaw of a right angle leave no digits behind
    assert set(np.unique(robot.joints[0].placement.rotation.round(15))) <= {-1.0, 0.0, 1.0}
    R = robot.joints[0].placement.rotation
    assert np.array_equal(R, R.round())


def test_urdf_slide(read: Read) -> None:
    robot = read(URDF.format(mass=2.5, izz=0.04, kind="prismatic"), ".urdf")
    assert robot.joints[0].kind is JointKind.SLIDE
    assert_near(mass_matrix(robot, [0.3]), 2.5)
    assert_near(frame_pose(robot, "tool", [0.3]).position, [0, 0.3, 0.5])


def test_urdf_from_the_wild_lacks_its_meshes_too() -> None:
    assert load_robot(example_urdf("xarm7.urdf")).n == 7


@pytest.mark.parametrize(
    "changes",
    [
        {
            "asset": '<mesh name="m" file="no.stl"/>',
            "inside": '<geom name="g" type="mesh" mesh="m"/>',
            "after": '<sensor><framepos objtype="geom" objname="g"/></sensor>',
        },
        {
            "asset": '<texture name="t" type="2d" file="no.png"/><material name="m" texture="t"/>',
            "inside": '<geom size="1" material="m"/><site name="s" material="m"/>',
        },
        {"after": '<deformable><skin name="s" file="no.skn"/></deformable>'},
        {
            "asset": '<hfield name="h" file="no.png" size="1 1 1 1"/>',
            "inside": '<geom type="hfield" hfield="h"/>',
        },
        {
            "inside": '<geom name="a" size="1"/><geom name="b" size="1"/>',
            "after": '<contact><pair geom1="a" geom2="b"/></contact>',
        },
        {"after": '<keyframe><key qpos="1"/></keyframe>'},
    ],
)
def test_mjcf_needs_no_files_beside_it(read: Read, changes: dict[str, str]) -> None:
    robot = read(arm(**changes))
    assert_near(mass_matrix(robot, [0.0]), 1.01)  # the inertial counts, the shapes do not


def test_shapes_give_the_inertia_where_nothing_else_does(read: Read) -> None:
    box = '<mujoco><worldbody><body name="b"><joint axis="0 0 1"/>{}</body></worldbody></mujoco>'
    robot = read(box.format('<geom type="box" size="0.1 0.2 0.3" mass="3"/>'))
    assert_near(mass_matrix(robot, [0.0]), 3 * (0.2**2 + 0.4**2) / 12)


def test_custom_elements_name_the_tip_and_rotor_sets(read: Read) -> None:
    robot = read(arm(custom='<numeric name="rotor_inertia:mine" data="0.4"/>'))
    assert robot.tip == "hand"
    assert robot.rotor_inertia_sets == {"mine": (0.4,)}
    assert read(arm(), tip="arm").tip == "arm"


def test_rotor_sets_must_fit(read: Read) -> None:
    with pytest.raises(ModelFileError, match=r"'rotor_inertia:mine' has 2 values for 1 joints"):
        read(arm(custom='<numeric name="rotor_inertia:mine" data="0.4 0.3"/>'))


def test_unnamed_joints_get_a_name(read: Read) -> None:
    assert read(arm().replace('name="j1"', "")).joint_names == ("joint1",)
    two = arm(inside='<joint name="joint1" axis="1 0 0"/>').replace('name="j1"', "")
    with pytest.raises(ModelFileError, match="two joints go by 'joint1'; name every joint"):
        read(two)


def test_a_site_may_have_the_name_of_a_body(read: Read) -> None:
    robot = read(arm(inside='<site name="hand" pos="0 0 0.25"/><site name="arm"/>'))
    assert_near(frame_pose(robot, "hand", [0.0]).position, [0, 0, 1])
    assert_near(frame_pose(robot, "site:hand", [0.0]).position, [0, 0, 0.25])


def test_a_model_without_a_name_goes_by_its_file(read: Read) -> None:
    assert read(arm()).name == "robot"


def test_welds_that_are_off_do_not_count(read: Read) -> None:
    off = '<equality><weld body1="arm" active="false"/></equality>'
    assert read(arm(after=off)).n == 1
