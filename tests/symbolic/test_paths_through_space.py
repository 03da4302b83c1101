# SPDX-License-Identifier: BSD-3-Clause
"""Tendons and motors that act through space: refused, or motors of unknown kind."""

from __future__ import annotations

import numpy as np
import pytest
from robot_files import Read, two_links

from softimpact.symbolic import Robot, UnsupportedModel, arm_of, chain_to, impact_model


def felt(robot: Robot) -> float:
    """Mass felt at the tool along x with rigid joints [kg]."""
    model = impact_model(arm_of(robot, "tool").robot)
    return float(model.reflected_mass([0.3, 1.2], [1.0, 0.0, 0.0]))


AT = '<site name="at" pos="0.1 0.1 0"/>'
PATH = '<site site="at"/><site site="{}"/>'
ON_UPPER = '<site name="middle" pos="0.1 0 0"/>'


@pytest.mark.parametrize(
    ("end", "crossed"), [("tool", "'j1', 'j2'"), ("middle", "'j1'")], ids=["arm", "first link"]
)
@pytest.mark.parametrize(
    ("attribute", "what"),
    [("stiffness", "the spring of tendon 't'"), ("armature", "the inertia of tendon 't'")],
)
def test_a_tendon_through_space_may_not_be_forgotten(
    read: Read, end: str, crossed: str, attribute: str, what: str
) -> None:
    spatial = f'<tendon><spatial name="t" {attribute}="2">{PATH.format(end)}</spatial></tendon>'
    robot = read(two_links(after=spatial, beside=AT, on_upper=ON_UPPER))
    with pytest.raises(UnsupportedModel, match=f"{what} acts through space on {crossed};"):
        chain_to(robot, "tool")


def test_a_tendon_through_space_off_the_arm_does_not_matter(read: Read) -> None:
    finger = (
        f'{ON_UPPER}<body name="finger" pos="0 0 0.1"><joint name="f"/>'
        '<inertial pos="0 0 0" mass="1e-9" diaginertia="1e-12 1e-12 1e-12"/><site name="nail"/>'
        "</body>"
    )
    path = '<site site="middle"/><geom geom="g"/><site site="nail"/><pulley divisor="2"/>'
    path += '<site site="nail"/><site site="middle"/>'
    tendon = f'<tendon><spatial name="t" stiffness="2">{path}</spatial></tendon>'
    wrapped = '<geom name="g" type="sphere" size="0.01" mass="0"/>'
    robot = read(two_links(after=tendon, on_upper=finger + wrapped))
    assert felt(robot) == pytest.approx(felt(read(two_links())), rel=1e-6)
    with pytest.raises(UnsupportedModel, match="tendon 't' acts through space on 'f'"):
        chain_to(robot, "finger")


def test_a_motor_through_space_is_a_motor(read: Read) -> None:
    """Joints without one would give way, on the unsafe side."""
    spatial = f'<tendon><spatial name="t">{PATH.format("tool")}</spatial></tendon>'
    motors = '<actuator><motor joint="j1" forcerange="-3 3"/>{}</actuator>'
    pulled = motors.format('<motor name="m" tendon="t"/>')
    robot = read(two_links(after=spatial + pulled, beside=AT))
    assert robot.actuated == (True, True)
    assert [joint.torque_limit for joint in robot.joints] == [np.inf, np.inf]
    assert any("motor 'm' acts through space on 'j1', 'j2'" in line for line in robot.warnings)
    site = motors.format('<motor name="m" site="tool" gear="1 0 0 0 0 0"/>')
    assert read(two_links(after=site)).actuated == (True, True)
    rotor = motors.format('<motor name="m" tendon="t" armature="1e-3" gear="10"/>')
    with pytest.raises(UnsupportedModel, match="the rotor of motor 'm' acts through space"):
        chain_to(read(two_links(after=spatial + rotor, beside=AT)), "tool")


def test_an_equality_of_tendons_through_space_may_not_be_forgotten(read: Read) -> None:
    spatial = f'<tendon><spatial name="t">{PATH.format("tool")}</spatial></tendon>'
    held = '<equality><tendon name="e" tendon1="t"/></equality>'
    with pytest.raises(UnsupportedModel, match="equality 'e' of tendons acts through space on"):
        chain_to(read(two_links(after=spatial + held, beside=AT)), "tool")
