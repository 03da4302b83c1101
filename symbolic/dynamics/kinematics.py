# SPDX-License-Identifier: BSD-3-Clause
"""Poses and Jacobians of any frame or point of a robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import overload

import casadi as ca
import numpy as np

from ..errors import WrongLength
from ..matrices import Kind, Matrix, Numbers, on_scalars
from ..robot.joint_frames import customised
from ..robot.rigid import Array
from ..robot.robot import BASE, Joint, JointKind, Robot


@dataclass(frozen=True)
class JointMotion:
    """Where a joint has moved its frame, in the frame of its parent.

    Attributes:
        rotation: constant rotation of the joint's placement, 3×3.
        cosine: of the joint's angle (1 for a slide).
        sine: of the joint's angle (0 for a slide).
        translation: of the joint's origin in the parent's frame, length 3.
    """

    rotation: Array
    cosine: Matrix
    sine: Matrix
    translation: Matrix

    def to_parent(self, v: Matrix) -> Matrix:
        """Rotate a vector of the joint's frame into the parent's."""
        c, s = self.cosine, self.sine
        turned = ca.vertcat(c * v[0] - s * v[1], s * v[0] + c * v[1], v[2])
        return rotate(self.rotation, turned)

    def to_child(self, v: Matrix) -> Matrix:
        """Rotate a vector of the parent's frame into the joint's."""
        c, s = self.cosine, self.sine
        v = rotate(self.rotation.T, v)
        return ca.vertcat(c * v[0] + s * v[1], c * v[1] - s * v[0], v[2])


def motion(joint: Joint, coordinate: Matrix) -> JointMotion:
    """Return a joint's motion at a coordinate."""
    R, p = joint.placement.rotation, ca.SX(joint.placement.translation)
    if joint.kind is JointKind.SLIDE:
        return JointMotion(R, 1.0, 0.0, p + rotate(R, ca.vertcat(0, 0, coordinate + joint.offset)))
    c, s = _cosine_and_sine(joint.offset, coordinate)
    return JointMotion(R, c, s, p)


def _cosine_and_sine(offset: float, angle: Matrix) -> tuple[Matrix, Matrix]:
    """Cosine and sine of offset + angle; a multiple of a quarter turn costs nothing."""
    quarters = offset / (np.pi / 2)
    if quarters != round(quarters):
        return ca.cos(angle + offset), ca.sin(angle + offset)
    c, s = ca.cos(angle), ca.sin(angle)
    return ((c, s), (-s, c), (-c, -s), (s, -c))[round(quarters) % 4]


def require_length(robot: Robot, field: str, values: Matrix) -> None:
    """Raise WrongLength unless there is one value a joint."""
    found = ca.SX(values).numel()
    if found != robot.n:
        raise WrongLength(field, found, robot.n, robot.joint_names)


def motions(robot: Robot, q: Matrix) -> list[JointMotion]:
    """Return the motions of all joints at configuration q; raises WrongLength."""
    require_length(robot, "q", q)
    return [motion(joint, q[i]) for i, joint in enumerate(robot.joints)]


def rotate(rotation: Array, v: Matrix) -> Matrix:
    """Rotate a vector by a constant matrix; zeros and ones cost nothing."""
    return ca.mtimes(ca.SX(ca.sparsify(ca.DM(rotation))), ca.densify(v))


def cross(a: Matrix, b: Matrix) -> Matrix:
    """Cross product of two vectors of length 3."""
    return ca.vertcat(
        a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    )


@dataclass(frozen=True)
class FramePose:
    """Rotation (3×3) and position (3) [m] of a frame in the reference frame."""

    rotation: Matrix
    position: Matrix


def poses(robot: Robot, moves: list[JointMotion], reference: int = BASE) -> dict[int, FramePose]:
    """Return the poses of the base and all joint frames in the frame of joint ``reference``."""
    known = {reference: FramePose(ca.SX.eye(3), ca.SX.zeros(3))}
    child = reference
    while child != BASE:  # against the arrows, down to the base
        parent, move = robot.joints[child].parent, moves[child]
        axes = [move.to_child(ca.SX.eye(3)[:, k]) for k in range(3)]
        rotation = ca.mtimes(known[child].rotation, ca.horzcat(*axes))
        position = known[child].position - ca.mtimes(rotation, move.translation)
        known[parent] = FramePose(rotation, position)
        child = parent
    for i, joint in enumerate(robot.joints):
        if i not in known and joint.parent in known:
            known[i] = _moved(known[joint.parent], moves[i])
    return known


def _moved(parent: FramePose, move: JointMotion) -> FramePose:
    turned = ca.mtimes(parent.rotation, ca.SX(ca.sparsify(ca.DM(move.rotation))))
    x, y, z = (ca.densify(turned[:, k]) for k in range(3))
    c, s = move.cosine, move.sine
    rotation = ca.horzcat(c * x + s * y, c * y - s * x, z)
    return FramePose(rotation, parent.position + ca.mtimes(parent.rotation, move.translation))


def frame_pose(robot: Robot, frame: str, q: Matrix) -> FramePose:
    """Return the pose of a frame in the base.

    Args:
        robot: any robot.
        frame: its name; raises FrameNotFound.
        q: configuration, length n, of any matrix kind.
    """
    robot.frame(frame)
    both = on_scalars(_frame_pose, (customised(robot), frame), q)
    return FramePose(both[:, :3], both[:, 3])


