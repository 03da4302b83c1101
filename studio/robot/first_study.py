# SPDX-License-Identifier: BSD-3-Clause
"""A study file to begin with: what a robot's file has, and what somebody has to fill in."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from softimpact.simulate.history import HORIZON
from softimpact.symbolic import (
    InvalidValue,
    Loop,
    LoopError,
    Robot,
    SingularDirection,
    approach_velocity,
    arm_of,
    close_loops,
    drives,
    impact_model,
    load_robot,
)
from softimpact.symbolic.loops.couplings import whole_configuration
from softimpact.symbolic.loops.loops import closed_chain
from softimpact.symbolic.robot.loading import model_path
from softimpact.symbolic.robot.plausibility import outside
from softimpact.symbolic.robot.rigid import Array

POSES_TRIED = 200
"""Random configurations of which the one that moves best in all directions is taken."""

ROTOR = 0.1
"""Reflected inertia that stands for one that nobody states [kg m²]."""

MARGIN = 0.8
"""Share of the stiffness that a design can bear in the first pose, for those that follow."""

DIRECTIONS = ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, -1.0))

NOMINAL = 1.5e4
"""Joint stiffness to begin with [N·m/rad], as of harmonic drives in arms of this size."""

TEXT = """# A study of {name}: which joint springs, and which posture, make an impact harmless.
# Written by "softimpact init"; see what is marked with TODO, then run
# "softimpact check" and "softimpact design" on it.
title = "{name}"

[robot]
model = {model}
tip = {tip}  # contact frame{others}
{base}{rotors}

[impact]
region = "chest"  # TODO: chest, head, hand, ...: what may be hit
clamped = true  # whether it is held, or can give way
direction = {direction}  # TODO: in which the tip moves, base axes
speed = 0.5  # TODO: of the tip, m/s

# What the motors do; without this table the worse of free motors and of motors that drive on.
{motors}

[stiffness]  # of the joints' springs, N·m/rad: one number, or one for each of {joints}
{rigid}lower = {lower}
upper = {upper}
nominal = {nominal}  # TODO: of the springs that the robot has now

[accuracy]  # how far the tip may give way
forces = [[30.0, 0.0, 0.0], [0.0, 30.0, 0.0], [0.0, 0.0, 30.0]]  # N, base axes
max_deflection = 0.001  # TODO: m

[task]
pose_of = "first"  # the tip is held where this pose has it
exact = true

# Candidate postures, rad and m{angles}.
# TODO: those of your task; limits are
{limits}
[[poses]]
name = "first"
q = {q}
"""


def first_study(
    model: str, tip: str | None = None, *, hold_base: bool = False
) -> tuple[str, list[str]]:
    """Return a study file for a robot, and what there is to say about its model file.

    Args:
        model: name of a robot, or path of a file.
        tip: contact frame; default the robot's own.
        hold_base: whether to hold a base that floats or stands, where its file has it.

    Raises:
        SoftImpactError: the robot cannot be read, or no contact frame that moves is named.
    """
    robot = load_robot(model, hold_base=hold_base, toward=tip)
    arm = arm_of(robot, tip, tip)
    q, direction = first_posture(arm.robot)
    looped = _has_loops(arm.robot)
    path = model_path(model)
    name = model if path.name != Path(model).name else str(path.resolve())
    others = [frame for frame in robot.frames if frame != arm.robot.tip]
    text = TEXT.format(
        name=robot.name.replace('"', "'"),
        model=json.dumps(name, ensure_ascii=False),
        tip=json.dumps(arm.robot.tip, ensure_ascii=False),
        others=f"; others are {', '.join(others[:8])}" if others else "",
        base="hold_base = true  # else floating = true\n" if hold_base else "",
        rotors=_rotors(arm.robot),
        direction=list(direction),
        motors=_motors(arm.robot),
        angles=", of the motors alone: loops close, and springs are unbent" if looped else "",
        **_springs(arm.robot, q, direction),
        limits="".join(
            f"#   {joint.name}: {joint.lower:g} to {joint.upper:g}\n" for joint in arm.robot.joints
        ),
        q=[round(float(q[i]), 3) for i in _entries(arm.robot)],
    )
    return text, [*arm.robot.warnings, *arm.warnings, *_not_held(arm.robot)]


def _not_held(robot: Robot) -> list[str]:
    """Say what a study does not take, before somebody fills it in."""
    from softimpact.optimize.study.study_robot import require_held_joints

    try:
        require_held_joints(robot)
    except InvalidValue as error:
        return [error.reason]
    return []


def _has_loops(robot: Robot) -> bool:
    return any(isinstance(loop, Loop) for loop in robot.loops)


def _entries(robot: Robot) -> list[int]:
    """Return the joints that a pose of a study names."""
    if _has_loops(robot):
        return [i for i in closed_chain(robot).independent if robot.actuated[i]]
    return [i for i, name in enumerate(robot.joint_names) if name not in robot.followers]


def _springs(robot: Robot, q: Array, direction: tuple[float, ...]) -> dict[str, str]:
    """Return what a study says of the springs; those of a file's passive joints are its own.

    Motors whose rotors are nothing, as a file may state, have no spring.
    """
    from softimpact.optimize.study.study_robot import sprung_joints

    direct = [
        joint.name
        for joint in robot.joints
        if joint.actuated and robot.rotors_stated and not joint.armature
    ]
    try:
        places = sprung_joints(robot, direct)
    except InvalidValue:  # no joint is left
        places, direct = sprung_joints(robot, []), []
    own = np.array([robot.joints[i].stiffness for i in places])
    nominal = np.where(own > 0, own, NOMINAL)
    upper = np.where(own > 0, 10 * own, _upper(robot, q, direction, places))

    def shown(values: Array) -> str:
        rounded = [f"{value:.12g}" for value in values]
        return rounded[0] if len(set(rounded)) == 1 else f"[{', '.join(rounded)}]"

    return {
        "joints": ", ".join(robot.joint_names[i] for i in places),
        "rigid": f"rigid = {json.dumps(direct)}  # their motors drive directly\n" if direct else "",
        "lower": shown(nominal / 50),
        "upper": shown(upper),
        "nominal": shown(nominal),
    }


def _upper(robot: Robot, q: Array, direction: tuple[float, ...], places: tuple[int, ...]) -> float:
    """Return springs as stiff as ten times the nominal ones, or as a design can bear."""
    from softimpact.optimize.impact.timing import stiffest_in_time

    behind = [i for i in places if robot.actuated[i]]
    if not behind:
        return 10 * NOMINAL
    sets = [np.array(values) for values in robot.rotor_inertia_sets.values()]
    lightest = np.min(sets, axis=0) if sets else np.full(robot.n, ROTOR)
    rotors = np.where(robot.armature > 0, robot.armature, lightest)
    stiffness = np.full(robot.n, np.inf)
    stiffness[behind] = NOMINAL
    model = impact_model(robot, drives=drives(robot, stiffness, rotors))
    most = MARGIN * stiffest_in_time(model, q, np.array(direction), HORIZON)
    return float(f"{min(10 * NOMINAL, most):.1e}")


def _unknown(robot: Robot) -> list[str]:
    """Names of the joints of whose rotors nothing is known."""
    if robot.rotors_stated:
        return []
    return [joint.name for joint in robot.joints if joint.actuated and not joint.armature]


def _rotors(robot: Robot) -> str:
    """Lines on rotor inertias: the file's, its named sets, or that there are none."""
    unknown, lines = _unknown(robot), []
    if unknown:
        lines += [
            f"# TODO: the model has no rotor inertia of {', '.join(unknown)};",
            "# give it, reflected to the joints, kg m²:",
            f"# rotor_inertia = {[ROTOR] * sum(robot.actuated)}",
        ]
    else:
        shown = ", ".join(f"{joint.armature:g}" for joint in robot.joints if joint.actuated)
        lines.append(f"# rotor inertias of the model, kg m²: {shown}")
    if robot.rotor_inertia_sets:
        sets = ", ".join(f'"{name}"' for name in robot.rotor_inertia_sets)
        lines.append(f"# rotor_inertia: one of its sets ({sets}), or kg m² for each joint")
    return "\n".join(lines)


