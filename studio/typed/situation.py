# SPDX-License-Identifier: BSD-3-Clause
"""A robot in a configuration, about to be hit along a direction, from what a user typed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from softimpact.symbolic import (
    Drives,
    ImpactModel,
    InvalidValue,
    JointKind,
    Robot,
    arm_of,
    configuration_at_rest,
    drives,
    floating_model,
    floating_robot,
    impact_model,
    link_angles_at_rest,
    load_robot,
    lock_joints,
    unit_direction,
    whole_configuration,
    with_load,
)
from softimpact.symbolic.impact.drives import RIGID_FROM, PerJoint
from softimpact.symbolic.impact.impact_model import WEIGHTLESS
from softimpact.symbolic.robot.rigid import Array

from . import values
from .groups import TypedArm, TypedDrives


@dataclass(frozen=True)
class Typed:
    """The options that make up a situation, as typed; see ``options``."""

    arm: TypedArm
    q: str
    direction: str
    drives: TypedDrives
    gravity: str | None = None
    motor_angles: bool = False


@dataclass(frozen=True, eq=False)
class Situation:
    """A robot about to be hit.

    Attributes:
        model: the chain to the contact point with its drives.
        q: link angles, length n.
        direction: unit vector in the base's axes.
        payload: mass of what the arm holds [kg].
        warnings: what of the file was ignored, and what was assumed, a line each.
    """

    model: ImpactModel
    q: Array
    direction: Array
    payload: float = 0.0
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class LoadedArm:
    """An arm with its load, as typed.

    Attributes:
        robot: its tip is the contact point.
        load: mass of what its end holds [kg].
        warnings: a line each.
    """

    robot: Robot
    load: float
    warnings: tuple[str, ...]


def loaded_arm(typed: TypedArm) -> LoadedArm:
    """Return the arm that the options describe; raises SoftImpactError."""
    locked = {} if typed.lock is None else values.named_numbers("lock", typed.lock)
    robot = load_robot(typed.model, hold_base=typed.hold_base, toward=typed.end or typed.tip)
    arm = arm_of(robot, typed.tip, typed.end, locked)
    loads = []
    if typed.payload is not None:
        loads.append(values.payload(typed.payload))
    if typed.tool is not None:
        loads.append(values.tool(typed.tool))
    loaded = arm.robot
    for mass, com, inertia in loads:
        loaded = with_load(loaded, arm.end, mass, com, inertia)
    warnings = (*arm.robot.warnings, *arm.warnings)
    return LoadedArm(loaded, sum(load[0] for load in loads), warnings)


def situation(typed: Typed) -> Situation:
    """Return the situation that the options describe; raises SoftImpactError."""
    arm = loaded_arm(typed.arm)
    robot = arm.robot
    q = values.vector("q", typed.q)
    direction = unit_direction(values.vector("direction", typed.direction, 3))
    model = impact_model(
        robot, drives=drives_of(robot, typed.drives), gravity=gravity_of(typed.gravity)
    )
    angles = (
        link_angles(model, np.array(q)) if typed.motor_angles else whole_configuration(robot, q)
    )
    warnings = (
        *arm.warnings,
        *counted_as_rigid(model, typed.drives),
        *beyond_limits(robot, angles),
    )
    return Situation(model, angles, direction, arm.load, warnings)


def counted_as_rigid(model: ImpactModel, typed: TypedDrives) -> list[str]:
    """Return a line if springs were given that are too stiff to differ from none."""
    if typed.joint_stiffness is None:
        return []
    stiffest = np.array(values.per_joint("joint_stiffness", typed.joint_stiffness), dtype=float)
    if np.all(np.isinf(stiffest) | (stiffest < RIGID_FROM)):
        return []
    return [f"joints of {RIGID_FROM:g} N·m/rad and more count as rigid"]


def unknown_rotors_line(model: ImpactModel) -> list[str]:
    """Return a line if rotors of which nothing is known count as zero in masses and factors."""
    from softimpact.simulate.bracket import unknown_rotors

    names = ", ".join(f"'{name}'" for name in unknown_rotors(model))
    line = (
        f"rotor inertia of joint {names} is unknown and counts as zero in what depends on rotors "
        "(masses with rigid joints, GIAF); give the rotor inertia"
    )
    return [line] if names else []


DEGREES = 10.0
"""Angle [rad] from which on a list of angles is surely in degrees: beyond one and a half turns."""


def beyond_limits(robot: Robot, q: Array) -> list[str]:
    """Return a line for each joint beyond its limits.

    Raises:
        InvalidValue: they are so far beyond that they must be in degrees.
    """
    hinges = np.array([joint.kind is JointKind.HINGE for joint in robot.joints])
    lower, upper = robot.limits
    outside = (q < lower - AT_LIMIT) | (q > upper + AT_LIMIT)
    if np.any(hinges & outside & (abs(q) > DEGREES)):
        raise InvalidValue("q", "holds angles far beyond the joints' limits; it takes radians")
    return [
        f"joint '{joint.name}' is beyond its limits, {joint.lower:g} to {joint.upper:g}: {value:g}"
        for joint, value, is_outside in zip(robot.joints, q, outside, strict=True)
        if is_outside
    ]


AT_LIMIT = 1e-6
"""How far beyond a limit [rad, m] rounded numbers may be."""


def free_situation(typed: Typed) -> Situation:
    """Return the situation of a robot on a free base; its q begins with the base's six zeros."""
    robot = whole_robot(typed.arm.model, typed.arm.tip)
    free = floating_robot(robot)
    q = whole_configuration(robot, values.vector("q", typed.q))
    direction = unit_direction(values.vector("direction", typed.direction, 3))
    model = floating_model(free, drives=drives_of(robot, typed.drives))
    angles = np.array(free.coordinates(q)).ravel()
    warnings = (*robot.warnings, *beyond_limits(robot, q))
    return Situation(model, angles, direction, warnings=warnings)


