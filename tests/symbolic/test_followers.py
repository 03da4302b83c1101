# SPDX-License-Identifier: BSD-3-Clause
"""Joints that follow others: what files say of them, and what q holds then."""

from __future__ import annotations

import numpy as np
import pytest
from oracles import assert_near
from robot_files import URDF_LIMIT, Read, felt, two_links, two_links_urdf, urdf_inertial

from softimpact.symbolic import (
    Coupling,
    InvalidValue,
    Loop,
    arm_of,
    chain_to,
    impact_model,
    own_joints,
    whole_configuration,
)

OPPOSITE = '<equality><joint joint1="j2" joint2="j1" polycoef="0 -1 0 0 0"/></equality>'

FOLLOWS = [
    (two_links(after=OPPOSITE), ".xml"),
    (
        two_links(
            after='<tendon><fixed name="a"><joint joint="j1" coef="1"/></fixed>'
            '<fixed name="b"><joint joint="j2" coef="2"/></fixed></tendon>'
            '<equality><tendon tendon1="b" tendon2="a" polycoef="0 -2 0 0 0"/></equality>'
        ),
        ".xml",
    ),
    (two_links_urdf(on_j2='<mimic joint="j1" multiplier="-1"/>',
                    fore=urdf_inertial("1", "0.15", "0.005", "0.01", "0.01")), ".urdf"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "suffix"), FOLLOWS)
@pytest.mark.parametrize("q", [[0.6], [0.6, -0.6]])
def test_a_joint_that_follows_is_no_coordinate(
    read: Read, text: str, suffix: str, q: list[float]
) -> None:
    """One coordinate, G = [1, −1]: by hand from M of the arm."""
    robot = read(text, suffix)
    assert own_joints(arm_of(robot, "tool").robot) == ("j1",)
    assert felt(robot, q, [0.0, 1.0, 0.0]) == pytest.approx(2.385570, abs=1e-6)


def test_a_coupling_that_is_not_linear(read: Read) -> None:
    text = two_links(
        after='<equality><joint joint1="j2" joint2="j1" polycoef="0.1 0.5 0.3 0 0"/></equality>'
    )
    arm = arm_of(read(text), "tool").robot
    q = whole_configuration(arm, [0.4])
    assert_near(q, [0.4, 0.1 + 0.5 * 0.4 + 0.3 * 0.16])
    model = impact_model(arm)
    G = np.array([1.0, 0.5 + 2 * 0.3 * 0.4])
    free = arm_of(read(two_links()), "tool").robot
    whole = np.array(impact_model(free).mass_matrix(q))
    assert_near(model.mass_matrix(q), [[G @ whole @ G]])


def test_joints_that_follow_welded_ones_are_welded_where_these_put_them(read: Read) -> None:
    text = two_links_urdf(on_j2='<mimic joint="j1" multiplier="-1" offset="0.2"/>')
    branch = (
        '<link name="arm">' + urdf_inertial("1", "0.1") + '</link><joint name="a" type="revolute">'
        f'<parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>{URDF_LIMIT}</joint></robot>'
    )
    robot = read(text.replace("</robot>", branch), ".urdf")
    welded = chain_to(robot, "arm")
    assert welded.joint_names == ("a",)
    place = welded.frame("tool").placement.translation
    assert_near(place, [0.4 + 0.3 * np.cos(0.2), 0.3 * np.sin(0.2), 0.0])


def test_a_joint_that_mimics_without_numbers_does_the_same(read: Read) -> None:
    (coupling,) = read(two_links_urdf(on_j2='<mimic joint="j1"/>'), ".urdf").loops
    assert isinstance(coupling, Coupling)
    assert coupling.polynomial == (0.0, 1.0)


def test_joints_may_follow_in_a_robot_with_loops(read: Read) -> None:
    """Entries of q are those of joints that lead, whatever else ties the robot."""
    tied = '<connect body1="fore" body2="world" anchor="0.3 0 0"/>'
    follows = '<joint joint1="j2" joint2="j1" polycoef="0 -1 0 0 0"/>'
    robot = read(two_links(after=f"<equality>{tied}{follows}</equality>"))
    assert {loop.name for loop in robot.loops} == {"loop1", "coupling2"}
    (pin,) = [loop for loop in robot.loops if isinstance(loop, Loop)]
    assert (pin.first, pin.second) == ("fore@0.3,0,0", "world@0.7,0,0")
    assert_near(whole_configuration(robot, [0.2]), [0.2, -0.2])


def test_q_must_agree_with_a_coupling(read: Read) -> None:

    robot = read(*FOLLOWS[2])
    with pytest.raises(InvalidValue, match=r"'j2' follows 'j1' and is then at -0.6, not 0.5"):
        felt(robot, [0.6, 0.5])
