# SPDX-License-Identifier: BSD-3-Clause
"""How fast a robot's program may run, and what limits it at each sample.

At each sample every watched point of the arm may meet every region, where the point goes and as
fast as it goes there. The largest factor on that speed is sought up to which all slower speeds keep
all limits, too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic import (
    Contact,
    ImpactModel,
    InvalidValue,
    Motors,
    require_closed_at,
)
from softimpact.symbolic.impact.two_body import moving_mass, two_body
from softimpact.symbolic.robot.rigid import Array

from .history import HORIZON
from .sampled import Samples
from .sampled_speeds import safe_speeds
from .trajectory import Trajectory, passes, time_at_speeds

MOMENTS_APART = 0.05
"""Least share of a program's time between two of its worst moments."""

STILL = 1e-4
"""Speed below which a point does not hit anything [m/s]."""


@dataclass(frozen=True, eq=False)
class Danger:
    """What may be met at one of a program's passes, at the worst that the motors may do.

    Attributes:
        point: name of the frame that meets it.
        region: name of what is met.
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
    region: str
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
    def factor(self) -> Array:
        """Factor on the program's speed that keeps the limits, in (0, 1]."""
        return np.minimum(1.0, self.safe_speed / self.speed)


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
    motion: Trajectory,
    points: Sequence[str],
    bodies: Sequence[Contact],
    ends: Mapping[str, Motors],
    *,
    horizon: float = HORIZON,
    payload: float = 0.0,
    seen: Callable[[int], None] = lambda count: None,
) -> list[Danger]:
    """Return what each point may do to each body.

    Args:
        model: the whole arm; its own contact point does not matter.
        motion: of its joints.
        points: frames that may meet a body.
        bodies: what they may meet.
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
    if model.robot.loops:
        for q in motion.q:
            require_closed_at(model.robot, q)
    found = []
    for point in points:
        at = _at_point(model, motion, point)
        for body in bodies:
            formula = two_body(
                body.region, body.clamped, moving_mass(model.robot) - payload, payload
            )
            found.append(
                _danger(
                    at,
                    body,
                    ends,
                    horizon,
                    float(formula.safe_speed(body.region.force_limit)),
                    seen,
                )
            )
    return found


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
    severity = np.full(len(program.factor), -np.inf)
    for k, worst in enumerate(program.worst):
        if worst is not None:
            danger, row = worst
            slowed = program.factor[k] < 1
            severity[k] = 2 - program.factor[k] if slowed else min(danger.share[row], 1.0)
    order = [int(k) for k in np.argsort(-severity, kind="stable") if severity[k] > -np.inf]
    apart = MOMENTS_APART * program.time_before
    chosen: list[int] = []
    for k in order:
        if all(abs(motion.time[k] - motion.time[other]) > apart for other in chosen):
            chosen.append(k)
    more = [k for k in order if k not in chosen[:count]]
    return sorted([*chosen[:count], *more][:count], key=order.index)


@dataclass(frozen=True, eq=False)
class _AtPoint:
    """How a point passes the samples at which it moves."""

    model: ImpactModel
    point: str
    sample: NDArray[np.intp]
    speed: Array
    samples: Samples


def _at_point(model: ImpactModel, motion: Trajectory, point: str) -> _AtPoint:
    own = ImpactModel(model.robot, model.robot.frame(point).name, model.drives, model.gravity)
    met = passes(motion)
    q, rate = motion.q[met.sample], met.velocity[:, list(own.independent)]
    symbol = ca.SX.sym("q", q.shape[1])
    jacobian = ca.Function("J", [symbol], [ca.densify(own.jacobian(symbol))]).map(len(q))
    J = np.array(jacobian(q.T)).reshape(3, len(q), -1).transpose(1, 0, 2)
    velocity = np.einsum("sij,sj->si", J, rate)
    speed = np.linalg.norm(velocity, axis=1)
    moves = np.flatnonzero(speed > STILL)
    if not moves.size:
        raise InvalidValue("points", f"'{point}' never moves in this motion; leave it out")
    speed = speed[moves]
    at = Samples(q[moves], velocity[moves] / speed[:, None], rate[moves] / speed[:, None])
    return _AtPoint(own, point, met.sample[moves], np.asarray(speed), at)


def _danger(
    at: _AtPoint,
    body: Contact,
    ends: Mapping[str, Motors],
    horizon: float,
    by_formula: float,
    seen: Callable[[int], None],
) -> Danger:
    count = len(at.speed)
    safe, peak, share = np.full(count, np.inf), np.zeros(count), np.zeros(count)
    limit, motors = np.full(count, "", dtype="<U24"), np.full(count, "", dtype="<U8")
    for kind, end in ends.items():
        found = safe_speeds(at.model, at.samples, at.speed, body, end, horizon, seen)
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
        region=body.region.name,
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
