# SPDX-License-Identifier: BSD-3-Clause
"""A robot's program, slowed down from what a user typed until no watched point can hurt."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from softimpact.simulate import HORIZON, Approach, bracket
from softimpact.simulate.band import Band, impact_band
from softimpact.simulate.program import (
    Danger,
    SafeProgram,
    program_dangers,
    safe_program,
)
from softimpact.simulate.trajectory import Trajectory, passes
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    InvalidValue,
    Motors,
    Robot,
    body_region,
    frame_pose,
    impact_model,
    limits_of,
    load_robot,
)
from softimpact.symbolic.body.body_file import load_cover
from softimpact.symbolic.impact.motors import refuse_held
from softimpact.symbolic.robot.robot import BASE

from .motion_file import limits_left, read_motion
from .program_record import ProgramResult, program_record
from .progress import progress_bar
from .situation import (
    TypedArm,
    TypedDrives,
    counted_as_rigid,
    drives_of,
    gravity_of,
    loaded_arm,
)
from .typed_motors import TypedMotors, motors_of
from .waypoints import read_waypoints

APART = 0.15
"""Distance between points that are watched by default [m]."""

COARSE = 0.05
"""Way of a watched point between two samples from which on a motion is called coarse [m]."""


@dataclass(frozen=True)
class TypedProgram:
    """The options that say what a program may hit, as typed; see ``program_command``."""

    arm: TypedArm
    drives: TypedDrives
    motors: TypedMotors
    points: tuple[str, ...]
    regions: tuple[str, ...]
    cover: str | None = None
    clamped: bool = True
    horizon: float | None = None
    gravity: str | None = None
    band: bool = False


def run_program(path: Path, how: TypedProgram) -> ProgramResult:
    """Return how fast a program may run; raises SoftImpactError."""
    motors, reaction = motors_of(how.motors, how.drives)
    if motors is not None:
        refuse_held(motors, "a safe program")
    whole = load_robot(how.arm.model)
    arm = loaded_arm(replace(how.arm, tip=None if whole.tip else _end(whole, how)))
    robot = arm.robot
    motion, told = _motion(path, robot, whole)
    model = impact_model(
        robot, drives_=drives_of(robot, how.drives), gravity=gravity_of(how.gravity)
    )
    points = how.points or default_points(robot, motion)
    bodies = _bodies(how)
    found, assumed = bracket(model, motors, reaction)
    ends = {kind: end for kind, end in found.items() if isinstance(end, Motors)}
    horizon = HORIZON if how.horizon is None else how.horizon
    if not 0 < horizon < np.inf:
        raise InvalidValue("horizon", f"must be finite and greater than 0 s, not {horizon:g}")
    with _progress(len(motion.time) * len(points) * len(bodies) * len(ends)) as seen:
        dangers = program_dangers(
            model, motion, points, bodies, ends, horizon=horizon, payload=arm.load, seen=seen
        )
    safe = safe_program(motion, dangers)
    rigid = counted_as_rigid(model, how.drives)
    warnings = [*arm.warnings, *rigid, *told, *assumed, *_cautions(robot, motion, bodies, dangers)]
    record = program_record(
        path, how.clamped, model, motion, points, ends, horizon, dangers, safe, warnings
    )
    if how.band:
        for moment in record["worst"]:
            moment["band"] = _band(model, motion, safe, moment["sample"], bodies, ends, horizon)
    return ProgramResult(motion, dangers, safe, record)


@contextmanager
def _progress(total: int) -> Iterator[Callable[[int], None]]:
    """Show a bar on stderr if somebody looks at it."""
    if not sys.stderr.isatty():
        yield lambda count: None
        return
    with progress_bar() as progress:
        task = progress.add_task("impacts", total=total)
        yield lambda count: progress.advance(task, count)


def _motion(path: Path, robot: Robot, whole: Robot) -> tuple[Trajectory, list[str]]:
    """Return a motion from a table, or from waypoints in a ``.json`` file, and warnings."""
    if path.suffix.lower() == ".json":
        motion = read_waypoints(path, robot)
        return motion, limits_left(path, motion, robot)
    others = tuple(name for name in whole.joint_names if name not in robot.joint_names)
    return read_motion(path, robot, others)


def _band(
    model: ImpactModel,
    motion: Trajectory,
    safe: SafeProgram,
    sample: int,
    bodies: Sequence[Contact],
    ends: dict[str, Motors],
    horizon: float,
) -> Band:
    """Return the band of the peak at the program's own speed, at its worst danger."""
    worst = safe.worst[sample]
    assert worst is not None
    danger, row = worst
    (body,) = [body for body in bodies if body.region.name == danger.region]
    at = replace(model, tip=model.robot.frame(danger.point).name)
    approach = Approach(
        motion.q[sample], danger.direction[row], danger.speed[row], danger.link_velocity[row]
    )
    limits = limits_of(body.region, body.clamped)
    return impact_band(at, approach, body, ends.values(), limits, horizon=horizon).peak


