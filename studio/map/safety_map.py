# SPDX-License-Identifier: BSD-3-Clause
"""How fast a robot may go all over a plane, or along its self-motion, from what a user typed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from softimpact.optimize.posture.self_motion import self_motion
from softimpact.optimize.posture.workspace import Hold, postures_in_plane
from softimpact.simulate import HORIZON, bracket
from softimpact.simulate.history import require_horizon, require_speed
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    InvalidValue,
    Motors,
    body_region,
    frame_pose,
    impact_model,
    limits_of,
    unit_direction,
)
from softimpact.symbolic.body.body_file import load_cover
from softimpact.symbolic.impact.motors import refuse_held
from softimpact.symbolic.impact.two_body import moving_mass, two_body
from softimpact.symbolic.robot.rigid import Array

from ..output.cautions import not_permitted
from ..robot.first_study import first_posture
from ..typed import values
from ..typed.groups import TypedArm, TypedDrives
from ..typed.motors import motors_meant
from ..typed.situation import (
    beyond_limits,
    drives_of,
    gravity_of,
    loaded_arm,
)
from .speeds import lowered_slowest, map_samples, map_speeds
from .worst_directions import worst_directions

Over = Literal["plane", "self-motion"]
PlaneName = Literal["xy", "xz", "yz"]


@dataclass(frozen=True)
class TypedMap:
    """The options of a map, as typed; see ``map_command``."""

    arm: TypedArm
    drives: TypedDrives
    q: str | None = None
    over: str = "plane"
    plane: str = "xz"
    step: float = 0.05
    hold: str | None = None
    direction: str | None = None
    region: str = "chest"
    cover: str | None = None
    clamped: bool = True
    speed: float = 0.5
    horizon: float | None = None
    gravity: str | None = None


@dataclass(frozen=True, eq=False)
class SafetyMap:
    """A map; arrays have an entry for each posture, NaN where the tip cannot go that way.

    Attributes:
        arm: as typed.
        model: the robot.
        over: what it is over.
        postures: in the order of the map, N×n.
        place: of the tip, N×3 [m].
        cells: index of each posture in the plane, N×2; None along the self-motion.
        axes: indices of the plane's axes; None along the self-motion.
        grid: where rows and columns of the plane lie [m]; None along the self-motion.
        arc: way along the self-motion in joint space, N [rad]; None in a plane.
        begun: index of the posture that the map begins with.
        direction: of each impact, N×3.
        safe_speed: largest speed that keeps all limits [m/s].
        limit: that is reached there first; ``transient force``, for example.
        motors: kind at which it is.
        peak: force at ``speed`` [N].
        speed: [m/s].
        body: that is hit.
        ends: what the motors may do.
        horizon: up to which forces count [s].
        two_body: speed that the standard's formula allows [m/s].
        asked: the direction that was asked for; None where the worst was sought.
        hold: what of the tip was led along.
        warnings: a line each.
    """

    arm: TypedArm
    model: ImpactModel
    over: Over
    postures: Array
    place: Array
    cells: NDArray[np.intp] | None
    axes: tuple[int, int] | None
    grid: tuple[Array, Array] | None
    arc: Array | None
    begun: int
    direction: Array
    safe_speed: Array
    limit: NDArray[np.str_]
    motors: NDArray[np.str_]
    peak: Array
    speed: float
    body: Contact
    ends: Mapping[str, Motors]
    horizon: float
    two_body: float
    asked: Array | None
    hold: Hold | None
    warnings: tuple[str, ...]

    @property
    def slowest(self) -> int:
        """Index of the posture that allows the least speed."""
        return int(np.nanargmin(self.safe_speed))


@dataclass(frozen=True, eq=False)
class _Ground:
    """The postures of a map, and where they are."""

    postures: Array
    begun: int
    cells: NDArray[np.intp] | None = None
    axes: tuple[int, int] | None = None
    grid: tuple[Array, Array] | None = None
    arc: Array | None = None
    hold: Hold | None = None


def safety_map(how: TypedMap, seen: Callable[[int], None] = lambda count: None) -> SafetyMap:
    """Return a map; raises SoftImpactError.

    Args:
        how: what was typed.
        seen: called with the number of impacts that were looked at.
    """
    over: Over = values.one_of("map's ground", how.over, Over)
    motors, reaction = motors_meant(how.drives)
    if motors is not None:
        refuse_held(motors, "a map of safe speeds")
    require_speed(how.speed)
    horizon = HORIZON if how.horizon is None else how.horizon
    require_horizon(horizon)
    arm = loaded_arm(how.arm)
    robot = arm.robot
    if robot.loops:
        raise InvalidValue("model", f"'{robot.name}' has closed loops; maps are of open chains")
    drives = drives_of(robot, how.drives)
    model = impact_model(robot, drives=drives, gravity=gravity_of(how.gravity))
    body = _body(how)
    asked = None if how.direction is None else unit_direction(
        values.vector("direction", how.direction, 3)
    )  # fmt: skip
    q = first_posture(robot)[0] if how.q is None else np.array(values.vector("q", how.q))
    told = beyond_limits(robot, robot.vector("q", q))
    if told and over == "plane":
        raise InvalidValue("q", f"is where no map can begin: {told[0]}")
    found, assumed = bracket(model, motors, reaction)
    ends = {kind: end for kind, end in found.items() if isinstance(end, Motors)}
    ground = _ground(model, q, over, how)
    if asked is None:
        direction, guess = worst_directions(model, ground.postures, body, ends, seen)
    else:
        direction, guess = np.tile(asked, (len(ground.postures), 1)), None
    samples, rows = map_samples(model, ground.postures, direction, guess)
    if not len(rows):
        raise InvalidValue("direction", "is one in which the tip moves nowhere on the map")
    speeds = np.full(len(rows), how.speed) if guess is None else guess[rows]
    best, which, limit, peak = map_speeds(model, samples, speeds, body, ends, how.speed, horizon)
    best, doubts = lowered_slowest(model, samples, best, body, ends, horizon)
    seen(len(rows))
    formula = two_body(body.region, body.clamped, float(moving_mass(robot)), arm.load)
    return SafetyMap(
        arm=how.arm,
        model=model,
        over=over,
        postures=ground.postures,
        place=np.array(
            [np.array(frame_pose(robot, model.tip, x).position).ravel() for x in ground.postures]
        ),
        cells=ground.cells,
        axes=ground.axes,
        grid=ground.grid,
        arc=ground.arc,
        begun=ground.begun,
        direction=direction,
        safe_speed=_spread(best, rows, len(direction)),
        limit=_words(limit, rows, len(direction)),
        motors=_words(which, rows, len(direction)),
        peak=_spread(peak, rows, len(direction)),
        speed=how.speed,
        body=body,
        ends=ends,
        horizon=horizon,
        two_body=float(formula.safe_speed(limits_of(body.region, body.clamped).transient.force)),
        asked=asked,
        hold=ground.hold,
        warnings=(
            *arm.warnings,
            *told,
            *assumed,
            *_cautions(model, body, len(rows), direction),
            *doubts,
        ),
    )


def _body(how: TypedMap) -> Contact:
    cover = None if how.cover is None else load_cover(how.cover)
    body = Contact(body_region(how.region), how.clamped, cover=cover)
    if limits_of(body.region, body.clamped).transient.force == np.inf:
        raise InvalidValue("region", f"'{body.region.name}' has no limits to be kept")
    return body


def _ground(model: ImpactModel, q: Array, over: Over, how: TypedMap) -> _Ground:
    if over == "self-motion":
        curve = self_motion(model, q, how.step)
        return _Ground(curve.q, int(abs(curve.arc).argmin()), arc=curve.arc)
    name: PlaneName = values.one_of("plane", how.plane, PlaneName)
    default: Hold = "pose" if model.robot.n >= 6 else "position"
    hold: Hold = default if how.hold is None else values.one_of("hold", how.hold, Hold)
    u, v = ("xyz".index(axis) for axis in name)
    plane = postures_in_plane(model, q, (u, v), how.step, hold)
    cells = np.argwhere(plane.reached)
    postures = plane.q[plane.reached]
    begun = int(np.linalg.norm(postures - q, axis=1).argmin())
    return _Ground(postures, begun, cells, (u, v), (plane.u, plane.v), hold=hold)


def _spread(found: Array, rows: NDArray[np.intp], count: int) -> Array:
    every = np.full(count, np.nan)
    every[rows] = found
    return every


def _words(found: NDArray[np.str_], rows: NDArray[np.intp], count: int) -> NDArray[np.str_]:
    every = np.full(count, "", found.dtype)
    every[rows] = found
    return every


def _cautions(model: ImpactModel, body: Contact, moving: int, directions: Array) -> Iterator[str]:
    yield from not_permitted([body.region])
    lost = len(directions) - moving
    if lost:
        yield (
            f"at {lost} of {len(directions)} postures the tip cannot move so, or not fast enough "
            "to reach a limit; they are blank"
        )
