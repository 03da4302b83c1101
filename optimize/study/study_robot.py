# SPDX-License-Identifier: BSD-3-Clause
"""The robot of a study: which joints of its file move, which have springs, and where it stands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from softimpact.symbolic import (
    ImpactModel,
    InvalidValue,
    Loop,
    Robot,
    UnknownName,
    chain_to,
    close_loops,
    drives,
    floating_model,
    floating_robot,
    impact_model,
    load_robot,
    lock_joints,
)
from softimpact.symbolic.impact.drives import PerJoint, require_rotors
from softimpact.symbolic.impact.floating import BASE_COORDINATES, is_floating
from softimpact.symbolic.loops.closure import closed_near, require_closed_at
from softimpact.symbolic.loops.couplings import whole_configuration
from softimpact.symbolic.loops.loops import closed_chain
from softimpact.symbolic.robot.arm import held_base
from softimpact.symbolic.robot.rigid import Array
from softimpact.symbolic.robot.robot import vector_of

from ..machine.springs import with_springs
from .study_file import RobotSection, StudyFile


def loaded(section: RobotSection, folder: Path) -> Robot:
    """Return the robot of a file, which is sought in a folder first; raises SoftImpactError."""
    if section.floating and section.hold_base:
        raise InvalidValue("floating", "excludes hold_base; give one of them")
    beside = folder / section.model
    model = beside if beside.is_file() else section.model
    return load_robot(
        model, floating=section.floating, hold_base=section.hold_base, toward=section.tip
    )


def chain_of(robot: Robot, section: RobotSection) -> Robot:
    """Return the chain to the tip, with the joints that loops and couplings tie to it.

    Joints off it are welded where ``lock`` says, else at zero.

    Raises:
        InvalidValue: the tip does not move; UnknownName, FrameNotFound: there is no such joint.
    """
    tip = section.tip if section.tip is not None else robot.tip
    if tip is None:
        raise UnknownName("frame (none is named)", "", robot.frames)
    for name in section.lock:
        if name not in robot.joint_names:
            raise UnknownName("joint (robot.lock)", name, robot.joint_names)
    rest = np.array([section.lock.get(name, 0.0) for name in robot.joint_names])
    chain = chain_to(robot, tip, rest)
    chain = lock_joints(chain, {k: v for k, v in section.lock.items() if k in chain.joint_names})
    if chain.n == 0:
        raise InvalidValue("tip", f"frame '{tip}' is fixed to the base; name one that moves")
    held = [] if section.floating else held_base(robot)
    return replace(chain, warnings=(*chain.warnings, *held))


def require_held_joints(chain: Robot) -> None:
    """Raise InvalidValue if a study does not know how a joint is held.

    It puts a spring between each motor and its link, beside whose own spring the file may have
    another one, or takes a free joint's own.
    """
    independent = closed_chain(chain).independent
    for i, joint in enumerate(chain.joints):
        follows, spring = i not in independent, joint.stiffness > 0
        if follows and (spring or joint.actuated):
            fault = "has a spring of its own" if spring else "has a motor"
            fault += ", but follows from others"
        elif not (follows or joint.actuated or spring):
            fault = "has no motor and no spring, so that nothing holds it"
        else:
            continue
        raise InvalidValue(
            "model",
            f"joint '{joint.name}' {fault}; a study adds a spring behind each motor, and seeks "
            "those of joints without one: hold the joint by robot.lock, or change the file",
        )
    for tendon in chain.tendons:
        if tendon.stiffness:
            raise InvalidValue("model", f"tendon '{tendon.name}' has a spring, which a study lacks")


def sprung_joints(chain: Robot, rigid: Sequence[str]) -> tuple[int, ...]:
    """Return the joints whose spring is sought: all that do not follow, but the rigid ones.

    Raises:
        UnknownName: a rigid joint that is none with a motor.
        InvalidValue: no joint is left.
    """
    independent = sorted(closed_chain(chain).independent)
    motors = [chain.joint_names[i] for i in independent if chain.actuated[i]]
    for name in rigid:
        if name not in motors:
            raise UnknownName("joint with a motor", name, motors)
    left = tuple(i for i in independent if chain.joint_names[i] not in rigid)
    if not left:
        raise InvalidValue("rigid", "leaves no joint with a spring")
    return left


def model_of(chain: Robot, file: StudyFile, places: Sequence[int], nominal: Array) -> ImpactModel:
    """Return a chain with nominal springs at some joints; its other motors are rigid.

    Raises:
        InvalidValue, WrongLength: numbers of the drives that do not fit.
    """
    section, motors = file.robot, file.motors
    stiffness = np.full(chain.n, np.inf)
    behind = [i for i in places if chain.actuated[i]]
    stiffness[behind] = [k for i, k in zip(places, nominal, strict=True) if i in behind]
    gain = section.position_gain if motors.position_gain is None else motors.position_gain
    built = drives(
        chain,
        stiffness,
        _rotors(chain, section.rotor_inertia),
        gain,
        section.computed_torque_gain,
        damping_gain=motors.damping_gain,
    )
    if section.floating:
        model = floating_model(floating_robot(chain), drives=built)
    else:
        model = impact_model(chain, drives=built)
    return with_springs(model, nominal)


def _rotors(chain: Robot, given: str | float | list[float] | None) -> PerJoint | None:
    """Return a rotor inertia for each joint; those without a motor keep their own."""
    if isinstance(given, str):
        return chain.rotor_inertia_set(given)
    motors = [i for i, actuated in enumerate(chain.actuated) if actuated]
    if given is None or len(motors) == chain.n:
        return given
    rotors = chain.armature
    names = [chain.joint_names[i] for i in motors]
    rotors[motors] = given if np.ndim(given) == 0 else vector_of(names, "rotor_inertia", given)
    return rotors


def require_known_rotors(model: ImpactModel) -> None:
    """Raise InvalidValue for a motor without a rotor that its spring, or freedom, asks for."""
    robot, known = model.robot, model.drives.rotors_known or ()
    try:
        require_rotors(model.drives, robot.joint_names)
    except InvalidValue as error:
        if not robot.rotors_stated:
            raise
        rigid = "; its file says that it has none: name it in stiffness.rigid"
        raise InvalidValue(error.field, error.reason + rigid) from None
    for i, is_known in enumerate(known):
        if robot.actuated[i] and not is_known:
            raise InvalidValue(
                "rotor_inertia",
                f"nobody states that of joint '{robot.joint_names[i]}', and free motors look safer "
                'without; give it, or take motors.kind = "driven"',
            )


def posture_of(model: ImpactModel, field: str, values: Sequence[float]) -> Array:
    """Return all coordinates of a posture as a study gives it.

    A floating base has none. Joints that follow by a coupling may be left out; of a chain with
    loops it may be the motors' alone, with all springs unbent.

    Raises:
        WrongLength, InvalidValue: numbers that do not fit the robot.
        LoopError: loops that do not close there.
    """
    robot = model.robot
    if is_floating(robot):
        names = robot.joint_names[BASE_COORDINATES:]
        own = len(names) - len(robot.followers)
        if len(values) not in (own, len(names)):
            vector_of(names, field, values)
        values = [0.0] * BASE_COORDINATES + list(values)
    if not robot.loops:
        return robot.vector(field, values)
    chain = closed_chain(robot)
    motors = [i for i in chain.independent if robot.actuated[i]]
    free = robot.n - len(robot.followers)
    if len(values) == len(motors) < free:
        whole = np.array([joint.spring_reference for joint in robot.joints])
        whole[motors] = values
        return close_loops(robot, whole[list(chain.independent)])
    if len(values) not in (free, robot.n) and any(isinstance(loop, Loop) for loop in robot.loops):
        driven = ", ".join(robot.joint_names[i] for i in motors)
        raise InvalidValue(
            field,
            f"has {len(values)} values, but {robot.n} are needed, or {len(motors)} of the motors "
            f"alone ({driven})",
        )
    q = whole_configuration(robot, values, field)
    require_closed_at(robot, q)
    return np.array(closed_near(robot, q[list(chain.independent)], q)).ravel()


def require_within_limits(robot: Robot, field: str, q: Array) -> None:
    """Raise InvalidValue for a coordinate beyond its limits."""
    lower, upper = robot.limits
    for name, value, low, high in zip(robot.joint_names, q, lower, upper, strict=True):
        if not low <= value <= high:
            raise InvalidValue(
                field, f"{value:g} at joint '{name}' is outside its limits [{low:g}, {high:g}]"
            )
