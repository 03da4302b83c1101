# SPDX-License-Identifier: BSD-3-Clause
"""Robots with some of their joints welded."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InvalidValue, UnknownName, UnsupportedModel
from .constraints import Ball, Constraint, Coupling, Tendon, Through, Weld
from .plausibility import outside, require_sound_masses
from .rigid import Placement
from .robot import BASE, Frame, Joint, Robot


def lock_joints(robot: Robot, locked: Mapping[str, float]) -> Robot:
    """Return the robot with some joints welded at given coordinates, their masses kept.

    Args:
        robot: any robot.
        locked: coordinate [rad, m] of each joint to weld, by name.

    Raises:
        UnknownName: there is no such joint.
        InvalidValue: a coordinate that is not finite.
    """
    for name, coordinate in locked.items():
        if name not in robot.joint_names:
            raise UnknownName("joint", name, robot.joint_names)
        if not np.isfinite(coordinate):
            raise InvalidValue(name, f"needs a finite coordinate to be welded at, not {coordinate}")
    locked = _with_followers(robot, locked)
    carrier: dict[int, tuple[int, Placement]] = {BASE: (BASE, Placement.identity())}
    kept: list[Joint] = []
    base = robot.base_inertia
    for index, joint in enumerate(robot.joints):
        parent, where = carrier[joint.parent]
        if joint.name not in locked:
            placement = where @ joint.placement
            kept.append(replace(joint, parent=parent, placement=placement))
            carrier[index] = (len(kept) - 1, Placement.identity())
            continue
        pose = where @ joint.pose(locked[joint.name])
        carrier[index] = (parent, pose)
        moved = joint.inertia.seen_from(pose)
        if parent == BASE:
            base = base + moved
        else:
            kept[parent] = replace(kept[parent], inertia=kept[parent].inertia + moved)
    frames = {
        name: Frame(name, carrier[frame.joint][0], carrier[frame.joint][1] @ frame.placement)
        for name, frame in robot.frames.items()
    }
    stays = [joint.name not in locked for joint in robot.joints]
    sets = {
        name: tuple(value for value, stay in zip(values, stays, strict=True) if stay)
        for name, values in robot.rotor_inertia_sets.items()
    }
    independent = tuple(name for name in robot.independent if name not in locked)
    home = None
    if robot.home is not None:
        home = tuple(value for value, stay in zip(robot.home, stays, strict=True) if stay)
    return replace(
        robot,
        joints=tuple(kept),
        frames=frames,
        rotor_inertia_sets=sets,
        home=home,
        independent=independent,
        base_inertia=base,
        loops=tuple(_left(robot.loops, locked)),
        tendons=tuple(_tendons(robot.tendons, locked)),
    )


def _with_followers(robot: Robot, locked: Mapping[str, float]) -> dict[str, float]:
    """Add the joints that follow from welded ones."""
    all_locked = dict(locked)
    couplings = [loop for loop in robot.loops if isinstance(loop, Coupling)]
    for _ in couplings:  # a follower may lead others
        for coupling in couplings:
            follower = coupling.follower
            led = all(name in all_locked for name, _ in coupling.leading)
            if follower is not None and led and follower not in locked:
                all_locked[follower] = float(coupling.follow(all_locked.__getitem__))
    return all_locked


def _left(loops: tuple[Constraint, ...], locked: Mapping[str, float]) -> Iterator[Constraint]:
    """Yield what is left of constraints when some joints are welded."""
    for loop in loops:
        if not isinstance(loop, Coupling):
            if not (isinstance(loop, Ball | Through) and set(loop.joints) <= set(locked)):
                yield loop
            continue
        left = loop.with_locked(locked)
        if left.joints:
            yield left


def _tendons(tendons: tuple[Tendon, ...], locked: Mapping[str, float]) -> Iterator[Tendon]:
    """Yield tendons over the joints that still move; welded ones only change their length."""
    for tendon in tendons:
        terms = tuple(term for term in tendon.terms if term[0] not in locked)
        if terms:
            gone = sum(c * locked[name] for name, c in tendon.terms if name in locked)
            yield replace(tendon, terms=terms, rest=tendon.rest - gone)


def chain_to(robot: Robot, frame: str, rest: ArrayLike | None = None) -> Robot:
    """Return the chain from the base to a frame; joints off it are welded, their masses kept.

    Joints of a loop or coupling that the chain is part of stay, and loops among welded joints are
    dropped. Joints that follow welded ones are welded where these put them.

    Args:
        robot: any robot.
        frame: name of a frame; raises FrameNotFound.
        rest: coordinates of all joints at which those off the chain are welded (default zero).

    Raises:
        InvalidInertia: what the chain moves has no mass, an impossible one, or an unknown one.
        UnsupportedModel: a ball joint or a tendon through space is part of the chain, or its file
            welds bodies of it.
    """
    path, loops = _with_loops(robot, set(robot.ancestors(robot.frame(frame).joint)))
    values = np.zeros(robot.n) if rest is None else robot.vector("rest", rest)
    locked = {
        joint.name: float(values[i])
        for i, joint in enumerate(robot.joints)
        if i not in path and joint.name not in robot.followers
    }
    welded = lock_joints(robot, locked)
    kept = {loop.name for loop in loops}
    chain = replace(
        welded,
        tip=frame,
        loops=tuple(loop for loop in welded.loops if loop.name in kept),
        warnings=(*robot.warnings, *_welded_outside(robot, locked)),
    )
    require_modelled(chain)
    require_sound_masses(chain)
    return chain


def require_modelled(robot: Robot) -> None:
    """Raise UnsupportedModel for what moves and that no model of ours knows."""
    for loop in robot.loops:
        if isinstance(loop, Weld):
            reason = f"equality weld '{loop.name}' holds what joints move; close loops with connect"
            raise UnsupportedModel(robot.source or robot.name, reason)
        if isinstance(loop, Ball):
            reason = f"joint '{loop.name}' is a ball joint; write it as three hinges"
            raise UnsupportedModel(robot.source or robot.name, reason)
        if isinstance(loop, Through):
            moving = [f"'{name}'" for name in loop.joints if name in robot.joint_names]
            reason = (
                f"{loop.what} acts through space on {', '.join(moving)}; write it as a fixed "
                "tendon, or lock what it moves"
            )
            raise UnsupportedModel(robot.source or robot.name, reason)


def _welded_outside(robot: Robot, locked: Mapping[str, float]) -> Iterator[str]:
    where = _with_followers(robot, locked)
    names = [
        f"'{joint.name}' at {where[joint.name]:g}"
        for joint in robot.joints
        if joint.name in locked and outside(joint, where[joint.name])
    ]
    if names:
        yield f"joints welded outside their limits: {', '.join(names)}"


def _with_loops(robot: Robot, path: set[int]) -> tuple[set[int], tuple[Constraint, ...]]:
    """Add to a chain all joints of the loops and couplings that hold it, and return those."""
    around = {loop: robot.moved_by(loop) for loop in robot.loops}
    held: set[Constraint] = set()
    while touched := {loop for loop in around if around[loop] & path} - held:
        held |= touched
        for loop in touched:
            path = path.union(*(robot.ancestors(joint) for joint in around[loop]))
    return path, tuple(loop for loop in robot.loops if loop in held)
