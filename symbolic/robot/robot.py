# SPDX-License-Identifier: BSD-3-Clause
"""A robot as frozen data: a tree of hinges and slides, the bodies they move, and named frames."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum

import numpy as np
from numpy.typing import ArrayLike

from ..content import ByContent
from ..errors import FrameNotFound, InvalidValue, UnknownName, WrongLength
from ..matrices import Matrix
from .constraints import Ball, Constraint, Coupling, Loop, Tendon, Through
from .rigid import Array, Inertia, Placement, rotation_about_z, three_numbers

BASE = -1
"""Index of the base where a joint's index is expected."""


class JointKind(Enum):
    """What a joint lets its body do about or along its z axis."""

    HINGE = "hinge"
    SLIDE = "slide"


@dataclass(frozen=True, eq=False)
class Joint(ByContent):
    """A joint, and all that moves rigidly with it.

    Attributes:
        name: as in the file.
        kind: hinge (coordinate in rad) or slide (m).
        parent: index of the joint that carries this one, or ``BASE``.
        placement: the joint's frame in the parent joint's frame at coordinate zero; its axis is z.
        offset: constant added to the coordinate.
        inertia: of the moved bodies, in the joint's frame.
        lower: lower limit of the coordinate (-inf without one).
        upper: upper limit of the coordinate (inf without one).
        armature: reflected rotor inertia [kg m², kg].
        stiffness: of a spring in parallel with the joint [N·m/rad, N/m].
        spring_reference: coordinate at which that spring is unloaded.
        actuated: whether a motor drives the joint; passive joints have none.
        damping: of a damper in parallel with the joint [N·m·s/rad, N·s/m].
        friction: dry friction of the joint [N·m, N].
        position_gain: K_p of the file's servo on the joint [N·m/rad, N/m]; 0 where it has none.
        velocity_gain: K_d of that servo [N·m·s/rad, N·s/m].
        torque_limit: largest torque of the motor on the joint [N·m, N]; inf where unknown.
        speed_limit: largest speed of the joint [rad/s, m/s]; inf where unknown.
    """

    name: str
    kind: JointKind
    parent: int
    placement: Placement
    inertia: Inertia
    offset: float = 0.0
    lower: float = -np.inf
    upper: float = np.inf
    armature: float = 0.0
    stiffness: float = 0.0
    spring_reference: float = 0.0
    actuated: bool = True
    damping: float = 0.0
    friction: float = 0.0
    position_gain: float = 0.0
    velocity_gain: float = 0.0
    torque_limit: float = np.inf
    speed_limit: float = np.inf

    def pose(self, coordinate: float) -> Placement:
        """Return the joint's moved frame in the parent joint's frame."""
        value = coordinate + self.offset
        if self.kind is JointKind.HINGE:
            return self.placement @ Placement(rotation_about_z(value), np.zeros(3))
        return self.placement @ Placement(np.eye(3), np.array([0.0, 0.0, value]))


@dataclass(frozen=True, eq=False)
class Frame(ByContent):
    """A named frame fixed to a joint's body (or to the base)."""

    name: str
    joint: int
    placement: Placement


@dataclass(frozen=True, eq=False)
class PointMass(ByContent):
    """A mass in a point, held at a frame.

    Attributes:
        frame: name of the frame.
        mass: in kg, a number or a symbol.
        com: its place along that frame's axes from its origin [m], length 3, numbers or symbols.
    """

    frame: str
    mass: Matrix
    com: Matrix


