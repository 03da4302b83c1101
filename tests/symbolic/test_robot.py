# SPDX-License-Identifier: BSD-3-Clause
"""The robot as data: names, limits, hashes, and sub-robots with welded joints."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from oracles import assert_near, configurations, example_urdf
from random_robots import robots, vectors

from softimpact.symbolic import (
    FrameNotFound,
    InvalidValue,
    JointKind,
    Loop,
    Robot,
    SoftImpactError,
    UnknownName,
    WrongLength,
    chain_to,
    floating_robot,
    frame_jacobian,
    frame_pose,
    gravity_torques,
    load_robot,
    lock_joints,
    mass_matrix,
)
from softimpact.symbolic.robot.plausibility import implausible
from softimpact.symbolic.robot.rigid import Array, Inertia


@pytest.fixture(scope="module")
def panda() -> Robot:
    return load_robot("panda")


def test_what_the_panda_is(panda: Robot) -> None:
    assert panda.n == 7
    assert panda.joint_names == tuple(f"joint{i}" for i in range(1, 8))
    assert panda.tip == "hand_tcp"
    assert panda.actuated == (True,) * 7
    lower, upper = panda.limits
    assert (lower < upper).all()
    assert panda.ancestors(6) == [6, 5, 4, 3, 2, 1, 0]
    assert panda.ancestors(-1) == []


def test_rotor_inertia_sets_are_found_by_name(panda: Robot) -> None:
    assert_near(panda.rotor_inertia_set("drake_fr3"), panda.armature)
    assert_near(panda.rotor_inertia_set("menagerie_panda"), np.full(7, 0.1))
    with pytest.raises(UnknownName, match=r"rotor inertia set 'drake'.*drake_fr3") as caught:
        panda.rotor_inertia_set("drake")
    assert "menagerie_fr3" in caught.value.known


def test_with_armature_changes_only_that(panda: Robot) -> None:
    other = panda.with_armature(np.arange(7))
    assert_near(other.armature, np.arange(7.0))
    assert_near(panda.armature[0], 0.605721456)
    q = next(configurations(panda, 1))
    assert_near(mass_matrix(other, q), mass_matrix(panda, q), 0)  # links only
    with pytest.raises(WrongLength):
        panda.with_armature([1.0])


def test_vector_names_the_joints_it_wants(panda: Robot) -> None:
    with pytest.raises(
        WrongLength, match=r"q: has 3 values, but 7 are needed.*joint1, joint2"
    ) as e:
        panda.vector("q", [1, 2, 3])
    assert (e.value.field, e.value.found, e.value.expected) == ("q", 3, 7)
    with pytest.raises(InvalidValue, match="q: must be a flat list of numbers"):
        panda.vector("q", np.zeros((7, 1)))


def test_frame_not_found_lists_frames(panda: Robot) -> None:
    with pytest.raises(FrameNotFound, match=r"'tool'.*flange"):
        panda.frame("tool")


def test_digest_sees_every_number_and_no_identity(panda: Robot) -> None:
    assert load_robot("panda").digest() == panda.digest()
    assert panda.with_armature(np.ones(7)).digest() != panda.digest()
    joint = panda.joints[3]
    for change in ({"name": "x"}, {"offset": 1e-3}, {"lower": -1.0}, {"actuated": False}):
        joints = (*panda.joints[:3], replace(joint, **change), *panda.joints[4:])
        assert replace(panda, joints=joints).digest() != panda.digest()


def test_digest_sees_payloads_and_loops(panda: Robot) -> None:
    light, heavy = (panda.with_payload("hand_tcp", mass) for mass in (1.0, 2.0))
    moved = panda.with_payload("hand_tcp", 1.0, (0.0, 0.0, 0.1))
    assert len({robot.digest() for robot in (panda, light, heavy, moved)}) == 4
    rmin = load_robot("rmin")
    (loop,) = rmin.loops
    assert isinstance(loop, Loop)
    turned = replace(rmin, loops=(Loop(loop.name, loop.second, loop.first),))
    others = (replace(rmin, loops=()), turned, replace(rmin, independent=()))
    assert len({robot.digest() for robot in (rmin, *others)}) == 4


def test_welding_hands_masses_to_the_base(panda: Robot) -> None:
    """What is welded to the base counts where it floats."""
    base = Inertia.from_center_of_mass(5.0, np.zeros(3), np.eye(3))
    whole = replace(panda, base_inertia=base)
    part = lock_joints(whole, {"joint1": 0.4, "joint2": -0.3})
    q = np.array([0.4, -0.3, 0.2, -2.0, 0.3, 2.0, 0.5])
    M = np.array(floating_robot(whole).mass_matrix(q))
    stays = [*range(6), *range(8, 13)]
    assert_near(floating_robot(part).mass_matrix(q[2:]), M[np.ix_(stays, stays)])


def test_digest_sees_where_the_frames_are(panda: Robot) -> None:
    """The contact point's frame is part of what is generated."""
    frame = panda.frames["hand_tcp"]
    moved = replace(frame, placement=frame.placement @ frame.placement)
    other = replace(panda, frames={**panda.frames, "hand_tcp": moved})
    assert other.digest() != panda.digest()


