# SPDX-License-Identifier: BSD-3-Clause
"""How fast a robot's program may run, and what limits it at each sample.

At each sample every watched point of the arm may meet every region, where the point goes and as
fast as it goes there. The largest factor on that speed is sought up to which all slower speeds keep
all limits, too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic import (
    Contact,
    ImpactModel,
    InvalidValue,
    Motors,
    frame_pose,
    require_closed_at,
)
from softimpact.symbolic.impact.two_body import moving_mass, two_body
from softimpact.symbolic.robot.rigid import Array

from .history import HORIZON
from .sampled import Samples
from .sampled_speeds import safe_speeds
from .trajectory import Passes, Trajectory, passes, time_at_speeds
from .zones import Somebody

MOMENTS_APART = 0.05
"""Least share of a program's time between two of its worst moments."""

STILL = 1e-4
"""Speed below which a point does not hit anything [m/s]."""


@dataclass(frozen=True, eq=False)
class Danger:
    """What may be met at one of a program's passes, at the worst that the motors may do.

    Attributes:
        point: name of the frame that meets it.
        body: who is met.
        number: which of the bodies that is, from 0.
        limit: that is reached first; ``transient force``, for example.
        motors: kind of motors at which it is.
        sample: of the program, length P.
        speed: of the point there [m/s].
        direction: in which it moves, P×3.
        link_velocity: of the independent joints per 1 m/s of that speed, P×n.
        safe_speed: largest speed that keeps all limits [m/s]; infinite where the program's does.
        peak: force at the program's speed [N].
        share: how much of the limits the program's speed uses; above 1 they are exceeded.
        two_body: speed that the standard's formula allows [m/s].
    """

    point: str
    body: Somebody
    number: int
    limit: NDArray[np.str_]
    motors: NDArray[np.str_]
    sample: NDArray[np.intp]
    speed: Array
    direction: Array
    link_velocity: Array
    safe_speed: Array
    peak: Array
    share: Array
    two_body: float

    @property
    def region(self) -> str:
        """Name of what is met."""
        return self.body.contact.region.name

    @property
    def factor(self) -> Array:
        """Factor on the program's speed that keeps the limits, in (0, 1]."""
        return np.minimum(1.0, self.safe_speed / self.speed)

    def lowered(self, share: float) -> Danger:
        """Return what may be met at a share of the speeds that are safe.

        The program's own speed counts as safe up to that share of the limits only.
        """
        own = np.where(self.share > share, self.speed, np.inf)
        safe = np.where(self.safe_speed < np.inf, self.safe_speed, own)
        return replace(self, safe_speed=np.asarray(share * safe))


@dataclass(frozen=True, eq=False)
class SafeProgram:
    """A program that is slowed down to keep all limits.

    Attributes:
        factor: on the speed at each sample, in (0, 1].
        worst: for each sample the danger that is worst there and its row, None where nothing moves;
            it binds where the factor is below 1.
        two_body: factor by the standard's formula.
        time_before: that the program takes [s].
        time_after: that it takes when slowed down.
        time_by_formula: that it takes when slowed down by the standard's formula.
    """

    factor: Array
    worst: Sequence[tuple[Danger, int] | None]
    two_body: Array
    time_before: float
    time_after: float
    time_by_formula: float


def program_dangers(
    model: ImpactModel,
    motion: Trajectory | Passes,
    points: Sequence[str],
    bodies: Sequence[Contact | Somebody],
    ends: Mapping[str, Motors],
    *,
    horizon: float = HORIZON,
    payload: float = 0.0,
    seen: Callable[[int], None] = lambda count: None,
) -> list[Danger]:
    """Return what each point may do to each body.

    Args:
        model: the whole arm; its own contact point does not matter.
        motion: of its joints, or some moments of one.
        points: frames that may meet a body.
        bodies: what they may meet, everywhere or in zones.
        ends: what the motors may do, by kind; the worst of them counts.
        horizon: up to which the largest force counts [s].
        payload: mass that the model holds, for the standard's formula [kg].
        seen: called with the number of samples that were looked at for a point, a body and a kind
            of motors, every few thousand.

    Raises:
        InvalidValue: a point that never moves.
        LoopCannotClose: the motion opens a loop.
        FrameNotFound: the robot has no such point.
    """
    met = motion if isinstance(motion, Passes) else passes(motion)
    if model.robot.loops:
        for q in met.q:
            require_closed_at(model.robot, q)
    whom = [body if isinstance(body, Somebody) else Somebody(body) for body in bodies]
    found = []
    for point in points:
        at = _at_point(model, met, point)
        if not at.speed.size and isinstance(motion, Trajectory):
            raise never_moves(point)
        for number, body in enumerate(whom):
            formula = formula_speed(model, body, payload)
            rows = np.flatnonzero(body.may_be_met(at.time, at.place, at.speed * at.step))
            found.append(_danger(at.taken(rows), body, number, ends, horizon, formula, seen))
    return found


def formula_speed(model: ImpactModel, body: Somebody, payload: float) -> float:
    """Return the speed that the standard's two-body formula allows a robot with a payload [m/s]."""
    region = body.contact.region
    formula = two_body(region, body.contact.clamped, moving_mass(model.robot) - payload, payload)
    return float(formula.safe_speed(region.force_limit))


def never_moves(point: str) -> InvalidValue:
    """Return what is wrong with a point that a motion leaves where it is."""
    return InvalidValue("points", f"'{point}' never moves in this motion; leave it out")


