# SPDX-License-Identifier: BSD-3-Clause
"""Mass matrix, bias torques and potential energy of a robot, derived recursively.

The recursions run on scalars over the customised robot (``joint_frames``), so that constants
fold and whatever no output needs is never computed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import overload

import casadi as ca

from ..matrices import Kind, Matrix, Numbers, on_scalars
from ..robot.joint_frames import customised
from ..robot.rigid import Array
from ..robot.robot import BASE, Joint, JointKind, Robot
from .composites import Composite, bodies_of
from .kinematics import JointMotion, cross, motions, poses, require_length

Gravity = Sequence[float] | Array
"""Acceleration along the base's axes [m/s²], length 3."""

FixedGravity = tuple[float, float, float]
"""The same as numbers that may be a key."""

STANDARD_GRAVITY = (0.0, 0.0, -9.81)
"""Acceleration of gravity along the base's axes [m/s²]."""


def _composites(robot: Robot, moves: list[JointMotion]) -> list[Composite]:
    composites = bodies_of(robot)
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


@overload
def mass_matrix(robot: Robot, q: Kind) -> Kind: ...
@overload
def mass_matrix(robot: Robot, q: Numbers) -> ca.DM: ...
def mass_matrix(robot: Robot, q: Matrix) -> Matrix:
    """Return the links' mass matrix M(q), n×n, without rotors; tendons' inertias count as links.

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
    place = {name: i for i, name in enumerate(robot.joint_names)}
    for tendon in robot.tendons if any(t.armature for t in robot.tendons) else ():
        for (first, a), (second, b) in product(tendon.terms, repeat=2):
            M[place[first], place[second]] += tendon.armature * (a * b)
    return ca.densify(M)


@overload
def potential_energy(robot: Robot, q: Kind, gravity: Gravity = STANDARD_GRAVITY) -> Kind: ...
@overload
def potential_energy(robot: Robot, q: Numbers, gravity: Gravity = STANDARD_GRAVITY) -> ca.DM: ...
def potential_energy(robot: Robot, q: Matrix, gravity: Gravity = STANDARD_GRAVITY) -> Matrix:
    """Return the potential energy [J] of gravity and of the springs given in the robot's file.

    Args:
        robot: any robot.
        q: configuration, length n, of any matrix kind.
        gravity: acceleration along the base's axes [m/s²].
    """
    return on_scalars(_potential_energy, (customised(robot), tuple(gravity)), q)


def _potential_energy(robot: Robot, gravity: tuple[float, ...], q: Matrix) -> Matrix:
    moves = motions(robot, q)
    bodies = bodies_of(robot)
    masses = [body.mass for body in bodies]
    moments = [body.first_moment for body in bodies]
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
    place = {name: i for i, name in enumerate(robot.joint_names)}
    for tendon in robot.tendons:
        if tendon.stiffness:
            length = sum(c * q[place[name]] for name, c in tendon.terms)
            energy += 0.5 * tendon.stiffness * (length - tendon.rest) ** 2
    return energy


@overload
def stiffness_of_potential(robot: Robot, q: Kind, gravity: Gravity = STANDARD_GRAVITY) -> Kind: ...
@overload
def stiffness_of_potential(
    robot: Robot, q: Numbers, gravity: Gravity = STANDARD_GRAVITY
) -> ca.DM: ...
def stiffness_of_potential(robot: Robot, q: Matrix, gravity: Gravity = STANDARD_GRAVITY) -> Matrix:
    """Return the Hessian ∂²V/∂q² of the potential energy, n×n (MSM Eq. 45)."""
    return on_scalars(_potential_hessian, (customised(robot), tuple(gravity)), q)


def _potential_hessian(robot: Robot, gravity: tuple[float, ...], q: Matrix) -> Matrix:
    require_length(robot, "q", q)
    symbol = ca.SX.sym("q", robot.n)
    hessian, _ = ca.hessian(_potential_energy(robot, gravity, symbol), symbol)
    return ca.substitute(ca.densify(hessian), symbol, q)


@overload
def gravity_torques(robot: Robot, q: Kind, gravity: Gravity = STANDARD_GRAVITY) -> Kind: ...
@overload
def gravity_torques(robot: Robot, q: Numbers, gravity: Gravity = STANDARD_GRAVITY) -> ca.DM: ...
def gravity_torques(robot: Robot, q: Matrix, gravity: Gravity = STANDARD_GRAVITY) -> Matrix:
    """Return the gradient ∂V/∂q of the potential energy, length n [N·m, N]."""
    return on_scalars(_potential_gradient, (customised(robot), tuple(gravity)), q)


def _potential_gradient(robot: Robot, gravity: tuple[float, ...], q: Matrix) -> Matrix:
    require_length(robot, "q", q)
    symbol = ca.SX.sym("q", robot.n)
    gradient = ca.gradient(_potential_energy(robot, gravity, symbol), symbol)
    return ca.substitute(ca.densify(gradient), symbol, q)


@overload
def bias_torques(
    robot: Robot, q: Kind, velocity: Kind | Numbers, gravity: Gravity = STANDARD_GRAVITY
) -> Kind: ...
@overload
def bias_torques(
    robot: Robot, q: Numbers, velocity: Kind, gravity: Gravity = STANDARD_GRAVITY
) -> Kind: ...
@overload
def bias_torques(
    robot: Robot, q: Numbers, velocity: Numbers, gravity: Gravity = STANDARD_GRAVITY
) -> ca.DM: ...
def bias_torques(
    robot: Robot, q: Matrix, velocity: Matrix, gravity: Gravity = STANDARD_GRAVITY
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


@dataclass(frozen=True)
class _CoastingFrames:
    """How joints' frames move in their own axes while no joint accelerates, by joint."""

    spin: dict[int, Matrix]
    spin_rate: dict[int, Matrix]
    acceleration: dict[int, Matrix]


