# SPDX-License-Identifier: BSD-3-Clause
"""Robots with some of their joints welded."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InvalidValue, UnknownName
from .rigid import Placement
from .robot import BASE, Frame, Joint, Loop, Robot


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
    )


def chain_to(robot: Robot, frame: str, rest: ArrayLike | None = None) -> Robot:
    """Return the chain from the base to a frame; joints off it are welded, their masses kept.

    Joints of a loop that the chain is part of stay, and loops among welded joints are dropped.

    Args:
        robot: any robot.
        frame: name of a frame; raises FrameNotFound.
        rest: coordinates of all joints at which those off the chain are welded (default zero).
    """
    path, loops = _with_loops(robot, set(robot.ancestors(robot.frame(frame).joint)))
    values = np.zeros(robot.n) if rest is None else robot.vector("rest", rest)
    locked = {j.name: float(values[i]) for i, j in enumerate(robot.joints) if i not in path}
    return replace(lock_joints(robot, locked), tip=frame, loops=loops)


def _with_loops(robot: Robot, path: set[int]) -> tuple[set[int], tuple[Loop, ...]]:
    """Add to a chain all joints of the loops that hold it, and return those loops."""
    around = {loop: robot.moved_by(loop) for loop in robot.loops}
    held: set[Loop] = set()
    while touched := {loop for loop in around if around[loop] & path} - held:
        held |= touched
        for loop in touched:
            ends = (robot.frame(loop.first).joint, robot.frame(loop.second).joint)
            path = path.union(*map(robot.ancestors, ends))
    return path, tuple(loop for loop in robot.loops if loop in held)