def safe_program(motion: Trajectory, dangers: Sequence[Danger]) -> SafeProgram:
    """Return a program slowed down to keep all limits."""
    count = len(motion.time)
    factor, formula, share = np.ones(count), np.ones(count), np.zeros(count)
    worst: list[tuple[Danger, int] | None] = [None] * count
    for danger in dangers:
        np.minimum.at(formula, danger.sample, np.minimum(1.0, danger.two_body / danger.speed))
        for row, own in enumerate(danger.factor):
            k = int(danger.sample[row])
            if (own, -danger.share[row]) < (factor[k], -share[k]):
                factor[k], share[k], worst[k] = own, danger.share[row], (danger, row)
    return SafeProgram(
        factor=factor,
        worst=worst,
        two_body=formula,
        time_before=float(motion.time[-1] - motion.time[0]),
        time_after=time_at_speeds(motion.time, factor),
        time_by_formula=time_at_speeds(motion.time, formula),
    )


def worst_moments(motion: Trajectory, program: SafeProgram, count: int = 5) -> list[int]:
    """Return the worst samples, some way apart in time while there are others; worst first."""
    share = np.array(
        [0.0 if worst is None else worst[0].share[worst[1]] for worst in program.worst]
    )
    moves = np.array([worst is not None for worst in program.worst])
    return worst_of(motion.time, program.factor, np.where(moves, share, -np.inf), count)


def worst_of(time: Array, factor: Array, share: Array, count: int = 5) -> list[int]:
    """Return the worst of samples, some way apart in time while there are others; worst first.

    Args:
        time: of the samples [s].
        factor: on their speeds.
        share: of the limits that they use, of interest where the factor is one; −inf where nothing
            moves.
        count: how many are wanted.
    """
    severity = np.where(factor < 1, 2 - factor, np.minimum(share, 1.0))
    severity[share == -np.inf] = -np.inf
    order = np.argsort(-severity, kind="stable")
    order = order[severity[order] > -np.inf]
    apart = MOMENTS_APART * float(time[-1] - time[0])
    chosen: list[int] = []
    left = order
    while left.size and len(chosen) < count:
        chosen.append(int(left[0]))
        left = left[abs(time[left] - time[chosen[-1]]) > apart]
    more = order[~np.isin(order, chosen)][: count - len(chosen)].tolist()
    rank = {int(k): place for place, k in enumerate(order[np.isin(order, [*chosen, *more])])}
    return sorted([*chosen, *more], key=lambda k: rank[k])


@dataclass(frozen=True, eq=False)
class _AtPoint:
    """How a point passes the samples at which it moves."""

    model: ImpactModel
    point: str
    sample: NDArray[np.intp]
    time: Array
    step: Array
    speed: Array
    place: Array
    samples: Samples

    def taken(self, rows: NDArray[np.intp]) -> _AtPoint:
        """Return some of them."""
        if len(rows) == len(self.sample):
            return self
        some = {name: getattr(self, name)[rows] for name in ("sample", "time", "step", "speed")}
        return replace(self, place=self.place[rows], samples=self.samples.taken(rows), **some)


def _at_point(model: ImpactModel, met: Passes, point: str) -> _AtPoint:
    own = ImpactModel(model.robot, model.robot.frame(point).name, model.drives, model.gravity)
    count, rate = len(met.q), met.velocity[:, list(own.independent)]
    symbol = ca.SX.sym("q", met.q.shape[1])
    place: ca.SX = frame_pose(own.robot, own.tip, symbol).position
    wanted = [ca.densify(own.jacobian(symbol)), ca.densify(place)]
    found = ca.Function("point", [symbol], wanted).map(count).call([met.q.T])
    J = np.array(found[0]).reshape(3, count, -1).transpose(1, 0, 2)
    velocity = np.einsum("sij,sj->si", J, rate)
    speed = np.linalg.norm(velocity, axis=1)
    moves = np.flatnonzero(speed > STILL)
    some, speed = met.taken(moves), speed[moves]
    at = Samples(some.q, velocity[moves] / speed[:, None], rate[moves] / speed[:, None])
    places = np.array(found[1]).T[moves]
    return _AtPoint(own, point, some.sample, some.time, some.step, np.asarray(speed), places, at)


def _danger(
    at: _AtPoint,
    body: Somebody,
    number: int,
    ends: Mapping[str, Motors],
    horizon: float,
    by_formula: float,
    seen: Callable[[int], None],
) -> Danger:
    count = len(at.speed)
    safe, peak, share = np.full(count, np.inf), np.zeros(count), np.zeros(count)
    limit, motors = np.full(count, "", dtype="<U24"), np.full(count, "", dtype="<U8")
    for kind, end in ends.items():
        found = safe_speeds(
            at.model, at.samples, at.speed, body.contact, end, horizon, body.limits, seen
        )
        speed, name, used = found.safe, found.limit, found.share
        worse = (speed < safe) | ((speed == safe) & (used > share))
        limit[worse], motors[worse] = name[worse], kind
        safe, peak, share = (
            np.minimum(safe, speed),
            np.maximum(peak, found.peak),
            np.maximum(share, used),
        )
    return Danger(
        point=at.point,
        body=body,
        number=number,
        limit=limit,
        motors=motors,
        sample=at.sample,
        speed=at.speed,
        direction=at.samples.direction,
        link_velocity=at.samples.link_velocity,
        safe_speed=safe,
        peak=peak,
        share=share,
        two_body=by_formula,
    )
