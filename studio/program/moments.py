# SPDX-License-Identifier: BSD-3-Clause
"""What a program may do to whom, asked of Python at some of its moments."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from softimpact.simulate import Approach
from softimpact.simulate.band import Band, impact_band
from softimpact.simulate.program import Danger, formula_speed, program_dangers
from softimpact.simulate.trajectory import Passes
from softimpact.simulate.zones import Somebody
from softimpact.symbolic import ImpactModel, Motors
from softimpact.symbolic.robot.rigid import Array

from .motion_source import MotionSource, samples_of
from .table import ProgramTable


@dataclass(frozen=True, eq=False)
class Question:
    """What may meet whom, as ``program_dangers`` takes it."""

    model: ImpactModel
    points: Sequence[str]
    bodies: Sequence[Somebody]
    ends: Mapping[str, Motors]
    horizon: float
    payload: float

    @property
    def width(self) -> int:
        """Impacts a sample."""
        return len(self.points) * len(self.bodies) * len(self.ends)

    def dangers(
        self, met: Passes, seen: Callable[[int], None] = lambda count: None
    ) -> list[Danger]:
        """Return what is dangerous at some samples, by Python."""
        return program_dangers(
            self.model,
            met,
            self.points,
            self.bodies,
            self.ends,
            horizon=self.horizon,
            payload=self.payload,
            seen=seen,
        )


def by_python(
    source: MotionSource, question: Question, table: ProgramTable, rows: Sequence[int]
) -> ProgramTable:
    """Return Python's rows of a table."""
    found = samples_of(source, list(rows))
    parts = [replace(found[k], sample=0 * found[k].sample + i) for i, k in enumerate(rows)]
    met = Passes(*(np.concatenate([vars(p)[name] for p in parts]) for name in vars(parts[0])))
    own = ProgramTable.empty(table.names, table.time[list(rows)])
    own.put(question.dangers(met), 0)
    return own


def moments_at(
    source: MotionSource, question: Question, table: ProgramTable, rows: Sequence[int]
) -> list[dict[str, Any]]:
    """Return all that Python knows of some samples at which something moves."""
    if not len(rows):
        return []
    found = samples_of(source, list(rows))
    own = by_python(source, question, table, rows)
    moments = []
    for i, k in enumerate(rows):
        met, moment = found[k], own.moment(i)
        if moment is None:
            continue
        moment |= {"sample": k, "t": table.time[k], "q": met.q[0]}
        moment |= slowed(moment, table.factor[k])
        moment["body"] = int(own.body[i])
        body = question.bodies[moment["body"]]
        moment["iso_safe_speed"] = formula_speed(question.model, body, question.payload)
        moment["joint_velocity"] = _pass(question, met, moment)
        if body.shape is not None:
            moment["pressure"] = body.shape.pressure(moment["peak"])
        moments.append(moment)
    return moments


def slowed(moment: dict[str, Any], factor: float) -> dict[str, Any]:
    """Return a moment of a program that runs at this factor there."""
    safe = {"safe_speed": factor * moment["speed"]} if factor < 1 else {}
    return {**moment, "factor": factor, **safe}


def _pass(question: Question, met: Passes, moment: dict[str, Any]) -> Array:
    """Return the joint velocities of the pass of a sample that is meant."""
    at = at_point(question.model, moment["point"])
    J = np.array(at.jacobian(ca.DM(met.q[0])), dtype=float)
    rate = met.velocity[:, list(at.independent)]
    along = rate @ J.T @ moment["direction"]
    return np.asarray(met.velocity[int(np.argmin(abs(along - moment["speed"])))])


def at_point(model: ImpactModel, point: str) -> ImpactModel:
    """Return an arm with another contact point."""
    return replace(model, tip=model.robot.frame(point).name)


def approach_at(question: Question, moment: dict[str, Any], speed: float | None = None) -> Approach:
    """Return how a point moves at one of the worst moments, at that speed or another."""
    at = at_point(question.model, moment["point"])
    rate = np.array(moment["joint_velocity"])[list(at.independent)] / moment["speed"]
    direction = np.array(moment["direction"], dtype=float)
    return Approach(moment["q"], direction, moment["speed"] if speed is None else speed, rate)


def band_at(question: Question, moment: dict[str, Any]) -> Band:
    """Return the band of the peak at the program's own speed."""
    body = question.bodies[moment["body"]]
    return impact_band(
        at_point(question.model, moment["point"]),
        approach_at(question, moment),
        body.contact,
        question.ends.values(),
        body.limits,
        horizon=question.horizon,
    ).peak