@settings(max_examples=30)
@given(robots(min_joints=2), vectors(5))
def test_welding_joints_keeps_the_rest_of_the_dynamics(robot: Robot, q: Array) -> None:
    """M, gravity and J of the welded robot are those of the free one, without the welded rows."""
    q = q[: robot.n]
    welded = {j.name: float(q[i]) for i, j in enumerate(robot.joints) if i % 2}
    kept = [i for i in range(robot.n) if i % 2 == 0]
    part = lock_joints(robot, welded)
    assert part.n == len(kept)
    assert_near(mass_matrix(part, q[kept]), np.array(mass_matrix(robot, q))[np.ix_(kept, kept)])
    gravity = (1.0, 2.0, -9.0)
    whole = np.array(gravity_torques(robot, q, gravity)).ravel()
    assert_near(gravity_torques(part, q[kept], gravity), whole[kept])
    assert_near(
        frame_jacobian(part, "tip", q[kept]), np.array(frame_jacobian(robot, "tip", q))[:, kept]
    )
    assert_near(frame_pose(part, "tip", q[kept]).position, frame_pose(robot, "tip", q).position)


def test_welding_keeps_the_rotor_sets_of_the_rest(panda: Robot) -> None:
    part = lock_joints(panda, {"joint2": 0.3})
    assert part.joint_names == tuple(f"joint{i}" for i in (1, 3, 4, 5, 6, 7))
    assert len(part.rotor_inertia_sets["drake_fr3"]) == 6
    assert part.rotor_inertia_set("drake_fr3")[1] == panda.armature[2]


def test_welding_a_joint_that_does_not_exist_is_an_error(panda: Robot) -> None:
    with pytest.raises(UnknownName, match=r"joint 'jiont2'.*joint2"):
        lock_joints(panda, {"jiont2": 0.3})
    with pytest.raises(InvalidValue, match="joint2: needs a finite coordinate"):
        lock_joints(panda, {"joint2": float("nan")})


def test_chain_to_a_hand_of_a_branched_robot() -> None:
    robot = load_robot(example_urdf("baxter.urdf"))
    part = chain_to(robot, "left_gripper_base_link")
    assert part.tip == "left_gripper_base_link"
    assert part.n == 7
    assert all(name.startswith("left_") for name in part.joint_names)
    on = [robot.joint_names.index(name) for name in part.joint_names]
    q = np.zeros(robot.n)
    q[on] = next(configurations(part, 1))
    assert_near(mass_matrix(part, q[on]), np.array(mass_matrix(robot, q))[np.ix_(on, on)])
    assert_near(
        frame_jacobian(part, "left_gripper_base_link", q[on]),
        np.array(frame_jacobian(robot, "left_gripper_base_link", q))[:, on],
    )


def test_chain_to_welds_the_others_where_told() -> None:
    robot = load_robot(example_urdf("panda.urdf"))
    rest = np.zeros(robot.n)
    rest[-2:] = 0.04  # fingers apart
    closed, apart = chain_to(robot, "panda_hand"), chain_to(robot, "panda_hand", rest)
    assert closed.n == apart.n == 7
    q = next(configurations(closed, 1))
    assert abs(np.array(mass_matrix(closed, q) - mass_matrix(apart, q))).max() > 1e-9
    with pytest.raises(WrongLength, match="rest"):
        chain_to(robot, "panda_hand", [0.0])
    with pytest.raises(FrameNotFound):
        chain_to(robot, "hand")


def test_any_point_of_a_body_is_a_frame(panda: Robot) -> None:
    """``FRAME@x,y,z`` and ``with_frame`` name the same point, in sub-robots too."""
    q = next(configurations(panda, 1))
    named = panda.with_frame("bruise", "link5", [0.1, -0.02, 0.3])
    typed = "link5@0.1,-0.02,0.3"
    carrier = frame_pose(panda, "link5", q)
    expected = carrier.position + carrier.rotation @ [0.1, -0.02, 0.3]
    assert_near(frame_pose(named, "bruise", q).position, expected)
    assert_near(frame_pose(panda, typed, q).position, expected)
    chain = chain_to(panda, typed)
    assert chain.tip == typed
    assert chain.n == 5
    J = frame_jacobian(panda, typed, q)
    assert_near(frame_jacobian(chain, typed, q[:5]), J[:, :5])
    assert_near(frame_jacobian(panda, "hand@0,0,0", q), frame_jacobian(panda, "hand", q))


@pytest.mark.parametrize(
    ("frame", "error", "reason"),
    [
        ("link99@0,0,0", FrameNotFound, "unknown frame 'link99'"),
        ("link5@0,0", InvalidValue, "three finite numbers"),
        ("link5@0,0,nan", InvalidValue, "three finite numbers"),
        ("link5@", InvalidValue, "three finite numbers"),
    ],
)
def test_points_that_cannot_be(
    panda: Robot, frame: str, error: type[SoftImpactError], reason: str
) -> None:
    with pytest.raises(error, match=reason):
        panda.frame(frame)
    with pytest.raises(FrameNotFound):
        panda.with_frame("bruise", "link99", [0, 0, 0])
    with pytest.raises(InvalidValue, match="point: needs three finite numbers"):
        panda.with_frame("bruise", "link5", [0, float("nan"), 0])


def test_a_long_slide_is_no_hinge_in_degrees(panda: Robot) -> None:
    """Rails of 180 m would be odd, but are no mistake of units; a hinge of 180 rad is."""
    wide = replace(panda.joints[0], lower=-180.0, upper=180.0)
    hinged = replace(panda, joints=(wide, *panda.joints[1:]))
    slid = replace(panda, joints=(replace(wide, kind=JointKind.SLIDE), *panda.joints[1:]))
    assert any("look like degrees (180 rad)" in line for line in implausible(hinged))
    assert not any("degrees" in line for line in implausible(slid))
