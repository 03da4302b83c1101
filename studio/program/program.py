# SPDX-License-Identifier: BSD-3-Clause
"""A robot's program, slowed down from what a user typed until no watched point can hurt."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from softimpact.simulate import HORIZON, bracket
from softimpact.simulate.history import require_horizon
from softimpact.simulate.program import STILL
from softimpact.simulate.zones import Somebody
from softimpact.symbolic import (
    Contact,
    InvalidValue,
    Motors,
    Robot,
    body_region,
    frame_pose,
    impact_model,
    load_robot,
)
from softimpact.symbolic.body.body_file import load_cover
from softimpact.symbolic.body.shapes import shape_from
from softimpact.symbolic.impact.motors import refuse_held
from softimpact.symbolic.robot.rigid import Array
from softimpact.symbolic.robot.robot import BASE

from ..output.cautions import not_permitted
from ..output.progress import progress_bar
from ..typed import values
from ..typed.groups import TypedArm, TypedDrives
from ..typed.motors import motors_meant
from ..typed.situation import (
    counted_as_rigid,
    drives_of,
    gravity_of,
    loaded_arm,
)
from .engine import Engine
from .moments import Question
from .motion_file import limits_left
from .motion_source import MotionSource, Survey, motion_source, require_all_move, survey
from .record import ProgramResult, program_record
from .run import slowed_program
from .zones_file import read_zones

APART = 0.15
"""Distance between points that are watched by default [m]."""

COARSE = 0.05
"""Way of a watched point between two samples from which on a motion is called coarse [m]."""


@dataclass(frozen=True)
class TypedProgram:
    """The options that say what a program may hit, as typed; see ``program_command``."""

    arm: TypedArm
    drives: TypedDrives
    points: tuple[str, ...]
    regions: tuple[str, ...]
    zones: Path | None = None
    cover: str | None = None
    shape: str | None = None
    clamped: bool = True
    horizon: float | None = None
    gravity: str | None = None
    band: bool = False
    engine: str = "auto"


def run_program(path: Path, how: TypedProgram) -> ProgramResult:
    """Return how fast a program may run; raises SoftImpactError."""
    engine: Engine = values.one_of("engine", how.engine, Engine)
    motors, reaction = motors_meant(how.drives)
    if motors is not None:
        refuse_held(motors, "a safe program")
    bodies = _bodies(how)
    whole = load_robot(how.arm.model, hold_base=how.arm.hold_base)
    arm = loaded_arm(replace(how.arm, tip=None if whole.tip else _end(whole, how)))
    robot = arm.robot
    source, told = motion_source(path, robot, whole)
    model = impact_model(
        robot, drives=drives_of(robot, how.drives), gravity=gravity_of(how.gravity)
    )
    found, assumed = bracket(model, motors, reaction)
    ends = {kind: end for kind, end in found.items() if isinstance(end, Motors)}
    horizon = HORIZON if how.horizon is None else how.horizon
    require_horizon(horizon)
    points, seen = _watched(source, path, robot, how.points)
    question = Question(model, points, bodies, ends, horizon, arm.load)
    answer = slowed_program(source, seen, question, engine, how.band, _progress)
    limits = limits_left(path, np.array([seen.lowest, seen.highest]), robot)
    rigid = counted_as_rigid(model, how.drives)
    cautions = _cautions(robot, bodies, seen)
    warnings = [*arm.warnings, *rigid, *told, *limits, *assumed, *cautions]
    warnings += answer.warnings
    record = program_record(path, question, answer, warnings)
    return ProgramResult(question, answer, record)


def _watched(
    source: MotionSource, path: Path, robot: Robot, named: tuple[str, ...]
) -> tuple[tuple[str, ...], Survey]:
    """Return the points that are watched, and a first look at the motion."""
    points = named
    if not points:
        ((start, _), *_) = source.chunks(1)
        points = default_points(robot, start.q[0])
    with _progress("reading, %", 100) as read:
        share = [0.0]

        def so_far(new: float) -> None:
            read(100 * (new - share[0]))
            share[0] = new

        seen = survey(source, path, robot, points, so_far)
    if named:
        require_all_move(points, seen)
        return points, seen
    moves = [i for i, reach in enumerate(seen.reach) if reach > STILL]
    points = tuple(points[i] for i in moves)
    if not (seen.reach > STILL).any():
        raise InvalidValue("motion", "moves no point of the arm; give one in which a joint moves")
    return points, replace(seen, reach=seen.reach[moves])


@contextmanager
def _progress(words: str, total: float) -> Iterator[Callable[[float], None]]:
    """Show a bar on stderr, or a line now and then."""
    with progress_bar() as progress:
        task = progress.add_task(words, total=total)
        yield lambda count: progress.advance(task, count)


def _end(robot: Robot, how: TypedProgram) -> str | None:
    """Return where the arm of a robot without a tip of its own ends: at its farthest point."""
    depth = {name: len(robot.ancestors(robot.frame(name).joint)) for name in how.points}
    return how.arm.end or max(depth, key=lambda name: depth[name], default=None)


def default_points(robot: Robot, q: Array) -> tuple[str, ...]:
    """Return the end and the frames along the arm that are some way apart in a posture."""
    places = {
        name: np.array(frame_pose(robot, name, q).position, dtype=float).ravel()
        for name, frame in robot.frames.items()
        if frame.joint != BASE
    }
    tip = robot.tip or ""
    chosen = [tip]
    for name in sorted(places, key=lambda name: -robot.frames[name].joint):
        apart = min(np.linalg.norm(places[name] - places[other]) for other in chosen)
        if apart > APART:
            chosen.append(name)
    return tuple(chosen)


def _bodies(how: TypedProgram) -> list[Somebody]:
    cover = None if how.cover is None else load_cover(how.cover)
    shape = None if how.shape is None else shape_from(how.shape)
    somebody: list[Somebody] = []
    everywhere = list(how.regions)
    if how.zones is not None:
        somebody, more = read_zones(how.zones, cover, how.clamped, shape)
        everywhere += more
    somebody += [
        Somebody(Contact(body_region(name), how.clamped, cover=cover), shape)
        for name in dict.fromkeys(everywhere)
    ]
    if not somebody:
        raise InvalidValue("regions", "names no region of the body; give --regions or --zones")
    for body in somebody:
        if body.limits.transient.force == np.inf:
            name = body.contact.region.name
            raise InvalidValue("regions", f"'{name}' has no limits to be kept")
    return somebody


def _cautions(robot: Robot, bodies: Sequence[Somebody], seen: Survey) -> Iterator[str]:
    yield from not_permitted(body.contact.region for body in bodies)
    for name, speed, limit in zip(robot.joint_names, seen.fastest, robot.speed_limits, strict=True):
        if speed > limit * (1 + 1e-6):
            yield f"joint '{name}' moves at up to {speed:.4g}, beyond its speed limit {limit:.4g}"
    if seen.way > COARSE:
        yield (
            f"watched points move up to {100 * seen.way:.0f} cm between samples, and what is "
            "between is not looked at; give the motion with more samples"
        )