def _end(robot: Robot, how: TypedProgram) -> str | None:
    """Return where the arm of a robot without a tip of its own ends: at its farthest point."""
    depth = {name: len(robot.ancestors(robot.frame(name).joint)) for name in how.points}
    return how.arm.end or max(depth, key=lambda name: depth[name], default=None)


def default_points(robot: Robot, motion: Trajectory) -> tuple[str, ...]:
    """Return the end and the frames along the arm that are some way apart and move."""
    places = {
        name: np.array(frame_pose(robot, name, motion.q[0]).position, dtype=float).ravel()
        for name, frame in robot.frames.items()
        if frame.joint != BASE
    }
    tip = robot.tip or ""
    chosen = [tip]
    for name in sorted(places, key=lambda name: -robot.frames[name].joint):
        apart = min(np.linalg.norm(places[name] - places[other]) for other in chosen)
        if apart > APART and _moves(robot, name, motion):
            chosen.append(name)
    return tuple(chosen)


def _moves(robot: Robot, frame: str, motion: Trajectory) -> bool:
    rows = np.linspace(0, len(motion.q) - 1, min(len(motion.q), 20)).astype(int)
    places = [np.array(frame_pose(robot, frame, q).position, dtype=float) for q in motion.q[rows]]
    return float(np.ptp(np.array(places), axis=0).max()) > 1e-3


def _bodies(how: TypedProgram) -> list[Contact]:
    cover = None if how.cover is None else load_cover(how.cover)
    names = dict.fromkeys(how.regions)
    if not names:
        raise InvalidValue("regions", "names no region of the body")
    bodies = [Contact(body_region(name), how.clamped, cover=cover) for name in names]
    for body in bodies:
        if limits_of(body.region, body.clamped).transient.force == np.inf:
            raise InvalidValue("regions", f"'{body.region.name}' has no limits to be kept")
    return bodies


def _cautions(
    robot: Robot, motion: Trajectory, bodies: Sequence[Contact], dangers: Sequence[Danger]
) -> Iterator[str]:
    for body in bodies:
        if not body.region.permitted:
            yield (
                f"contact with '{body.region.name}' is not to be designed for; its limits are for "
                "reference"
            )
    fastest = abs(passes(motion).velocity).max(axis=0)
    for name, speed, limit in zip(robot.joint_names, fastest, robot.speed_limits, strict=True):
        if speed > limit * (1 + 1e-6):
            yield f"joint '{name}' moves at up to {speed:.4g}, beyond its speed limit {limit:.4g}"
    step = float(np.diff(motion.time).max())
    way = max(float(danger.speed.max()) for danger in dangers) * step
    if way > COARSE:
        yield (
            f"watched points move up to {100 * way:.0f} cm between samples, and what is between is "
            "not looked at; give the motion with more samples"
        )
