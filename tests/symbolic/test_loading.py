# SPDX-License-Identifier: BSD-3-Clause
"""Reading URDF and MJCF, against MuJoCo's own dynamics, and files that cannot be read."""

import numpy as np
import pytest
from oracles import Mujoco, assert_near, example_urdf

from softimpact.symbolic import (
    FrameNotFound,
    InvalidInertia,
    ModelFileError,
    UnknownName,
    UnsupportedModel,
    bias_torques,
    frame_jacobian,
    frame_pose,
    gravity_torques,
    load_robot,
    mass_matrix,
)
from softimpact.symbolic.robot import JointKind

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

ARM = """
<mujoco>
  <custom><text name="tip" data="hand"/>{custom}</custom>
  <asset>{asset}</asset>
  <worldbody>
    <body name="arm"><joint name="j1" {joint}/>
      <inertial pos="{com}" mass="{mass}" diaginertia="{inertia}"/>{inside}
      <body name="hand" pos="0 0 1"/>
    </body>
  </worldbody>{after}
</mujoco>
"""
PLAIN = {"mass": "1", "inertia": "1 1 1", "com": "0.1 0 0"}

URDF = """
<robot name="r"><link name="world"/>
  <link name="arm">
    <inertial><origin xyz="0 0 0.1" rpy="0 0 0.3"/><mass value="{mass}"/>
      <inertia ixx="0.02" iyy="0.03" izz="{izz}" ixy="0.001" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="package://nowhere/arm.dae"/></geometry></visual>
    <collision><geometry><mesh filename="missing/arm.stl"/></geometry></collision>
  </link>
  <link name="tool"/>
  <joint name="j1" type="{kind}"><parent link="world"/><child link="arm"/>
    <origin xyz="0 0 1" rpy="0 1.5707963267948966 0"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="2" effort="1" velocity="1"/></joint>
  <joint name="fix" type="fixed"><parent link="arm"/><child link="tool"/>
    <origin xyz="0.5 0 0"/></joint>
</robot>
"""


def arm(**changes: str) -> str:
    """Return a one-joint MJCF with some of its parts replaced."""
    empty = dict.fromkeys(("custom", "asset", "joint", "inside", "after"), "")
    return ARM.format(**empty | PLAIN | changes)


@pytest.fixture
def read(tmp_path):
    """Load a robot from text."""

    def load(text, suffix=".xml", **options):
        path = tmp_path / f"robot{suffix}"
        path.write_text(text)
        return load_robot(path, **options)

    return load


def test_awkward_mjcf_agrees_with_mujoco(read):
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


def test_awkward_mjcf_is_read_in_the_files_order(read):
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


def test_built_in_robots_agree_with_mujoco_itself():
    from softimpact.robots import built_in_robots

    for name, path in built_in_robots().items():
        robot, oracle = load_robot(name), Mujoco(path)
        random = np.random.default_rng(4)
        q, velocity = random.uniform(-1, 1, (2, robot.n))
        oracle.at(q, velocity)
        M = np.array(mass_matrix(robot, q)) + np.diag(robot.armature)
        assert_near(M, oracle.mass_matrix())
        assert_near(bias_torques(robot, q, velocity), oracle.bias())


def test_urdf_needs_no_meshes(read):
    robot = read(URDF.format(mass=1, izz=0.04, kind="revolute"), ".urdf")
    assert robot.joint_names == ("j1",)
    assert robot.limits == (-1, 2)
    assert set(robot.frames) == {"arm", "tool"}
    assert_near(frame_pose(robot, "tool", [0.0]).position, [0, 0, 0.5])
    # roll, pitch and yaw of a right angle leave no digits behind
    assert set(np.unique(robot.joints[0].placement.rotation.round(15))) <= {-1.0, 0.0, 1.0}
    R = robot.joints[0].placement.rotation
    assert np.array_equal(R, R.round())


def test_urdf_slide(read):
    robot = read(URDF.format(mass=2.5, izz=0.04, kind="prismatic"), ".urdf")
    assert robot.joints[0].kind is JointKind.SLIDE
    assert_near(mass_matrix(robot, [0.3]), 2.5)
    assert_near(frame_pose(robot, "tool", [0.3]).position, [0, 0.3, 0.5])


def test_urdf_from_the_wild_lacks_its_meshes_too():
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
def test_mjcf_needs_no_files_beside_it(read, changes):
    robot = read(arm(**changes))
    assert_near(mass_matrix(robot, [0.0]), 1.01)  # the inertial counts, the shapes do not


def test_shapes_give_the_inertia_where_nothing_else_does(read):
    box = '<mujoco><worldbody><body name="b"><joint axis="0 0 1"/>{}</body></worldbody></mujoco>'
    robot = read(box.format('<geom type="box" size="0.1 0.2 0.3" mass="3"/>'))
    assert_near(mass_matrix(robot, [0.0]), 3 * (0.2**2 + 0.4**2) / 12)


def test_inertia_from_a_mesh_is_refused(read):
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


