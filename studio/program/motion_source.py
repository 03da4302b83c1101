# SPDX-License-Identifier: BSD-3-Clause
"""A motion that is read in parts, as often as needed, and a first look at the whole of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import casadi as ca
import numpy as np

from softimpact.simulate.program import STILL, never_moves
from softimpact.simulate.trajectory import Passes, Trajectory, passes_of_parts
from softimpact.symbolic import Robot, frame_pose
from softimpact.symbolic.robot.rigid import Array

from .motion_file import ROWS, idle_columns, limits_left, open_motion
from .waypoints import read_waypoints


class MotionSource(Protocol):
    """Where a motion comes from."""

    def chunks(self, rows: int) -> Iterator[tuple[Trajectory, float]]:
        """Yield it in parts of some samples, unchecked, and the share of it that was read."""


@dataclass(frozen=True, eq=False)
class KnownMotion:
    """A motion in memory."""

    motion: Trajectory

    def chunks(self, rows: int) -> Iterator[tuple[Trajectory, float]]:
        """Yield it in parts of some samples, and the share of it that these end at."""
        count = len(self.motion.time)
        for k in range(0, count, rows):
            part = Trajectory(self.motion.time[k : k + rows], self.motion.q[k : k + rows])
            yield part, min(k + rows, count) / count


def motion_source(path: Path, robot: Robot, whole: Robot) -> tuple[MotionSource, list[str]]:
    """Return a motion from a table, or from waypoints in a ``.json`` file, and warnings."""
    if path.suffix.lower() == ".json":
        return KnownMotion(read_waypoints(path, robot)), []
    others = tuple(name for name in whole.joint_names if name not in robot.joint_names)
    table = open_motion(path, robot, others)
    return table, idle_columns(table.idle)


def passes_of(
    source: MotionSource, rows: int = ROWS, read: Callable[[float], None] = lambda share: None
) -> Iterator[Passes]:
    """Yield how a motion passes its samples, part by part; ``read`` is told the share read."""

    def parts() -> Iterator[Trajectory]:
        for part, share in source.chunks(rows):
            yield part
            read(share)

    return passes_of_parts(parts())


def samples_of(source: MotionSource, wanted: Sequence[int]) -> dict[int, Passes]:
    """Return how a motion passes some samples."""
    found: dict[int, Passes] = {}
    for met in passes_of(source):
        for k in wanted:
            if met.sample[0] <= k <= met.sample[-1]:
                found[k] = met.taken(met.sample == k)
    return found


@dataclass(frozen=True, eq=False)
class Survey:
    """What is known of a motion after one look.

    Attributes:
        time: of its samples [s].
        fastest: of each joint [rad/s, m/s].
        lowest: of each joint [rad, m].
        highest: of each joint.
        reach: largest speed of each point [m/s].
        way: farthest that a point goes between two samples [m].
        first: passes of the first samples.
    """

    time: Array
    fastest: Array
    lowest: Array
    highest: Array
    reach: Array
    way: float
    first: Passes


def survey(
    source: MotionSource,
    path: Path,
    robot: Robot,
    points: Sequence[str],
    read: Callable[[float], None] = lambda share: None,
) -> Survey:
    """Look at the whole of a motion.

    Args:
        source: of the motion.
        path: of its file, for messages.
        robot: the arm.
        points: that are watched.
        read: is told the share that was read.

    Raises:
        MotionFileError: angles that look like degrees, and whatever else a file may hold.
        InvalidValue: times that do not rise, numbers that are not finite, or too few samples.
    """
    moving = moving_points(robot, points)
    times: list[Array] = []
    fastest, reach = np.zeros(robot.n), np.zeros(len(points))
    lowest, highest, way = np.full(robot.n, np.inf), np.full(robot.n, -np.inf), 0.0
    first: Passes | None = None
    for met in passes_of(source, read=read):
        first = first or met
        lowest = np.minimum(lowest, met.q.min(axis=0))
        highest = np.maximum(highest, met.q.max(axis=0))
        limits_left(path, np.array([lowest, highest]), robot)
        fastest = np.maximum(fastest, abs(met.velocity).max(axis=0))
        velocity = np.array(moving.map(len(met.q))(met.q.T, met.velocity.T)[1])
        speed = np.linalg.norm(velocity.T.reshape(len(met.q), -1, 3), axis=2)
        reach = np.maximum(reach, speed.max(axis=0))
        way = max(way, float((speed.max(axis=1) * met.step).max()))
        _, once = np.unique(met.sample, return_index=True)
        times.append(met.time[once])
    assert first is not None
    return Survey(np.concatenate(times), fastest, lowest, highest, reach, way, first)


def require_all_move(points: Sequence[str], of: Survey) -> None:
    """Raise InvalidValue if a point never moves."""
    for point, fastest in zip(points, of.reach, strict=True):
        if fastest <= STILL:
            raise never_moves(point)


def moving_points(robot: Robot, points: Sequence[str]) -> Any:
    """Return (q, q̇) -> places and velocities of points, one below the other."""
    q, rate = ca.SX.sym("q", robot.n), ca.SX.sym("dq", robot.n)
    place = ca.vertcat(*(frame_pose(robot, point, q).position for point in points))
    wanted = [ca.densify(place), ca.densify(ca.jtimes(place, q, rate))]
    return ca.Function("moving", [q, rate], wanted)