@dataclass(frozen=True, eq=False)
class Robot(ByContent):
    """A fixed-base tree of hinge and slide joints, parents before children, and the loops in it.

    Attributes:
        name: of the model.
        joints: in the file's order; a configuration q has one coordinate for each.
        frames: by name.
        tip: frame taken as the contact point where none is named.
        rotor_inertia_sets: reflected rotor inertias by the name of their source, each with one
            entry a joint.
        loops: equations between the joints: loops that close the tree, and couplings.
        home: a configuration at which the loops are closed or nearly so, in the wanted one of
            several ways to assemble them; None is zero.
        independent: names of the joints whose coordinates describe a closed chain; empty leaves
            the choice to ``closed_chain``.
        base_inertia: of what is fixed to the base, in its frame; felt by floating robots only.
        rotors_stated: whether the file says all there is of rotors; else a motor's joint without
            armature has a rotor of which nothing is known.
        payload: that it holds; with symbols in it, expressions need a q of symbols too.
        tendons: that tie inertias or springs to several joints at once.
        source: the file it was read from, for messages; empty where there is none.
        warnings: what of its file was ignored or approximated, or looks implausible; one line each.
    """

    name: str
    joints: tuple[Joint, ...]
    frames: Mapping[str, Frame]
    tip: str | None = None
    rotor_inertia_sets: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    loops: tuple[Constraint, ...] = ()
    home: tuple[float, ...] | None = None
    independent: tuple[str, ...] = ()
    base_inertia: Inertia = field(default_factory=Inertia.zero)
    payload: PointMass | None = None
    tendons: tuple[Tendon, ...] = ()
    source: str = ""
    rotors_stated: bool = False
    warnings: tuple[str, ...] = ()

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joints)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints, in the order of q."""
        return tuple(joint.name for joint in self.joints)

    @property
    def armature(self) -> Array:
        """Reflected rotor inertias, shape (n,)."""
        return np.array([joint.armature for joint in self.joints])

    @property
    def damping(self) -> Array:
        """Damping of the joints, shape (n,)."""
        return np.array([joint.damping for joint in self.joints])

    @property
    def position_gains(self) -> Array:
        """K_p of the file's servos, shape (n,)."""
        return np.array([joint.position_gain for joint in self.joints])

    @property
    def velocity_gains(self) -> Array:
        """K_d of the file's servos, shape (n,)."""
        return np.array([joint.velocity_gain for joint in self.joints])

    @property
    def torque_limits(self) -> Array:
        """Largest torques of the motors, shape (n,); inf where unknown."""
        return np.array([joint.torque_limit for joint in self.joints])

    @property
    def speed_limits(self) -> Array:
        """Largest speeds of the joints, shape (n,); inf where unknown."""
        return np.array([joint.speed_limit for joint in self.joints])

    @property
    def limits(self) -> tuple[Array, Array]:
        """Lower and upper joint limits, shape (n,) each."""
        lower = np.array([joint.lower for joint in self.joints])
        return lower, np.array([joint.upper for joint in self.joints])

    @property
    def followers(self) -> tuple[str, ...]:
        """Names of the joints whose coordinates follow from others' by a coupling."""
        couplings = (loop for loop in self.loops if isinstance(loop, Coupling))
        return tuple(c.follower for c in couplings if c.follower is not None)

    @property
    def has_springs(self) -> bool:
        """Whether springs of the file's own act on joints or tendons."""
        return any(j.stiffness for j in self.joints) or any(t.stiffness for t in self.tendons)

    @property
    def actuated(self) -> tuple[bool, ...]:
        """Whether each joint has a motor."""
        return tuple(joint.actuated for joint in self.joints)

    def frame(self, name: str) -> Frame:
        """Return a frame by name, or ``FRAME@x,y,z``: moved by [m] along a named frame's axes.

        Raises:
            FrameNotFound: there is no such frame; lists those that there are.
            InvalidValue: the point is not three finite numbers.
        """
        if name in self.frames:
            return self.frames[name]
        carrier, at, point = name.partition("@")
        if carrier not in self.frames:
            raise FrameNotFound(carrier if at else name, self.frames)
        known = self.frames[carrier]
        moved = Placement(np.eye(3), _point(name, point))
        return Frame(name, known.joint, known.placement @ moved)

    def with_frame(self, name: str, body: str, point: ArrayLike) -> Robot:
        """Return the robot with one more frame.

        Args:
            name: of the new frame.
            body: name of the body, or of any other frame, that carries it; raises FrameNotFound.
            point: its origin along that frame's axes [m], length 3; raises InvalidValue.
        """
        known = self.frame(body)
        placement = known.placement @ Placement(np.eye(3), three_numbers("point", point))
        return replace(self, frames={**self.frames, name: Frame(name, known.joint, placement)})

    def ancestors(self, joint: int) -> list[int]:
        """Indices from ``joint`` down to the base, itself first."""
        path = []
        while joint != BASE:
            path.append(joint)
            joint = self.joints[joint].parent
        return path

    def moved_by(self, loop: Constraint) -> set[int]:
        """Indices of the joints that a coupling ties, or that part a loop's two frames."""
        if isinstance(loop, Coupling | Ball | Through):
            return {self.joint_names.index(name) for name in loop.joints}
        first, second = self.frame(loop.first).joint, self.frame(loop.second).joint
        return set(self.ancestors(first)) ^ set(self.ancestors(second))

    def rotor_inertia_set(self, name: str) -> Array:
        """Return a named set of reflected rotor inertias; raises UnknownName."""
        if name not in self.rotor_inertia_sets:
            raise UnknownName("rotor inertia set", name, self.rotor_inertia_sets)
        return np.array(self.rotor_inertia_sets[name])

    def vector(self, name: str, values: ArrayLike) -> Array:
        """Check that ``values`` has one entry a joint; raises WrongLength, InvalidValue."""
        return vector_of(self.joint_names, name, values)

    def with_armature(self, armature: ArrayLike) -> Robot:
        """Return the robot with other reflected rotor inertias."""
        values = self.vector("rotor_inertia", armature)
        joints = tuple(
            replace(joint, armature=float(value))
            for joint, value in zip(self.joints, values, strict=True)
        )
        return replace(self, joints=joints)

    def with_payload(self, frame: str, mass: Matrix, com: Matrix = (0.0, 0.0, 0.0)) -> Robot:
        """Return the robot with a point mass in its hand, instead of the one it may hold.

        Args:
            frame: name of the frame that holds it; raises FrameNotFound.
            mass: in kg, a number or an SX.
            com: its place along that frame's axes from its origin [m], length 3.

        Raises:
            InvalidValue: a mass that is negative, or a number that is not finite.
        """
        if isinstance(mass, int | float) and not 0 <= mass < np.inf:
            raise InvalidValue("payload_mass", f"must be finite and ≥ 0 kg, not {mass:g}")
        if isinstance(com, Sequence | np.ndarray):
            three_numbers("payload_com", com)
        return replace(self, payload=PointMass(self.frame(frame).name, mass, com))

    def digest(self, *, floating: bool = False) -> str:
        """Return a hash of every number and name that the robot's expressions depend on.

        Args:
            floating: also of the base's inertia, which a robot feels whose base is set free.
        """
        text = hashlib.sha256()
        if floating:
            text.update(f"{_in_words(_of_inertia(self.base_inertia))}\n".encode())
        for joint in self.joints:
            numbers = [
                *joint.placement.rotation.flat,
                *joint.placement.translation,
                *_of_inertia(joint.inertia),
                joint.offset,
                joint.armature,
                joint.stiffness,
                joint.spring_reference,
                joint.lower,
                joint.upper,
                joint.damping,
            ]
            head = f"{joint.name} {joint.kind.value} {joint.parent} {joint.actuated}"
            text.update(f"{head} {_in_words(numbers)}\n".encode())
        for frame in self.frames.values():
            numbers = [*frame.placement.rotation.flat, *frame.placement.translation]
            text.update(f"{frame.name} {frame.joint} {_in_words(numbers)}\n".encode())
        for loop in self.loops:
            text.update(f"{_described(loop)}\n".encode())
        for tendon in self.tendons:
            text.update(f"{tendon}\n".encode())
        if self.loops:
            home = _in_words(self.home or ())
            text.update(f"{home} {' '.join(self.independent)}\n".encode())
        if self.payload:
            text.update(f"{self.payload.frame} {self.payload.mass} {self.payload.com}\n".encode())
        return text.hexdigest()


