# SPDX-License-Identifier: BSD-3-Clause
"""Masses judged where they count: joint by joint, each with all that moves rigidly with it.

A link without mass between two joints, a point mass, a thin rod or a sensor whose inertia nobody
weighed are no reason to refuse a robot. A mass matrix that is singular or indefinite is.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..errors import InvalidInertia
from .rigid import Array, Inertia, Placement
from .robot import BASE, Joint, JointKind, Robot

NOTHING = 1e-12
"""Inertia that a joint feels, over that of all it carries, below which it moves nothing."""

ROUNDED = 1e-9
"""Part of an inertia that its file's digits may lose."""

SAMPLES = 4
"""Random configurations at which masses are looked at; a mass that is there shows at one."""

NUMBERS_SAMPLED = 200
"""Joints times samples that are enough: a longer robot is looked at more seldom."""

DENSITIES = (1.0, 30_000.0)
"""Density [kg/m³] of the even ellipsoid with a body's inertia; air has 1.2, osmium 22,590."""

PLAIN_DEGREES = (40.0, 3600.0)
"""Limit of a hinge [rad] that must be in degrees; what is beyond is no limit at all."""


def require_sound_masses(robot: Robot) -> None:
    """Raise InvalidInertia if the mass matrix of a robot is singular, indefinite or not known.

    Args:
        robot: with what does not move welded, such as ``chain_to`` returns it.
    """
    missing = [line for joint in robot.joints for line in joint.inertia.missing]
    if missing:
        body = missing[0].split("'")[1]
        words = "; ".join(missing).removeprefix(f"body '{body}' ")
        raise InvalidInertia(
            robot.source or robot.name, body, f"{words}; give it an <inertial> element"
        )
    random = np.random.default_rng(0)
    samples = min(SAMPLES, max(1, NUMBERS_SAMPLED // max(robot.n, 1)))
    felt = [_felt(robot, random.uniform(-1.5, 1.5, robot.n)) for _ in range(samples)]
    least, most = np.min(felt, axis=0), np.max(felt, axis=0)
    negative = [i for i in range(robot.n) if least[i] < -NOTHING]
    if negative:
        body = _body(robot, negative[0])
        raise InvalidInertia(
            robot.source or robot.name,
            body,
            f"with all that is welded to it, its inertia is negative for joint "
            f"'{robot.joint_names[negative[0]]}': the mass matrix is not positive definite; "
            "inertia has an eigenvalue that is not positive",
        )
    still = [i for i in range(robot.n) if most[i] <= NOTHING]
    if still and not robot.loops:
        others = ", ".join(f"'{_body(robot, i)}'" for i in still[1:])
        also = f" (so do {others})" if others else ""
        raise InvalidInertia(
            robot.source or robot.name,
            _body(robot, still[0]),
            "moves but has no mass and inertia > 0 about or along its joint "
            f"'{robot.joint_names[still[0]]}'{also}; give it an <inertial> element",
        )


def _felt(robot: Robot, q: Array) -> Array:
    """Inertia at each joint with the joints beyond it loose, over that of all it carries.

    The pivots of the mass matrix from the tip on (Featherstone, Rigid Body Dynamics Algorithms,
    ch. 7).
    """
    loose = [_spatial(joint.inertia) for joint in robot.joints]
    whole = [_spatial(joint.inertia) for joint in robot.joints]
    felt = np.zeros(robot.n)
    for i in reversed(range(robot.n)):
        joint = robot.joints[i]
        hinge = joint.kind is JointKind.HINGE
        axis = 2 if hinge else 5
        block = slice(0, 3) if hinge else slice(3, 6)
        scale = float(np.abs(np.diag(whole[i])[block]).sum())
        pivot = float(loose[i][axis, axis])
        felt[i] = pivot / scale if scale > 0 else 0.0
        if abs(felt[i]) > NOTHING:
            column = loose[i][:, axis]
            loose[i] = loose[i] - np.outer(column, column) / pivot
        if joint.parent != BASE:
            X = _motion(joint.pose(float(q[i])))
            loose[joint.parent] = loose[joint.parent] + X.T @ loose[i] @ X
            whole[joint.parent] = whole[joint.parent] + X.T @ whole[i] @ X
    return felt


def _spatial(inertia: Inertia) -> Array:
    """Inertia as a 6×6 matrix over angular and linear velocity at the frame's origin."""
    h = _cross(inertia.first_moment)
    return np.block([[inertia.about_origin, h], [h.T, inertia.mass * np.eye(3)]])


def _motion(pose: Placement) -> Array:
    """Matrix that takes a velocity in the parent's frame to the moved frame's."""
    R = pose.rotation.T
    return np.block([[R, np.zeros((3, 3))], [-R @ _cross(pose.translation), R]])


def _cross(v: Array) -> Array:
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def _body(robot: Robot, joint: int) -> str:
    """Name of the first body that a joint moves."""
    names = (frame.name for frame in robot.frames.values() if frame.joint == joint)
    return next(names, robot.joints[joint].name)


def implausible(robot: Robot) -> Iterator[str]:
    """Yield what looks wrong in a robot's numbers, a line each."""
    bodies: dict[int, str] = {}
    for frame in robot.frames.values():
        bodies.setdefault(frame.joint, frame.name)
    names = [bodies.get(i, joint.name) for i, joint in enumerate(robot.joints)]
    for name, joint in zip(names, robot.joints, strict=True):
        line = _doubt(joint.inertia)
        if line:
            yield f"body '{name}' {line}"
    odd = {name: _density(j.inertia) for name, j in zip(names, robot.joints, strict=True)}
    shown = [
        f"'{body}' ({density:.2g} kg/m³)"
        for body, density in odd.items()
        if density is not None and not DENSITIES[0] <= density <= DENSITIES[1]
    ]
    if shown:
        yield f"inertias of implausible density: {', '.join(shown)}"
    yield from _doubtful_limits(robot)
    empty = [f"'{name}'" for name, j in zip(names, robot.joints, strict=True) if not j.inertia.mass]
    if empty:
        yield f"bodies without mass between or after joints: {', '.join(empty)}"
    armature = robot.armature
    if robot.n > 2 and armature[0] > 0 and (armature == armature[0]).all():
        digits = f"{armature[0]:e}".split("e")[0].rstrip("0.")
        if digits == "1":
            yield f"an armature of {armature[0]:g} at every joint looks like a placeholder"


def _doubtful_limits(robot: Robot) -> Iterator[str]:
    for joint in robot.joints:
        widest = max(abs(joint.lower), abs(joint.upper))
        if joint.kind is JointKind.HINGE and PLAIN_DEGREES[0] < widest < PLAIN_DEGREES[1]:
            yield f"limits of joint '{joint.name}' look like degrees ({widest:g} rad)"
        if joint.lower == joint.upper:
            yield f"limits of joint '{joint.name}' leave it no room"


def _doubt(inertia: Inertia) -> str | None:
    """Say what no body can have, or no usual one."""
    if not inertia.mass > 0:
        return "has moments of inertia but no mass" if inertia.about_origin.any() else None
    moments = _moments(inertia)
    scale = max(moments[2], abs(inertia.about_origin).max() * 1e-3)
    if moments[0] < -ROUNDED * scale:
        return f"has a negative moment of inertia ({moments[0]:.3g} kg m²), as no body has"
    excess = moments[2] - moments[0] - moments[1]
    if excess > ROUNDED * scale:
        share = 100 * excess / moments[2]
        return f"has an inertia that violates the triangle inequality (by {share:.2g} %)"
    return None


def _moments(inertia: Inertia) -> Array:
    """Principal moments about the centre of mass, ascending."""
    c = inertia.first_moment / inertia.mass
    steiner = inertia.mass * (c @ c * np.eye(3) - np.outer(c, c))
    return np.asarray(np.linalg.eigvalsh(inertia.about_origin - steiner))


def _density(inertia: Inertia) -> float | None:
    """Density of the even ellipsoid with an inertia; None for a point, a rod, a plate or none."""
    if not inertia.mass > 0:
        return None
    moments = _moments(inertia)
    squares = 2.5 * (moments.sum() - 2 * moments) / inertia.mass  # of the ellipsoid's half axes
    if squares.min() <= ROUNDED * squares.max():
        return None
    return float(inertia.mass / (4 / 3 * np.pi * np.sqrt(squares.prod())))


def outside(joint: Joint, coordinate: float) -> bool:
    """Whether a coordinate is beyond a joint's limits by more than rounding."""
    room = 1e-6 * max(1.0, abs(coordinate))
    return not joint.lower - room <= coordinate <= joint.upper + room