def _motors(robot: Robot) -> str:
    """Return lines on what the motors do, with the gains of the file's servos."""
    lines = ["# [motors]", '# kind = "servo"  # free, servo or driven']
    if robot.position_gains.any():
        lines += [
            f"# position_gain = {robot.position_gains.tolist()}  # N·m/rad, the model's servo",
            f"# damping_gain = {robot.velocity_gains.tolist()}  # N·m·s/rad, the model's servo",
        ]
    else:
        lines += ["# position_gain = 3000.0  # TODO: N·m/rad, of a servo; the model has none"]
    return "\n".join([*lines, "# reaction_time = 0.02  # s, from first touch on"])


def first_posture(robot: Robot) -> tuple[Array, tuple[float, ...]]:
    """Return a configuration within the limits that moves well, and a direction it can move in."""
    lower, upper = (np.clip(bound, -np.pi, np.pi) for bound in robot.limits)
    middle, room = (lower + upper) / 2, (upper - lower) / 2
    random = np.random.default_rng(0)
    model = impact_model(robot)
    best: tuple[float, Array, tuple[float, ...]] | None = None
    for _ in range(POSES_TRIED):
        tried = (middle + 0.6 * room * random.uniform(-1, 1, robot.n)).round(3)
        q = _closed(robot, tried)
        if q is None:
            continue
        J = np.array(model.jacobian(q))
        for direction in DIRECTIONS:
            try:
                approach_velocity(model, q, direction)
            except SingularDirection:
                continue
            values = np.linalg.svd(J, compute_uv=False)
            score = float(values[values > 1e-9].min(initial=1.0)) - 1e-3 * DIRECTIONS.index(
                direction
            )
            if best is None or score > best[0]:
                best = (score, q, direction)
    return (middle, DIRECTIONS[0]) if best is None else best[1:]


NEAR_HOME = 0.3
"""How far from home motors of a chain with loops are tried, which closes there [rad, m]."""


def _closed(robot: Robot, tried: Array) -> Array | None:
    """Return a configuration that keeps loops and couplings; None where there is none nearby."""
    if not robot.loops:
        return tried
    chain = closed_chain(robot)
    if not _has_loops(robot):
        own = [i for i, name in enumerate(robot.joint_names) if name not in robot.followers]
        q = whole_configuration(robot, tried[own])
        return q if not any(outside(j, x) for j, x in zip(robot.joints, q, strict=True)) else None
    start = np.array([joint.spring_reference for joint in robot.joints])
    motors = [i for i in chain.independent if robot.actuated[i]]
    start[motors] = (chain.home + NEAR_HOME * np.sin(tried))[motors].round(3)
    try:
        return close_loops(robot, start[list(chain.independent)])
    except LoopError:
        return None
