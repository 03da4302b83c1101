# SPDX-License-Identifier: BSD-3-Clause
"""A robot in a configuration, about to be hit along a direction, from what a user typed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from softimpact.symbolic import (
    Drives,
    ImpactModel,
    InvalidValue,
    Robot,
    chain_to,
    configuration_at_rest,
    drives,
    floating_model,
    floating_robot,
    impact_model,
    link_angles_at_rest,
    load_robot,
    lock_joints,
    unit_direction,
)
from softimpact.symbolic.impact.drives import PerJoint
from softimpact.symbolic.impact.impact_model import WEIGHTLESS
from softimpact.symbolic.robot.rigid import Array

from . import values


@dataclass(frozen=True)
class TypedDrives:
    """The options that make up drives, as typed; see ``options``."""

    joint_stiffness: str | None = None
    rotor_inertia: str | None = None
    position_gain: str | None = None
    computed_torque_gain: float | None = None
    gear_ratio: str | None = None


@dataclass(frozen=True)
class Typed:
    """The options that make up a situation, as typed; see ``options``."""

    model: str
    tip: str | None
    q: str
    direction: str
    drives: TypedDrives = TypedDrives()
    gravity: str | None = None
    motor_angles: bool = False


@dataclass(frozen=True, eq=False)
class Situation:
    """A robot about to be hit.

    Attributes:
        model: the chain to the contact point with its drives.
        q: link angles, length n.
        direction: unit vector in the base's axes.
    """

    model: ImpactModel
    q: Array
    direction: Array


def situation(typed: Typed) -> Situation:
    """Return the situation that the options describe; raises SoftImpactError."""
    robot = robot_to_tip(typed.model, typed.tip)
    q = values.vector("q", typed.q)
    direction = unit_direction(values.vector("direction", typed.direction, 3))
    model = impact_model(
        robot, drives_=drives_of(robot, typed.drives), gravity=gravity_of(typed.gravity)
    )
    if typed.motor_angles:
        return Situation(model, link_angles(model, np.array(q)), direction)
    return Situation(model, robot.vector("q", q), direction)


def free_situation(typed: Typed) -> Situation:
    """Return the situation of a robot on a free base; its q begins with the base's six zeros."""
    robot = whole_robot(typed.model, typed.tip)
    free = floating_robot(robot)
    q = robot.vector("q", values.vector("q", typed.q))
    direction = unit_direction(values.vector("direction", typed.direction, 3))
    model = floating_model(free, drives_=drives_of(robot, typed.drives))
    return Situation(model, np.array(free.coordinates(q)).ravel(), direction)


def whole_robot(name: str, tip: str | None) -> Robot:
    """Return a robot with all its joints and a base whose mass counts; raises SoftImpactError."""
    robot = load_robot(name, tip, floating=True)
    if robot.tip is None:
        raise _no_tip(name, robot)
    return robot


def robot_to_tip(name: str, tip: str | None) -> Robot:
    """Return the chain of a robot to its contact point.

    Args:
        name: of a built-in robot, or path of a file.
        tip: contact frame; default the robot's own.

    Raises:
        SoftImpactError: the robot cannot be read, or no contact frame that moves is named.
    """
    robot = load_robot(name, tip)
    if robot.tip is None:
        raise _no_tip(name, robot)
    chain = chain_to(robot, robot.tip)
    if chain.n == 0:
        raise InvalidValue(
            "tip", f"frame '{robot.tip}' is fixed to the base; choose one that moves"
        )
    return chain


def _no_tip(name: str, robot: Robot) -> InvalidValue:
    known = ", ".join(robot.frames)
    return InvalidValue("tip", f"{name} names no contact frame; choose one of: {known}")


def link_angles(model: ImpactModel, motor_angles: Array) -> Array:
    """Return the link angles at which the model's springs and gravity balance.

    A closed chain has an angle for each motor, any other robot one for each joint.
    """
    if model.robot.loops:
        return configuration_at_rest(model, motor_angles)
    robot, elastic = model.robot, np.array(model.drives.elastic)
    robot.vector("q", motor_angles)
    rigid = {
        joint.name: float(angle)
        for joint, angle, gives in zip(robot.joints, motor_angles, elastic, strict=True)
        if not gives
    }
    q = motor_angles.copy()
    if elastic.any():
        springs = np.array(model.drives.springs).ravel()[elastic]
        q[elastic] = link_angles_at_rest(
            lock_joints(robot, rigid), motor_angles[elastic], springs, model.gravity
        )
    return q


def drives_of(robot: Robot, typed: TypedDrives) -> Drives:
    """Return the drives that the options describe; raises SoftImpactError."""

    def given(field: str, text: str | None) -> PerJoint | None:
        return None if text is None else values.per_joint(field, text)

    rotors = typed.rotor_inertia
    return drives(
        robot,
        joint_stiffness=given("joint_stiffness", typed.joint_stiffness),
        rotor_inertia=None if rotors is None else values.rotor_inertia(robot, rotors),
        position_gain=given("position_gain", typed.position_gain),
        computed_torque_gain=typed.computed_torque_gain,
        gear_ratio=given("gear_ratio", typed.gear_ratio),
    )


def gravity_of(text: str | None) -> tuple[float, float, float]:
    """Return gravity as typed [m/s²]; none if it was not."""
    if text is None:
        return WEIGHTLESS
    x, y, z = values.vector("gravity", text, 3)
    return x, y, z