def _of_inertia(inertia: Inertia) -> list[float]:
    return [inertia.mass, *inertia.first_moment, *inertia.about_origin.flat]


def _described(loop: Constraint) -> str:
    return f"{loop.name} {loop.first} {loop.second}" if isinstance(loop, Loop) else str(loop)


def vector_of(names: Sequence[str], field: str, values: ArrayLike) -> Array:
    """Return a vector with one number for each of some joints.

    Raises:
        WrongLength: it has another length.
        InvalidValue: it is not a flat list.
    """
    array = np.asarray(values, dtype=float)
    if array.ndim == 2 and array.shape[0] > 1:
        raise InvalidValue(
            field,
            f"must be a flat list of numbers, not {array.shape[0]} of them: call once for each, "
            "or map arrays with softimpact.compiled",
        )
    if array.ndim != 1:
        raise InvalidValue(field, "must be a flat list of numbers")
    if len(array) != len(names):
        raise WrongLength(field, len(array), len(names), names)
    return array


def _point(name: str, text: str) -> Array:
    try:
        point = np.array([float(x) for x in text.split(",")])
    except ValueError:
        point = np.zeros(0)
    if point.shape != (3,) or not np.isfinite(point).all():
        raise InvalidValue(f"frame '{name}'", "needs a point as three finite numbers: FRAME@x,y,z")
    return point


def _in_words(numbers: Sequence[float]) -> str:
    return " ".join(f"{float(x) + 0.0:.12e}" for x in numbers)
