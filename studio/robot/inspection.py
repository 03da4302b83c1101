# SPDX-License-Identifier: BSD-3-Clause
"""What a robot's file says, as one plain dictionary."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from softimpact.symbolic import (
    Coupling,
    JointKind,
    Robot,
    SoftImpactError,
    UnsupportedModel,
    arm_of,
    load_robot,
    own_joints,
)
from softimpact.symbolic.robot.constraints import Ball, Constraint, Terms, Through
from softimpact.symbolic.robot.loading import model_path
from softimpact.symbolic.robot.plausibility import implausible
from softimpact.symbolic.robot.robot import BASE

from .second_opinions import second_opinions


def inspected(model: str, tip: str | None = None) -> dict[str, Any]:
    """Return joints, masses, drives, frames, constraints, doubts and second opinions.

    A robot that floats is shown with its base held.

    Args:
        model: name of a robot, or path of a file.
        tip: frame whose reach is shown; default the robot's own.

    Raises:
        SoftImpactError: the robot cannot be read.
    """
    path = model_path(model)
    robot, base = _with_base(model, tip)
    warnings = list(dict.fromkeys((*robot.warnings, *implausible(robot))))
    unknown = _without_rotors(robot)
    if unknown:
        warnings.append(f"no rotor inertia is known of: {', '.join(unknown)}")
    return {
        "robot": robot.name,
        "source": path,
        "base": base,
        "tip": robot.tip,
        "reach": None if robot.tip is None else _reach(robot, robot.tip),
        "moving_mass": sum(joint.inertia.mass for joint in robot.joints),
        "base_mass": robot.base_inertia.mass,
        "q": _entries_of_q(robot),
        "joints": [_joint(robot, i) for i in range(robot.n)],
        "followers": robot.followers,
        "constraints": [_constraint(loop) for loop in robot.loops],
        "tendons": robot.tendons,
        "rotor_inertia_sets": dict(robot.rotor_inertia_sets),
        "frames": [
            {"name": f.name, "joint": None if f.joint == BASE else robot.joint_names[f.joint]}
            for f in robot.frames.values()
        ],
        "second_opinions": second_opinions(robot, path),
        "warnings": warnings,
    }


def _with_base(model: str, tip: str | None) -> tuple[Robot, str]:
    try:
        return load_robot(model, tip), "fixed"
    except UnsupportedModel:
        return load_robot(model, tip, hold_base=True), "floating"


def _entries_of_q(robot: Robot) -> tuple[str, ...]:
    """Return the joints that q has an entry for, in order, where the contact frame is hit."""
    if robot.tip is None:
        return ()
    try:
        return own_joints(arm_of(robot).robot)
    except SoftImpactError:  # it does not move, or is off every way that can be an arm
        return ()


def _without_rotors(robot: Robot) -> list[str]:
    return [
        f"'{joint.name}'"
        for joint in robot.joints
        if joint.actuated and not joint.armature and not robot.rotors_stated
    ]


def _joint(robot: Robot, index: int) -> dict[str, Any]:
    joint = robot.joints[index]
    return {
        "name": joint.name,
        "kind": joint.kind.value,
        "parent": None if joint.parent == BASE else robot.joint_names[joint.parent],
        "bodies": [frame.name for frame in robot.frames.values() if frame.joint == index],
        "lower": joint.lower,
        "upper": joint.upper,
        "speed_limit": joint.speed_limit,
        "torque_limit": joint.torque_limit,
        "motor": joint.actuated,
        "mass": joint.inertia.mass,
        "rotor_inertia": joint.armature,
        "stiffness": joint.stiffness,
        "damping": joint.damping,
        "friction": joint.friction,
        "position_gain": joint.position_gain,
        "velocity_gain": joint.velocity_gain,
    }


def _constraint(loop: Constraint) -> dict[str, str]:
    kind = type(loop).__name__.lower()
    if isinstance(loop, Coupling):
        right = _sum(loop.leading)
        powers = ["", f"({right})", *(f"({right})^{k}" for k in range(2, len(loop.polynomial)))]
        parts = [
            f"{c:g} {power}".strip() for c, power in zip(loop.polynomial, powers, strict=False) if c
        ]
        return {
            "name": loop.name,
            "kind": kind,
            "ties": f"{_sum(loop.driven)} = {' + '.join(parts) or '0'}",
        }
    if isinstance(loop, Ball | Through):
        return {"name": loop.name, "kind": kind, "ties": ", ".join(loop.joints)}
    return {"name": loop.name, "kind": kind, "ties": f"{loop.first} and {loop.second}"}


def _sum(terms: Terms) -> str:
    return " + ".join(name if c == 1 else f"{c:g} {name}" for name, c in terms)


def _reach(robot: Robot, frame: str) -> float:
    """Length of the way from the first joint to a frame, stretched [m]."""
    at = robot.frame(frame)
    way = robot.ancestors(at.joint)
    length = float(np.linalg.norm(at.placement.translation))
    for i in way:
        joint = robot.joints[i]
        if joint.kind is JointKind.SLIDE:
            travel = max(abs(joint.lower), abs(joint.upper))
            length += travel if math.isfinite(travel) else 0.0
        if joint.parent != BASE:
            length += float(np.linalg.norm(joint.placement.translation))
    return length
