# SPDX-License-Identifier: BSD-3-Clause
"""Equivalent robots whose expressions are short: sparse joint frames and base parameters.

A joint's frame may be slid along and turned about its axis without changing the robot; placed as
in the modified Denavit-Hartenberg convention, most constants become 0 or 1 and fold away. What a
joint cannot feel of its body (mass and first moment on its axis, one diagonal moment) is handed
down to the parent, which leaves the base parameters (Khalil and Dombre, Modeling, Identification
and Control of Robots, ch. 9).
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from .rigid import ROTATION_NOISE, Array, Inertia, Placement, product, rotation_about_z
from .robot import BASE, Joint, JointKind, Robot

NEARLY_PARALLEL = 2e-2
"""Sine of the angle between axes below which their common normal is too far away to be used."""

NOISE = 1e-14
"""Lengths and inertias below this share of the robot's largest are taken as zero."""


@lru_cache(maxsize=64)
def customised(robot: Robot) -> Robot:
    """Return the equivalent robot with sparse joint frames and base parameters.

    Coordinates, limits and the world poses of all frames are unchanged, and so are the mass
    matrix, the gravity torques and the Coriolis torques. Bodies' inertias are no longer physical.
    """
    return _with_base_parameters(_with_sparse_frames(robot))


def _with_sparse_frames(robot: Robot) -> Robot:
    moves = [_move(slide, turn) for slide, turn in _frame_moves(robot)]
    joints = []
    for joint, move in zip(robot.joints, moves, strict=True):
        parent_move = Placement.identity() if joint.parent == BASE else moves[joint.parent]
        placement = parent_move.inverse() @ joint.placement @ move
        offset = joint.offset
        if joint.kind is JointKind.HINGE:  # a turn about its axis is an offset of its coordinate
            sparse = _sparse_rotation(placement.rotation[:, 2])
            turn = product(sparse.T, placement.rotation)
            offset = _quarter_turns(offset + float(np.arctan2(turn[1, 0], turn[0, 0])))
            placement = Placement(sparse, placement.translation)
        joints.append(
            replace(
                joint,
                placement=_without_noise(placement),
                inertia=joint.inertia.seen_from(move.inverse()),
                offset=offset,
            )
        )
    frames = {
        name: frame
        if frame.joint == BASE
        else replace(
            frame, placement=_without_noise(moves[frame.joint].inverse() @ frame.placement)
        )
        for name, frame in robot.frames.items()
    }
    return replace(robot, joints=tuple(joints), frames=frames)


def _move(slide: float, turn: float) -> Placement:
    return Placement(rotation_about_z(turn), np.array([0.0, 0.0, slide]))


def _sparse_rotation(axis: Array) -> Array:
    """Rotation with the most zeros that takes z to a unit axis."""
    horizontal = np.hypot(axis[0], axis[1])
    if horizontal == 0.0:
        return np.diag([1.0, axis[2], axis[2]])
    x = np.array([axis[1], -axis[0], 0.0]) / horizontal
    x = x if x[0] > 0.0 or (x[0] == 0.0 and x[1] > 0.0) else -x
    return Placement(np.column_stack([x, np.cross(axis, x), axis]), np.zeros(3)).rotation


def _frame_moves(robot: Robot) -> list[tuple[float, float]]:
    """Slide [m] along and turn [rad] about z of every joint's frame, in its own frame."""
    slides: list[float] = []
    for joint in robot.joints:
        slides.append(_slide_to_parent_axis(joint, slides))
    heir = _heaviest_children(robot)
    turns = [
        _turn_to_child_axis(robot.joints[child], slides[i], slides[child]) if child != BASE else 0.0
        for i, child in enumerate(heir)
    ]
    return list(zip(slides, turns, strict=True))


def _slide_to_parent_axis(joint: Joint, slides: list[float]) -> float:
    """Slide along z to the foot of the common normal with the parent's axis."""
    if joint.parent == BASE or joint.kind is JointKind.SLIDE:
        return 0.0
    p = joint.placement.translation - [0.0, 0.0, slides[joint.parent]]
    axis = joint.placement.rotation[:, 2]
    horizontal = float(product(axis[:2], axis[:2]))
    if horizontal < NEARLY_PARALLEL**2:
        return float(-p[2] * axis[2])
    return float(-product(p[:2], axis[:2]) / horizontal)


def _turn_to_child_axis(child: Joint, slide: float, child_slide: float) -> float:
    """Turn about z that lays x along the common normal with the child's axis."""
    axis = child.placement.rotation[:, 2]
    foot = child.placement.translation + child_slide * axis - [0.0, 0.0, slide]
    if np.hypot(*axis[:2]) > NEARLY_PARALLEL:
        normal = np.array([axis[1], -axis[0]])
    elif np.hypot(*foot[:2]) > NOISE:
        normal = foot[:2]
    else:
        normal = child.placement.rotation[:2, 0]
    half_turns = float(np.arctan2(normal[1], normal[0])) % np.pi  # a normal has no sign
    return _quarter_turns(half_turns if half_turns < np.pi - 1e-9 else half_turns - np.pi)


def _quarter_turns(angle: float) -> float:
    """Return the angle, exact if it is a multiple of a quarter turn up to noise."""
    quarters = round(angle / (np.pi / 2))
    return quarters * np.pi / 2 if abs(angle - quarters * np.pi / 2) < ROTATION_NOISE else angle


def _heaviest_children(robot: Robot) -> list[int]:
    """For each joint, the child with the most joints after it (BASE for none)."""
    size = [1] * robot.n
    heir = [BASE] * robot.n
    for i in reversed(range(robot.n)):
        parent = robot.joints[i].parent
        if parent == BASE:
            continue
        size[parent] += size[i]
        if heir[parent] == BASE or size[i] > size[heir[parent]]:
            heir[parent] = i
    return heir


def _without_noise(placement: Placement) -> Placement:
    p = placement.translation
    scale = max(1.0, float(abs(p).max()))
    return Placement(placement.rotation, np.where(abs(p) < NOISE * scale, 0.0, p))


def _with_base_parameters(robot: Robot) -> Robot:
    inertias = [joint.inertia for joint in robot.joints]
    scale = max((abs(i.about_origin).max() for i in inertias), default=1.0)
    for i in reversed(range(robot.n)):
        joint = robot.joints[i]
        unseen = _unseen_part(joint.kind, inertias[i])
        inertias[i] = _rounded(inertias[i] - unseen, scale)
        if joint.parent != BASE:
            moved = unseen.seen_from(joint.placement)
            inertias[joint.parent] = inertias[joint.parent] + moved
    joints = tuple(
        replace(joint, inertia=inertia)
        for joint, inertia in zip(robot.joints, inertias, strict=True)
    )
    return replace(robot, joints=joints)


def _unseen_part(kind: JointKind, inertia: Inertia) -> Inertia:
    """Return the part of a body's inertia that may be moved to its parent unnoticed."""
    if kind is JointKind.SLIDE:
        return Inertia(0.0, np.zeros(3), inertia.about_origin)
    yy = inertia.about_origin[1, 1]
    on_axis = np.array([0.0, 0.0, inertia.first_moment[2]])
    return Inertia(inertia.mass, on_axis, np.diag([yy, yy, 0.0]))


def _rounded(inertia: Inertia, scale: float) -> Inertia:
    def clean(array: Array) -> Array:
        return np.where(abs(array) < NOISE * scale, 0.0, array)

    return Inertia(inertia.mass, clean(inertia.first_moment), clean(inertia.about_origin))
