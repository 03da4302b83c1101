# SPDX-License-Identifier: BSD-3-Clause
"""Every field of a file that changes the robot is used, refused or named; none is dropped."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from oracles import Mujoco, assert_near
from robot_files import Read, two_links, two_links_urdf

from softimpact.symbolic import (
    JointKind,
    Robot,
    SoftImpactError,
    UnsupportedModel,
    chain_to,
    gravity_torques,
    load_robot,
    mass_matrix,
)
from softimpact.symbolic.robot.constraints import Through
from softimpact.symbolic.robot.robot import Joint

NO_GRAVITY = (0.0, 0.0, 0.0)

BOTH = '<joint joint="j1" coef="1"/><joint joint="j2" coef="-0.5"/>'
LONE = '<joint joint="j2" coef="2"/>'
SPACE = '<site site="at"/><site site="tool"/>'
AT = '<site name="at" pos="0.1 0.1 0"/>'


def tendon(attributes: str, path: str = BOTH, kind: str = "fixed") -> dict[str, str]:
    return {"after": f'<tendon><{kind} name="t" {attributes}>{path}</{kind}></tendon>'}


def actuator(text: str, path: str = "") -> dict[str, str]:
    before = f'<tendon><fixed name="t">{path}</fixed></tendon>' if path else ""
    return {"after": f"{before}<actuator>{text}</actuator>"}


SHAPES = '<geom type="box" size="0.1 0.05 0.02" group="1"/><geom size="0.05" pos="0.2 0 0"/>'
BY_SHAPES = {"inertial": "", "on_fore": SHAPES}

FIELDS: list[dict[str, str]] = [
    *({"j1": f'{field}="{value}"'} for field, value in (
        ("armature", "0.3"), ("damping", "2"), ("frictionloss", "0.4"), ("ref", "0.2"),
        ("range", "-1 1"), ("pos", "0.05 0 0"), ("type", "slide"),
        ("actuatorfrcrange", "-3 3"), ("actuatorgravcomp", "true"),
        ("stiffness", "7"), ("springdamper", "0.1 1"),
    )),
    {"j1": 'stiffness="7" springref="0.3"'},
    {"j1": 'stiffness="7 2"'},
    {"j1": 'damping="1 2"'},
    {"j1": 'stiffness="7" springyield="0.5"'},
    {"upper": 'gravcomp="1"'},
    {"upper": 'pos="0 0 1"'},
    {"upper": 'quat="1 1 0 0"'},
    {"before": '<default><joint armature="0.7"/></default>'},
    {"compiler": 'settotalmass="10"'},
    {"compiler": 'boundmass="1.5"'},
    {"compiler": 'boundinertia="0.5"'},
    {"compiler": 'balanceinertia="true"', "inertial":
        '<inertial pos="0.15 0 0" mass="1" diaginertia="0.005 0.005 0.03"/>'},
    {"compiler": 'inertiafromgeom="true"', "on_fore": SHAPES},
    {"compiler": 'inertiafromgeom="auto"', "on_fore": SHAPES, "inertial": ""},
    BY_SHAPES,
    BY_SHAPES | {"compiler": 'inertiagrouprange="0 0"'},
    BY_SHAPES | {"before": '<default><geom density="3000"/></default>'},
    {"inertial": "", "on_fore": SHAPES.replace('group="1"', 'mass="0"')},
    {"inertial": "", "on_fore": SHAPES.replace('group="1"', 'density="0"')},
    {"inertial": "", "on_fore": SHAPES.replace('group="1"', 'shellinertia="true"')},
    {"inertial": "", "on_fore": '<frame pos="0.1 0 0" euler="1 0 0">' + SHAPES + "</frame>"},
    {"inertial":
        '<inertial pos="0.15 0 0" mass="1" fullinertia="0.02 0.03 0.04 0.001 0.002 0.003"/>'},
    {"inertial":
        '<inertial pos="0.15 0 0" mass="1" euler="0.3 0.2 0.1" diaginertia="0.02 0.03 0.04"/>'},
    *(tendon(f'{field}="{value}"', path) for path in (BOTH, LONE) for field, value in (
        ("armature", "0.4"), ("stiffness", "3"), ("damping", "2"), ("frictionloss", "1"),
    )),
    tendon('stiffness="3" springlength="0.2"'),
    tendon('stiffness="3" springlength="0.2"', LONE),
    tendon('stiffness="3" springlength="-0.1 0.2"'),
    *(tendon(f'{field}="2"', SPACE, "spatial") | {"beside": AT} for field in (
        "armature", "stiffness", "damping", "frictionloss",
    )),
    actuator('<motor joint="j1"/>'),
    actuator('<motor joint="j1" gear="30" armature="1e-3"/>'),
    actuator('<motor joint="j1" gear="30" damping="1e-3"/>'),
    actuator('<motor jointinparent="j2" gear="3" armature="1e-2"/>'),
    actuator('<motor tendon="t" gear="3" armature="1e-2"/>', LONE),
    actuator('<motor tendon="t" gear="3" armature="1e-2"/>', BOTH),
    actuator('<motor tendon="t" gear="3" damping="1e-2"/>', LONE),
    actuator('<position joint="j1" kp="50" kv="2"/>'),
    actuator('<position joint="j1" kp="50" dampratio="1"/>'),
    actuator('<velocity joint="j1" kv="2"/>'),
    actuator('<intvelocity joint="j1" kp="2"/>'),
    actuator('<damper joint="j1" kv="2" ctrlrange="0 1"/>'),
    actuator('<motor joint="j1" forcerange="-4 4"/>'),
    actuator('<motor joint="j1" gear="2" ctrlrange="-4 4"/>'),
    actuator('<general joint="j1" gainprm="3" biastype="affine" biasprm="0 -9 -1"/>'),
    actuator('<motor site="tool" gear="1 0 0 0 0 0"/>'),
    actuator('<muscle joint="j1" lengthrange="0 1"/>'),
    actuator('<cylinder joint="j1" area="1"/>'),
    {"after": '<equality><joint joint1="j2" joint2="j1" polycoef="0 2 0 0 0"/></equality>'},
    {"after": '<equality><joint joint1="j2" polycoef="0.4 0 0 0 0"/></equality>'},
    {"after": '<equality><connect body1="fore" body2="world" anchor="0.1 0 0"/></equality>'},
    {"after": '<equality><weld body1="fore" body2="world"/></equality>'},
    {"after": '<equality><tendon tendon1="t" polycoef="0.1 0 0 0 0"/></equality>'
        f'<tendon><fixed name="t">{BOTH}</fixed></tendon>'},
    {"on_fore": '<body><joint type="ball"/><geom size="0.1"/></body>'},
    {"beside": '<body><freejoint/><geom size="0.1"/></body>'},
]  # fmt: skip


def described(robot: Robot) -> tuple[object, ...]:
    """Everything that a robot says of itself."""
    numbers = [
        [float(getattr(j, f.name)) for f in fields(Joint) if f.type in ("float", "bool")]
        for j in robot.joints
    ]
    return robot.digest(), numbers, robot.warnings, robot.loops, robot.tendons


@pytest.mark.parametrize("changes", FIELDS, ids=lambda changes: " ".join(changes.values())[:60])
def test_no_field_is_dropped(read: Read, changes: dict[str, str]) -> None:
    text = two_links(**changes)
    try:
        oracle = Mujoco(text)
    except ValueError as error:  # fields that this MuJoCo does not have
        if "unrecognized attribute" not in str(error):
            raise
        pytest.skip(str(error))
    try:
        robot = read(text)
    except SoftImpactError as refusal:
        if "'" not in str(refusal):  # it names what
            raise
        return
    assert described(robot) != described(read(two_links()))
    if any(isinstance(loop, Through) for loop in robot.loops):
        with pytest.raises(UnsupportedModel, match="acts through space on 'j1'"):
            chain_to(robot, "tool")
        return
    joints = [
        i for i in range(oracle.model.njnt) if oracle.model.joint(i).name in robot.joint_names
    ]
    dofs = [int(oracle.model.jnt_dofadr[i]) for i in joints]
    own = [robot.joint_names.index(oracle.model.joint(i).name) for i in joints]
    q = np.random.default_rng(0).uniform(-1, 1, robot.n)
    whole = np.array(oracle.model.qpos0)
    whole[[int(oracle.model.jnt_qposadr[i]) for i in joints]] = q[own]
    if robot.n > len(own):  # a ball joint's hinges are not its coordinates
        q[[i for i in range(robot.n) if i not in own]] = 0.0
    oracle.at(whole)
    M = np.array(mass_matrix(robot, q)) + np.diag(robot.armature)
    assert_near(M[np.ix_(own, own)], oracle.mass_matrix()[np.ix_(dofs, dofs)])
    unlike = ("ignored", "not count", "always taut")
    if not any(words in line for line in robot.warnings for words in unlike):
        springs = np.array(gravity_torques(robot, q, NO_GRAVITY)).ravel()[own]
        assert_near(-springs, oracle.spring_torques()[dofs])
    oracle.at(whole, np.ones(oracle.model.nv))
    if not any("damping" in line for line in robot.warnings):
        assert_near(robot.damping[own], -np.array(oracle.data.qfrc_damper)[dofs])


URDF_FIELDS: list[dict[str, str]] = [
    {"on_j1": '<dynamics damping="2"/>'},
    {"on_j1": '<dynamics friction="2"/>'},
    {"on_j1": '<dynamics spring="2"/>'},
    {"on_j2": '<mimic joint="j1"/>'},
    {"on_j2": '<mimic joint="nobody"/>'},
    {"limit": '<limit lower="-1" upper="1" effort="1" velocity="1"/>'},
    {"limit": '<limit lower="-3" upper="3" effort="9" velocity="2"/>'},
    {"limit": '<limit lower="-3" upper="3" effort="50" velocity="9"/>'},
    {"type1": "continuous"},
    {"type1": "prismatic"},
    {"type1": "planar"},
    {"type1": "floating"},
    {"type1": "fixed"},
    {"after": "<transmission/>"},
    {"after": "<loop_joint/>"},
    {"after": "<gazebo><springStiffness>3</springStiffness></gazebo>"},
    {"after": '<link name="stray"/>'},
]


@pytest.mark.parametrize("changes", URDF_FIELDS, ids=str)
def test_no_field_of_a_urdf_is_dropped(read: Read, changes: dict[str, str]) -> None:
    try:
        robot = read(two_links_urdf(**changes), ".urdf")
    except SoftImpactError as refusal:
        if "'j1'" not in str(refusal):
            raise
        return
    assert described(robot) != described(read(two_links_urdf(), ".urdf"))


def test_planar_joints_move_in_their_plane(read: Read, tmp_path: Path) -> None:
    import pinocchio as pin

    robot = read(two_links_urdf(type1="planar"), ".urdf")
    assert [j.kind for j in robot.joints[:3]] == [JointKind.SLIDE, JointKind.SLIDE, JointKind.HINGE]
    model = pin.buildModelFromUrdf(str(tmp_path / "robot.urdf"))
    q = np.array([0.2, -0.3, np.cos(0.4), np.sin(0.4), 0.7])
    M = pin.crba(model, model.createData(), q)
    M = np.triu(M) + np.triu(M, 1).T
    ours = np.array(mass_matrix(robot, [0.2, -0.3, 0.4, 0.7]))
    assert_near(ours[2:, 2:], M[2:, 2:])  # Pinocchio's x and y turn with the body
    assert_near(ours[:2, :2], M[:2, :2])


def test_files_without_inertias_at_all(tmp_path: Path) -> None:
    path = tmp_path / "bare.urdf"
    path.write_text(two_links_urdf(upper="", fore=""))
    with pytest.raises(SoftImpactError, match="no mass and inertia"):
        load_robot(path)