def _frame_pose(robot: Robot, name: str, q: Matrix) -> Matrix:
    frame = robot.frame(name)
    carrier = poses(robot, motions(robot, q))[frame.joint]
    offset = ca.SX(ca.sparsify(ca.DM(frame.placement.translation)))
    position = carrier.position + ca.mtimes(carrier.rotation, offset)
    rotation = ca.mtimes(carrier.rotation, ca.SX(ca.sparsify(ca.DM(frame.placement.rotation))))
    return ca.horzcat(ca.densify(rotation), ca.densify(position))


@overload
def frame_jacobian(robot: Robot, frame: str, q: Kind) -> Kind: ...
@overload
def frame_jacobian(robot: Robot, frame: str, q: Numbers) -> ca.DM: ...
def frame_jacobian(robot: Robot, frame: str, q: Matrix) -> Matrix:
    """Return the 6×n Jacobian of a frame: velocity of its origin [m/s], then angular [rad/s].

    Both are in the base's axes (Pinocchio's LOCAL_WORLD_ALIGNED).

    Args:
        robot: any robot.
        frame: its name; raises FrameNotFound.
        q: configuration, length n, of any matrix kind.
    """
    robot.frame(frame)
    return on_scalars(_jacobian, (customised(robot), frame, BASE), q)


@overload
def contact_point_jacobian(robot: Robot, frame: str, q: Kind, axes_of: int = BASE) -> Kind: ...
@overload
def contact_point_jacobian(robot: Robot, frame: str, q: Numbers, axes_of: int = BASE) -> ca.DM: ...
def contact_point_jacobian(robot: Robot, frame: str, q: Matrix, axes_of: int = BASE) -> Matrix:
    """Return the translational 3×n Jacobian J of a frame's origin: v = J q̇ (GIAF Eq. 1).

    Args:
        robot: any robot.
        frame: its name; raises FrameNotFound.
        q: configuration, length n, of any matrix kind.
        axes_of: index of the joint in whose axes v is expressed. Rotation-free quantities such as
            GIAF come out shortest halfway up the arm.
    """
    robot.frame(frame)
    return on_scalars(_jacobian, (customised(robot), frame, axes_of), q)[:3, :]


def _jacobian(robot: Robot, name: str, axes_of: int, q: Matrix) -> Matrix:
    frame = robot.frame(name)
    known = poses(robot, motions(robot, q), axes_of)
    carrier = known[frame.joint]
    offset = ca.SX(ca.sparsify(ca.DM(frame.placement.translation)))
    tip = carrier.position + ca.mtimes(carrier.rotation, offset)
    columns = [ca.SX.zeros(6)] * robot.n
    for i in robot.ancestors(frame.joint):
        axis = ca.densify(known[i].rotation[:, 2])
        if robot.joints[i].kind is JointKind.HINGE:
            columns[i] = ca.vertcat(cross(axis, tip - known[i].position), axis)
        else:
            columns[i] = ca.vertcat(axis, ca.SX.zeros(3))
    return ca.horzcat(*columns)


def placed_point_jacobian(robot: Robot, q: Matrix, place: Matrix, moved_by: Matrix) -> Matrix:
    """Return the translational 3×n Jacobian J of a point that is given by its place.

    Args:
        robot: any robot.
        q: configuration, length n, of any matrix kind.
        place: where the point is, base axes, length 3 [m].
        moved_by: 1 for each joint that moves it, else 0, length n.
    """
    return on_scalars(_placed_jacobian, (customised(robot),), q, place, moved_by)


def _placed_jacobian(robot: Robot, q: Matrix, place: Matrix, moved_by: Matrix) -> Matrix:
    known = poses(robot, motions(robot, q))
    columns = []
    for i, joint in enumerate(robot.joints):
        axis = ca.densify(known[i].rotation[:, 2])
        turns = joint.kind is JointKind.HINGE
        way = cross(axis, ca.SX(place) - known[i].position) if turns else axis
        columns.append(moved_by[i] * way)
    return ca.horzcat(*columns)


@overload
def direction_jacobian(robot: Robot, frame: str, q: Kind, direction: Kind | Numbers) -> Kind: ...
@overload
def direction_jacobian(robot: Robot, frame: str, q: Numbers, direction: Numbers) -> ca.DM: ...
def direction_jacobian(robot: Robot, frame: str, q: Matrix, direction: Matrix) -> Matrix:
    """Return the row J_c = nᵀJ (1×n) of a frame's origin along n: ẋ_c = J_c q̇ (MSM Eq. 4).

    The unit force n at the contact point is handed down the joints, which is shorter than to
    build J and project it.

    Args:
        robot: any robot.
        frame: its name; raises FrameNotFound.
        q: configuration, length n, of any matrix kind.
        direction: unit vector n in the base's axes, length 3.
    """
    robot.frame(frame)
    return on_scalars(_direction_jacobian, (customised(robot), frame), q, direction)


def _direction_jacobian(robot: Robot, name: str, q: Matrix, direction: Matrix) -> Matrix:
    frame = robot.frame(name)
    moves = motions(robot, q)
    path = robot.ancestors(frame.joint)
    force = {BASE: ca.SX(direction)}
    for i in reversed(path):
        force[i] = moves[i].to_child(force[robot.joints[i].parent])
    row = [ca.SX(0.0)] * robot.n
    moment = cross(ca.SX(frame.placement.translation), force[frame.joint])
    for i in path:
        joint = robot.joints[i]
        row[i] = moment[2] if joint.kind is JointKind.HINGE else force[i][2]
        parent_force = force[joint.parent]
        moment = moves[i].to_parent(moment) + cross(moves[i].translation, parent_force)
    return ca.horzcat(*row)