def _coasting(
    robot: Robot, moves: list[JointMotion], velocity: Matrix, gravity: FixedGravity
) -> _CoastingFrames:
    """Return how all frames move; gravity counts as an acceleration of the base against it."""
    spin = {BASE: ca.SX.zeros(3)}
    spin_rate = {BASE: ca.SX.zeros(3)}
    acceleration = {BASE: -ca.SX(ca.sparsify(ca.DM(list(gravity))))}
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
    return _CoastingFrames(spin, spin_rate, acceleration)


@overload
def bias_acceleration(robot: Robot, frame: str, q: Kind, velocity: Kind | Numbers) -> Kind: ...
@overload
def bias_acceleration(robot: Robot, frame: str, q: Numbers, velocity: Kind) -> Kind: ...
@overload
def bias_acceleration(robot: Robot, frame: str, q: Numbers, velocity: Numbers) -> ca.DM: ...
def bias_acceleration(robot: Robot, frame: str, q: Matrix, velocity: Matrix) -> Matrix:
    """Return the acceleration J̇ q̇ of a frame's origin while joints keep their speed, base axes.

    Args:
        robot: any robot.
        frame: its name; raises FrameNotFound.
        q: configuration, length n, of any matrix kind.
        velocity: joint velocities, length n.
    """
    robot.frame(frame)
    return on_scalars(_bias_acceleration, (customised(robot), frame), q, velocity)


def _bias_acceleration(robot: Robot, name: str, q: Matrix, velocity: Matrix) -> Matrix:
    frame = robot.frame(name)
    moves = motions(robot, q)
    found, i = _coasting(robot, moves, velocity, (0.0, 0.0, 0.0)), frame.joint
    offset = ca.SX(ca.sparsify(ca.DM(frame.placement.translation)))
    w = found.spin[i]
    a = found.acceleration[i] + cross(found.spin_rate[i], offset) + cross(w, cross(w, offset))
    return ca.mtimes(poses(robot, moves)[i].rotation, a)


def _bias_torques(robot: Robot, gravity: FixedGravity, q: Matrix, velocity: Matrix) -> Matrix:
    require_length(robot, "velocity", velocity)
    moves = motions(robot, q)
    found = _coasting(robot, moves, velocity, gravity)
    forces, moments = [], []
    for i, body in enumerate(bodies_of(robot)):
        force, moment = _newton_euler(
            body, found.spin[i], found.spin_rate[i], found.acceleration[i]
        )
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


def _newton_euler(body: Composite, w: Matrix, dw: Matrix, a: Matrix) -> tuple[Matrix, Matrix]:
    """Force and moment about the origin that give a body its motion."""
    h = ca.densify(body.first_moment)
    force = body.mass * a + cross(dw, h) + cross(w, cross(w, h))
    moment = ca.mtimes(body.matrix, dw) + cross(w, ca.mtimes(body.matrix, w))
    return force, moment + cross(h, a)
