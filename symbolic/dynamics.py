# SPDX-License-Identifier: BSD-3-Clause
"""Mass matrix, bias torques and potential energy of a robot, derived recursively.

The recursions run on scalars over the customised robot (``joint_frames``), so that constants
fold and whatever no output needs is never computed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from .joint_frames import customised
from .kinematics import Motion, cross, motions, require_length, rotate
from .matrices import Matrix, on_scalars
from .rigid import Array, Inertia
from .robot import BASE, Joint, JointKind, Robot

STANDARD_GRAVITY = (0.0, 0.0, -9.81)
"""Acceleration of gravity along the base's axes [m/s²]."""


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

    def __add__(self, other: Composite) -> Composite:
        tensor = [a + b for a, b in zip(self.tensor, other.tensor, strict=True)]
        return Composite(self.mass + other.mass, self.first_moment + other.first_moment, tensor)

    def in_parent(self, move: Motion) -> Composite:
        """Return the same masses in the frame of the joint's parent."""
        h = move.to_parent(self.first_moment)
        tensor = _turned(self.tensor, move.cosine, move.sine)
        tensor = _rotated(tensor, move.rotation)
        return Composite(
            self.mass,
            h + self.mass * move.translation,
            _shifted(tensor, self.mass, h, move.translation),
        )


def _turned(tensor: Sequence[Matrix], c: Matrix, s: Matrix) -> list[Matrix]:
    """Turn an inertia tensor about z: ten operations for the xy block instead of thirteen."""
    xx, yy, zz, xy, xz, yz = tensor
    u = s * (xx - yy) + c * (2 * xy)
    t = s * u
    return [xx - t, yy + t, zz, c * u - xy, c * xz - s * yz, s * xz + c * yz]


