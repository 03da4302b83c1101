# SPDX-License-Identifier: BSD-3-Clause
"""The arm that is hit: from the base to its end, with all joints on the way, and its load."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InvalidValue, UnknownName
from .rigid import Inertia, three_numbers
from .robot import BASE, Robot
from .welding import chain_to, lock_joints

MOST_JOINTS = 100
"""Joints of an arm: 80 take ten seconds to analyse, and the time grows with their cube."""


@dataclass(frozen=True, eq=False)
class Arm:
    """A robot without the joints that are not on the way to its end.

    Attributes:
        robot: its ``tip`` is the contact point.
        end: frame where it ends, which holds its load.
        warnings: what was decided for want of a word, a line each.
    """

    robot: Robot
    end: str
    warnings: tuple[str, ...] = ()


def arm_of(
    robot: Robot,
    tip: str | None = None,
    end: str | None = None,
    locked: Mapping[str, float] | None = None,
) -> Arm:
    """Return the arm that is hit at a contact point.

    Joints beyond the contact point stay, up to the end; they move when the point is hit. Joints
    off the way are welded, at zero or where ``locked`` says.

    Args:
        robot: any robot.
        tip: contact frame, or ``FRAME@x,y,z``; default the robot's own tip.
        end: frame where the arm ends; default the robot's own tip where the contact point lies on
            the way to it, else the contact frame.
        locked: coordinates of joints to weld, by name; also of some on the way.

    Raises:
        InvalidValue: no contact frame is named, it does not move, or it is not on the way.
        FrameNotFound, UnknownName: there is no such frame or joint.
    """
    if tip is None and robot.tip is None:
        frames = ", ".join(robot.frames)
        raise InvalidValue("tip", f"{robot.name} names no contact frame; choose one of: {frames}")
    contact = robot.frame(tip or robot.tip or "")
    locks = dict(locked or {})
    for name in locks:
        if name not in robot.joint_names:
            raise UnknownName("joint", name, robot.joint_names)
    warnings = []
    if end is None:
        end, beyond = _default_end(robot, contact.name)
        if beyond:
            warnings.append(
                f"{_joints(beyond)} beyond the contact point '{contact.name}' welded; name the end "
                "of the arm by 'end' to keep what moves there"
            )
    elif contact.joint not in _way(robot, end):
        raise InvalidValue(
            "tip", f"contact point '{contact.name}' is not on the way from the base to '{end}'"
        )
    way = _way(robot, end)
    rest = np.array([locks.get(name, 0.0) for name in robot.joint_names])
    chain = chain_to(robot, robot.frame(end).name, rest)
    chain = lock_joints(chain, {k: v for k, v in locks.items() if k in chain.joint_names})
    if chain.n == 0 or (contact.joint == BASE and way):
        raise InvalidValue(
            "tip", f"frame '{contact.name}' is fixed to the base; choose one that moves"
        )
    if chain.n > MOST_JOINTS:
        raise InvalidValue(
            "tip",
            f"{chain.n} joints lie on the way to '{end}', but no more than {MOST_JOINTS} are "
            "followed; lock some",
        )
    return Arm(replace(chain, tip=contact.name), end, (*warnings, *held_base(robot)))


def held_base(robot: Robot) -> list[str]:
    """Return a line if an arm's base is one that may move in truth: others start at it, too."""
    chains = sum(joint.parent == BASE for joint in robot.joints)
    mass = robot.base_inertia.mass
    if chains < 2 or mass <= 0:
        return []
    return [
        f"the base of {robot.name} ({mass:.3g} kg, at which {chains} chains of joints start) is "
        "taken as held: it does not give way"
    ]


def _default_end(robot: Robot, contact: str) -> tuple[str, list[str]]:
    """Return where the arm ends, and the joints that are welded beyond the contact point."""
    joint = robot.frame(contact).joint
    if robot.tip is not None and joint in _way(robot, robot.tip):
        return robot.tip, []
    beyond = [
        other.name
        for i, other in enumerate(robot.joints)
        if joint != BASE and joint in robot.ancestors(i)[1:]
    ]
    return contact, beyond


def _way(robot: Robot, end: str) -> list[int]:
    return robot.ancestors(robot.frame(end).joint)


def _joints(names: Sequence[str]) -> str:
    listed = ", ".join(f"'{name}'" for name in names)
    return f"joint {listed} is" if len(names) == 1 else f"joints {listed} are"


def with_load(
    robot: Robot,
    frame: str,
    mass: float,
    com: ArrayLike = (0.0, 0.0, 0.0),
    inertia: Sequence[float] | None = None,
) -> Robot:
    """Return the robot with a tool or a workpiece fixed to a frame.

    Args:
        robot: any robot.
        frame: that carries it; raises FrameNotFound.
        mass: in kg.
        com: its centre of mass along that frame's axes from its origin [m], length 3.
        inertia: xx, yy, zz, xy, xz, yz about its centre along the same axes [kg m²]; default none,
            as of a point, which is the least that it can be.

    Raises:
        InvalidValue: a mass that is not positive and finite, or an impossible inertia.
    """
    if not 0 < mass < np.inf:
        raise InvalidValue("payload", f"needs a mass greater than 0 kg, not {mass:g}")
    at, tensor = three_numbers("payload", com), np.zeros((3, 3))
    if inertia is not None:
        xx, yy, zz, xy, xz, yz = inertia
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        moments = np.linalg.eigvalsh(tensor) if np.isfinite(tensor).all() else np.array([-1.0])
        if moments[0] < 0 or moments[2] > (moments[0] + moments[1]) * (1 + 1e-6):
            raise InvalidValue("payload", "has an inertia that no body can have")
    carrier = robot.frame(frame)
    load = Inertia.from_center_of_mass(mass, at, tensor).seen_from(carrier.placement)
    if carrier.joint == BASE:
        return replace(robot, base_inertia=robot.base_inertia + load)
    joints = list(robot.joints)
    joint = joints[carrier.joint]
    joints[carrier.joint] = replace(joint, inertia=joint.inertia + load)
    return replace(robot, joints=tuple(joints))
