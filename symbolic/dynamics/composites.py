# SPDX-License-Identifier: BSD-3-Clause
"""Inertias of bodies over symbols: they add up along the joints, and a payload is one of them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import casadi as ca

from ..matrices import Matrix
from ..robot.rigid import Array, Inertia
from ..robot.robot import JointKind, Robot
from .kinematics import JointMotion, rotate


@dataclass(frozen=True)
class Composite:
    """Inertia of a joint's body and all that it carries, in the joint's frame (SX).

    Attributes:
        mass: in kg.
        first_moment: length 3, kg m.
        tensor: xx, yy, zz, xy, xz, yz about the frame's origin, kg m².
    """

    mass: Matrix
    first_moment: Matrix
    tensor: Sequence[Matrix]

    @staticmethod
    def of(inertia: Inertia) -> Composite:
        """Return the composite of a single body."""
        I = inertia.about_origin  # noqa: E741 - the field's symbol
        tensor = [ca.SX(x) for x in (I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2])]
        return Composite(inertia.mass, ca.SX(inertia.first_moment), tensor)

    @staticmethod
    def of_point(mass: Matrix, position: Matrix) -> Composite:
        """Return the composite of a point mass [kg] at a position [m]."""
        nothing = [ca.SX(0.0)] * 6
        return Composite(mass, mass * position, _shifted(nothing, mass, ca.SX.zeros(3), position))

    @property
    def matrix(self) -> Matrix:
        """Inertia tensor about the frame's origin, 3×3 [kg m²]."""
        return _full(self.tensor)

    def __add__(self, other: Composite) -> Composite:
        tensor = [a + b for a, b in zip(self.tensor, other.tensor, strict=True)]
        return Composite(self.mass + other.mass, self.first_moment + other.first_moment, tensor)

    def in_parent(self, move: JointMotion) -> Composite:
        """Return the same masses in the frame of the joint's parent."""
        tensor = _turned(self.tensor, move.cosine, move.sine)
        h = move.to_parent(self.first_moment)
        return self._placed(h, tensor, move.rotation, move.translation)

    def placed(self, rotation: Array, translation: Matrix) -> Composite:
        """Return the same masses in a frame in which this one has a constant pose."""
        h = rotate(rotation, self.first_moment)
        return self._placed(h, self.tensor, rotation, translation)

    def _placed(
        self, h: Matrix, tensor: Sequence[Matrix], rotation: Array, translation: Matrix
    ) -> Composite:
        tensor = _shifted(_rotated(tensor, rotation), self.mass, h, translation)
        return Composite(self.mass, h + self.mass * translation, tensor)


def bodies_of(robot: Robot) -> list[Composite]:
    """Return the inertia of each joint's body, of which a payload is a part."""
    bodies = [Composite.of(joint.inertia) for joint in robot.joints]
    for i, part in _carried(robot):
        bodies[i] = bodies[i] + part
    return bodies


def _carried(robot: Robot) -> Iterator[tuple[int, Composite]]:
    """Yield what each joint feels of the payload.

    As with base parameters, what a joint cannot feel of it is handed down to the parent, where it
    no longer moves: this depends on the payload alone.
    """
    if robot.payload is None:
        return
    frame = robot.frame(robot.payload.frame)
    arm = rotate(frame.placement.rotation, ca.SX(robot.payload.com))
    body = Composite.of_point(robot.payload.mass, arm + ca.SX(frame.placement.translation))
    for i in robot.ancestors(frame.joint):
        joint = robot.joints[i]
        felt, unseen = _split(joint.kind, body)
        yield i, felt
        body = unseen.placed(joint.placement.rotation, ca.SX(joint.placement.translation))


def _split(kind: JointKind, body: Composite) -> tuple[Composite, Composite]:
    """Return what a joint feels of a body, and what it does not."""
    nothing, zero = ca.SX.zeros(3), ca.SX(0.0)
    if kind is JointKind.SLIDE:
        felt = Composite(body.mass, body.first_moment, [zero] * 6)
        return felt, Composite(zero, nothing, body.tensor)
    h, (xx, yy, zz, xy, xz, yz) = body.first_moment, body.tensor
    felt = Composite(zero, ca.vertcat(h[0], h[1], 0), [xx - yy, zero, zz, xy, xz, yz])
    on_axis = ca.vertcat(0, 0, h[2])
    return felt, Composite(body.mass, on_axis, [yy, yy, zero, zero, zero, zero])


def _full(tensor: Sequence[Matrix]) -> Matrix:
    xx, yy, zz, xy, xz, yz = tensor
    return ca.blockcat([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _turned(tensor: Sequence[Matrix], c: Matrix, s: Matrix) -> list[Matrix]:
    """Turn an inertia tensor about z: ten operations for the xy block instead of thirteen."""
    xx, yy, zz, xy, xz, yz = tensor
    u = s * (xx - yy) + c * (2 * xy)
    t = s * u
    return [xx - t, yy + t, zz, c * u - xy, c * xz - s * yz, s * xz + c * yz]


def _rotated(tensor: Sequence[Matrix], rotation: Array) -> list[Matrix]:
    """Rotate an inertia tensor by a constant matrix."""
    R = ca.SX(ca.sparsify(ca.DM(rotation)))
    turned = ca.mtimes(ca.mtimes(R, _full(tensor)), R.T)
    return [turned[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]


def _shifted(tensor: Sequence[Matrix], mass: Matrix, h: Matrix, p: Matrix) -> list[Matrix]:
    """Move an inertia tensor's origin by p; h is the first moment before the move."""
    xx, yy, zz, xy, xz, yz = tensor
    g = [(2 * h[k]) * p[k] + mass * (p[k] * p[k]) for k in range(3)]

    def off(i: int, j: int) -> Matrix:
        return p[i] * h[j] + p[j] * h[i] + mass * (p[i] * p[j])

    return [
        xx + (g[1] + g[2]),
        yy + (g[0] + g[2]),
        zz + (g[0] + g[1]),
        xy - off(0, 1),
        xz - off(0, 2),
        yz - off(1, 2),
    ]