def _rotated(tensor: Sequence[Matrix], rotation: Array) -> list[Matrix]:
    """Rotate an inertia tensor by a constant matrix."""
    xx, yy, zz, xy, xz, yz = tensor
    full = ca.blockcat([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    R = ca.SX(ca.sparsify(ca.DM(rotation)))
    turned = ca.mtimes(ca.mtimes(R, full), R.T)
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


def _composites(robot: Robot, moves: list[Motion]) -> list[Composite]:
    composites = [Composite.of(joint.inertia) for joint in robot.joints]
    for i in reversed(range(robot.n)):
        parent = robot.joints[i].parent
        if parent != BASE:
            composites[parent] = composites[parent] + composites[i].in_parent(moves[i])
    return composites


def _wrench_of_unit_acceleration(kind: JointKind, body: Composite) -> tuple[Matrix, Matrix]:
    """Force and moment that accelerate a composite body by one along its joint."""
    _, _, zz, _, xz, yz = body.tensor
    h = body.first_moment
    if kind is JointKind.HINGE:
        return ca.vertcat(-h[1], h[0], 0), ca.vertcat(xz, yz, zz)
    return ca.vertcat(0, 0, body.mass), ca.vertcat(h[1], -h[0], 0)


def _felt_by(joint: Joint, force: Matrix, moment: Matrix) -> Matrix:
    return moment[2] if joint.kind is JointKind.HINGE else force[2]


def mass_matrix(robot: Robot, q: Matrix) -> Matrix:
    """Return the links' mass matrix M(q), n×n, without rotors.

    Composite rigid bodies (Featherstone, Rigid Body Dynamics Algorithms, ch. 6) over base
    parameters.

    Args:
        robot: any robot.
        q: configuration, length n, of any matrix kind.
    """
    return on_scalars(_mass_matrix, (customised(robot),), q)


def _mass_matrix(robot: Robot, q: Matrix) -> Matrix:
    moves = motions(robot, q)
    bodies = _composites(robot, moves)
    M = ca.SX(robot.n, robot.n)
    for i, joint in enumerate(robot.joints):
        force, moment = _wrench_of_unit_acceleration(joint.kind, bodies[i])
        below = i
        while True:
            M[i, below] = M[below, i] = _felt_by(robot.joints[below], force, moment)
            move, below = moves[below], robot.joints[below].parent
            if below == BASE:
                break
            force = move.to_parent(force)
            moment = move.to_parent(moment) + cross(move.translation, force)
    return ca.densify(M)


def potential_energy(
    robot: Robot, q: Matrix, gravity: Sequence[float] = STANDARD_GRAVITY
) -> Matrix:
    """Return the potential energy [J] of gravity and of the springs given in the robot's file.

    Args:
        robot: any robot.
        q: configuration, length n, of any matrix kind.
        gravity: acceleration along the base's axes [m/s²].
    """
    return on_scalars(_potential_energy, (customised(robot), tuple(gravity)), q)


def _potential_energy(robot: Robot, gravity: tuple[float, ...], q: Matrix) -> Matrix:
    moves = motions(robot, q)
    masses = [joint.inertia.mass for joint in robot.joints]
    moments = [ca.SX(joint.inertia.first_moment) for joint in robot.joints]
    energy = ca.SX(0.0)
    for i in reversed(range(robot.n)):
        joint = robot.joints[i]
        in_parent = moves[i].to_parent(moments[i]) + masses[i] * moves[i].translation
        if joint.parent == BASE:
            energy -= ca.dot(ca.SX(ca.sparsify(ca.DM(list(gravity)))), in_parent)
        else:
            masses[joint.parent] += masses[i]
            moments[joint.parent] += in_parent
        if joint.stiffness:
            energy += 0.5 * joint.stiffness * (q[i] - joint.spring_reference) ** 2
    return energy


def stiffness_of_potential(
    robot: Robot, q: Matrix, gravity: Sequence[float] = STANDARD_GRAVITY
) -> Matrix:
    """Return the Hessian ∂²V/∂q² of the potential energy, n×n (MSM Eq. 45)."""
    return on_scalars(_potential_hessian, (customised(robot), tuple(gravity)), q)


def _potential_hessian(robot: Robot, gravity: tuple[float, ...], q: Matrix) -> Matrix:
    require_length(robot, "q", q)
    symbol = ca.SX.sym("q", robot.n)
    hessian, _ = ca.hessian(_potential_energy(robot, gravity, symbol), symbol)
    return ca.substitute(ca.densify(hessian), symbol, q)


def gravity_torques(robot: Robot, q: Matrix, gravity: Sequence[float] = STANDARD_GRAVITY) -> Matrix:
    """Return the gradient ∂V/∂q of the potential energy, length n [N·m, N]."""
    return on_scalars(_potential_gradient, (customised(robot), tuple(gravity)), q)


def _potential_gradient(robot: Robot, gravity: tuple[float, ...], q: Matrix) -> Matrix:
    require_length(robot, "q", q)
    symbol = ca.SX.sym("q", robot.n)
    gradient = ca.gradient(_potential_energy(robot, gravity, symbol), symbol)
    return ca.substitute(ca.densify(gradient), symbol, q)


def bias_torques(
    robot: Robot, q: Matrix, velocity: Matrix, gravity: Sequence[float] = STANDARD_GRAVITY
) -> Matrix:
    """Return the torques h(q, q̇) of gravity, Coriolis and centrifugal forces, length n.

    Recursive Newton-Euler with zero acceleration. Springs of the file are not included.

    Args:
        robot: any robot.
        q: configuration, length n, of any matrix kind.
        velocity: joint velocities, length n.
        gravity: acceleration along the base's axes [m/s²].
    """
    return on_scalars(_bias_torques, (customised(robot), tuple(gravity)), q, velocity)


def _bias_torques(robot: Robot, gravity: tuple[float, ...], q: Matrix, velocity: Matrix) -> Matrix:
    require_length(robot, "velocity", velocity)
    moves = motions(robot, q)
    spin = {BASE: ca.SX.zeros(3)}
    spin_rate = {BASE: ca.SX.zeros(3)}
    acceleration = {BASE: -ca.SX(ca.sparsify(ca.DM(list(gravity))))}
    forces, moments = [], []
    for i, joint in enumerate(robot.joints):
        p, move, along = joint.parent, moves[i], ca.vertcat(0, 0, velocity[i])
        w = move.to_child(spin[p])
        a = acceleration[p] + cross(spin_rate[p], move.translation)
        a = move.to_child(a + cross(spin[p], cross(spin[p], move.translation)))
        if joint.kind is JointKind.HINGE:
            spin_rate[i] = move.to_child(spin_rate[p]) + cross(w, along)
            spin[i] = w + along
        else:
            spin_rate[i], spin[i] = move.to_child(spin_rate[p]), w
            a = a + 2 * cross(w, along)
        acceleration[i] = a
        force, moment = _newton_euler(joint.inertia, spin[i], spin_rate[i], a)
        forces.append(force)
        moments.append(moment)
    torques = [ca.SX(0.0)] * robot.n
    for i in reversed(range(robot.n)):
        joint = robot.joints[i]
        torques[i] = _felt_by(joint, forces[i], moments[i])
        if joint.parent != BASE:
            force = moves[i].to_parent(forces[i])
            moment = moves[i].to_parent(moments[i]) + cross(moves[i].translation, force)
            forces[joint.parent] += force
            moments[joint.parent] += moment
    return ca.vertcat(*torques)


def _newton_euler(inertia: Inertia, w: Matrix, dw: Matrix, a: Matrix) -> tuple[Matrix, Matrix]:
    """Force and moment about the origin that give a body its motion."""
    h = ca.SX(ca.sparsify(ca.DM(np.array(inertia.first_moment))))
    h = ca.densify(h)
    force = inertia.mass * a + cross(dw, h) + cross(w, cross(w, h))
    moment = rotate(inertia.about_origin, dw) + cross(w, rotate(inertia.about_origin, w))
    return force, moment + cross(h, a)