def whole_robot(name: str, tip: str | None) -> Robot:
    """Return a robot with all its joints and a base whose mass counts; raises SoftImpactError."""
    robot = load_robot(name, tip, floating=True)
    if robot.tip is None:
        raise _no_tip(name, robot)
    return robot


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
    """Return the drives that the options describe; a servo's gains are the file's by default.

    Raises:
        SoftImpactError: one of them cannot be.
    """

    def given(field: str, text: str | None) -> PerJoint | None:
        return None if text is None else values.per_joint(field, text)

    rotors = typed.rotor_inertia
    if typed.motors == "servo" and not typed.gains:
        return _file_servo(robot, typed)
    return drives(
        robot,
        joint_stiffness=given("joint_stiffness", typed.joint_stiffness),
        rotor_inertia=None if rotors is None else values.rotor_inertia(robot, rotors),
        position_gain=given("position_gain", typed.position_gain),
        computed_torque_gain=typed.computed_torque_gain,
        gear_ratio=given("gear_ratio", typed.gear_ratio),
        damping_gain=given("damping_gain", typed.damping_gain),
        torque_limit=given("torque_limit", typed.torque_limit),
    )


def _file_servo(robot: Robot, typed: TypedDrives) -> Drives:
    """Return drives with the gains of the file's servos."""
    if not robot.position_gains.any():
        raise InvalidValue("motors", "'servo' needs position_gain: the file has no servo either")
    position, damping = (str(x.tolist()) for x in (robot.position_gains, robot.velocity_gains))
    return drives_of(robot, replace(typed, position_gain=position, damping_gain=damping))


def gravity_of(text: str | None) -> tuple[float, float, float]:
    """Return gravity as typed [m/s²]; none if it was not."""
    if text is None:
        return WEIGHTLESS
    x, y, z = values.vector("gravity", text, 3)
    return x, y, z