def test_custom_elements_name_the_tip_and_rotor_sets(read):
    robot = read(arm(custom='<numeric name="rotor_inertia:mine" data="0.4"/>'))
    assert robot.tip == "hand"
    assert robot.rotor_inertia_sets == {"mine": (0.4,)}
    assert read(arm(), tip="arm").tip == "arm"


def test_rotor_sets_must_fit(read):
    with pytest.raises(ModelFileError, match=r"'rotor_inertia:mine' has 2 values for 1 joints"):
        read(arm(custom='<numeric name="rotor_inertia:mine" data="0.4 0.3"/>'))


def test_unnamed_joints_get_a_name(read):
    assert read(arm().replace('name="j1"', "")).joint_names == ("joint1",)
    two = arm(inside='<joint name="joint1" axis="1 0 0"/>').replace('name="j1"', "")
    with pytest.raises(ModelFileError, match="two joints go by 'joint1'; name every joint"):
        read(two)


@pytest.mark.parametrize("name", ["gone.xml", "gone.urdf"])
def test_missing_file(tmp_path, name):
    with pytest.raises(ModelFileError, match=r"gone\.\w+: no such file") as caught:
        load_robot(tmp_path / name)
    assert caught.value.path.endswith(name)


def test_unknown_robot_lists_the_built_in_ones(tmp_path):
    with pytest.raises(UnknownName, match=r"'pandas'; known: .*panda.*rr") as caught:
        load_robot("pandas")
    assert "panda" in caught.value.known
    wrong = tmp_path / "robot.sdf"
    wrong.write_text("<sdf/>")
    with pytest.raises(UnknownName, match=r"neither built in nor a \.urdf or \.xml file"):
        load_robot(wrong)


@pytest.mark.parametrize("suffix", [".xml", ".urdf"])
@pytest.mark.parametrize(
    "text", ["", "<mujoco", "<html/>", "not xml", "<mujoco><nonsense/></mujoco>"]
)
def test_broken_xml(read, text, suffix):
    with pytest.raises(ModelFileError, match="not a URDF or MJCF") as caught:
        read(text, suffix)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mass": "-1"}, r"body 'arm': mass is negative \(-1 kg\)"),
        ({"mass": "nan"}, "body 'arm': mass must be a finite number"),
        ({"mass": "inf"}, "body 'arm': mass must be a finite number"),
        ({"mass": "0"}, "body 'arm': moves but has no mass and inertia > 0; give it an <inertial>"),
        ({"inertia": "1 1 3"}, "body 'arm': inertia violates the triangle inequality"),
        ({"inertia": "1 -1 1"}, "body 'arm': moves but has no mass and inertia > 0"),
    ],
)
def test_impossible_inertia_of_mjcf(read, changes, message):
    with pytest.raises(InvalidInertia, match=message) as caught:
        read(arm(**changes))
    assert caught.value.body == "arm"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mass": -1}, "body 'arm': mass is negative"),
        ({"mass": "nan"}, "body 'arm': mass must be a finite number"),
        ({"izz": 0.2}, "body 'arm': inertia violates the triangle inequality"),
        ({"izz": -0.2}, "body 'arm': inertia has an eigenvalue that is not positive"),
    ],
)
def test_impossible_inertia_of_urdf(read, changes, message):
    with pytest.raises(InvalidInertia, match=message):
        read(URDF.format(**{"mass": 1, "izz": 0.04, "kind": "revolute"} | changes), ".urdf")


def test_urdf_without_inertia(read):
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
def test_nan_anywhere(read, changes):
    with pytest.raises(ModelFileError, match="NaN"):
        read(arm(**changes))


def test_negative_armature(read):
    with pytest.raises(ModelFileError, match="joint 'j1': armature is negative"):
        read(arm(joint='armature="-0.1"'))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"joint": 'type="ball"'}, "joint 'j1' is a ball joint; write it as three hinges"),
        ({"joint": 'type="free"'}, "joint 'j1' is a free joint; .* floating=True"),
        ({"after": '<equality><weld body1="arm"/></equality>'}, "equality weld.*connect"),
        ({"joint": 'stiffness="100 5 7"'}, "springs whose stiffness depends on the deflection"),
    ],
)
def test_unsupported_models(read, changes, message):
    with pytest.raises(UnsupportedModel, match=message):
        read(arm(**changes))


def test_floating_urdf_base(read):
    text = URDF.format(mass=1, izz=0.04, kind="floating")
    with pytest.raises(UnsupportedModel, match="'j1' is a free joint"):
        read(text, ".urdf")


def test_a_model_without_joints(read):
    with pytest.raises(ModelFileError, match="has no joints"):
        read('<mujoco><worldbody><geom size="1"/></worldbody></mujoco>')


def test_a_tip_that_is_not_there(read):
    with pytest.raises(FrameNotFound, match="'finger'; known: arm, hand"):
        read(arm(), tip="finger")
    with pytest.raises(FrameNotFound, match="'palm'"):
        read(arm().replace('data="hand"', 'data="palm"'))


def test_reading_leaves_nothing_behind(read, tmp_path, monkeypatch):
    """MuJoCo writes its warnings to a log in the working directory if it is let."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ModelFileError):
        read(arm(mass="nan"))
    assert [path.name for path in tmp_path.iterdir()] == ["robot.xml"]
