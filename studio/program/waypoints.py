# SPDX-License-Identifier: BSD-3-Clause
"""Motions as JSON files of waypoints with speeds, as robot programs have them."""

from __future__ import annotations

import json
from pathlib import Path

import casadi as ca
import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from softimpact.simulate.trajectory import Trajectory, trajectory
from softimpact.symbolic import Robot, frame_pose
from softimpact.symbolic.file_section import why_unreadable
from softimpact.symbolic.robot.rigid import Array

from .motion_file import MotionFileError

JOINT_STEP = 0.02
"""Most that a joint moves between two samples [rad, m]."""

PLACE_STEP = 0.01
"""Most that the end of the arm moves between two samples [m]."""

FARTHEST = 100.0
"""Bound of coordinates [rad, m], beyond which they are degrees or nonsense."""

LEAST_WAY = 1e-6
"""Way of the arm's end that has a speed [m]."""


class Waypoint(BaseModel):
    """Where the joints go, and how fast the arm's end moves on the way there."""

    model_config = ConfigDict(extra="forbid")

    q: list[float] | dict[str, float]
    speed: float | None = Field(default=None, gt=0, allow_inf_nan=False)
    time: float | None = Field(default=None, gt=0, allow_inf_nan=False)

    @model_validator(mode="after")
    def _one_of_both(self) -> Waypoint:
        if self.speed is not None and self.time is not None:
            raise ValueError("give either speed (m/s) or time (s)")
        return self


class Waypoints(BaseModel):
    """A file: waypoints in order, and the speed on the ways that name none."""

    model_config = ConfigDict(extra="forbid")

    waypoints: list[Waypoint] = Field(min_length=2)
    speed: float | None = Field(default=None, gt=0, allow_inf_nan=False)


def read_waypoints(path: Path, robot: Robot) -> Trajectory:
    """Read a motion from waypoints.

    On each way the joints move in proportion, and the arm's end (the robot's tip) at an even speed.

    Args:
        path: of a JSON file.
        robot: whose joints they are.

    Raises:
        MotionFileError: the file is no such JSON, or a way has no time.
        InvalidValue, WrongLength: a waypoint that does not fit the robot.
        OSError: there is no such file.
    """
    try:
        file = Waypoints.model_validate(json.loads(path.read_text(encoding="utf-8-sig")))
    except (ValueError, RecursionError) as error:
        raise MotionFileError(path, why_unreadable(error)) from None
    places = [_configuration(path, robot, i, point) for i, point in enumerate(file.waypoints)]
    time, q = [0.0], [places[0]]
    for i, point in enumerate(file.waypoints[1:], start=1):
        steps, way = _way(robot, places[i - 1], places[i])
        speed = file.speed if point.speed is None else point.speed
        length = float(way.sum())
        if point.time is not None:
            share = way / length if length > LEAST_WAY else np.full(len(way), 1 / len(way))
            taken = point.time * share
        elif speed is None:
            raise MotionFileError(path, f"waypoint {i + 1} has neither a speed nor a time")
        elif length < LEAST_WAY:
            reason = (
                f"the arm's end stays where it is on the way to waypoint {i + 1}; give its time"
            )
            raise MotionFileError(path, reason)
        else:
            taken = way / speed
        keeps = taken > 0
        time += (time[-1] + np.cumsum(taken[keeps])).tolist()
        q += list(steps[1:][keeps])
    return trajectory(time, np.array(q))


def _configuration(path: Path, robot: Robot, index: int, point: Waypoint) -> Array:
    q = _by_order(path, robot, index, point)
    if not (abs(q) < FARTHEST).all():
        reason = f"waypoint {index + 1} must hold finite angles in radians"
        raise MotionFileError(path, reason)
    return q


def _by_order(path: Path, robot: Robot, index: int, point: Waypoint) -> Array:
    if isinstance(point.q, list):
        return robot.vector(f"waypoints.{index}.q", point.q)
    missing = [name for name in robot.joint_names if name not in point.q]
    unknown = [name for name in point.q if name not in robot.joint_names]
    if missing or unknown:
        what = f"no joint '{missing[0]}'" if missing else f"an unknown joint '{unknown[0]}'"
        raise MotionFileError(path, f"waypoint {index + 1} has {what}")
    return np.array([point.q[name] for name in robot.joint_names])


def _way(robot: Robot, first: Array, last: Array) -> tuple[Array, Array]:
    """Return configurations on the way, and how far the arm's end moves from one to the next."""
    assert robot.tip is not None
    symbol = ca.SX.sym("q", robot.n)
    place = ca.Function("p", [symbol], [frame_pose(robot, robot.tip, symbol).position])
    count = max(1, int(np.ceil(abs(last - first).max(initial=0.0) / JOINT_STEP)))
    for _ in range(2):
        steps = first + np.linspace(0, 1, count + 1)[:, None] * (last - first)
        moved = np.diff(np.array(place.map(count + 1)(steps.T)).T, axis=0)
        way = np.linalg.norm(moved, axis=1)
        count = max(count, int(np.ceil(count * way.max(initial=0.0) / PLACE_STEP)))
    return steps, np.asarray(way)
