# SPDX-License-Identifier: BSD-3-Clause
"""Speed factors of long programs by the generated C, some two hundred times as fast as Python.

C answers from the safe side: its speeds keep 1 to 2.3 % of a limit free (up to 3.8 % on bodies
that damp hard), Python's 0.3 %. What C does not know, it does not decide: a status other than OK,
what may press on a clamped body later, and a point outside of its zones are left to Python, one by
one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from softimpact.batch import CompiledPackage, NoCompiler, compiled_arm
from softimpact.codegen import region_parameters
from softimpact.codegen.inputs.parameters import is_elastic
from softimpact.simulate.history import PRESSED_UNTIL
from softimpact.simulate.program import STILL, formula_speed
from softimpact.simulate.trajectory import Passes
from softimpact.simulate.zones import Somebody
from softimpact.symbolic import Contact, ImpactModel, InvalidValue, Motors
from softimpact.symbolic.robot.rigid import Array

from .motion_source import moving_points
from .table import LIMITS, ProgramTable

Engine = Literal["auto", "c", "python"]
"""Who integrates the impacts of a program."""

STIFF = 1e7
"""What a rigid joint is in C [N·m/rad]: a hundred times the stiffest of geared joints."""

FOR_STIFF = 5e-3
"""Share of a limit that is kept free for that; the forces were up to 0.15 % apart."""

STEPS = 100_000
"""Budget of a call: a controller's is some 8000, but here nobody waits for one sample."""

LIGHT = 1e-4
"""Rotor that stands for none, which C does not take [kg m²]."""

OK = 0


def why_not_in_c(
    model: ImpactModel, bodies: Sequence[Somebody], ends: Mapping[str, Motors]
) -> str | None:
    """Return what of a question C knows nothing of, None if it can answer."""
    robot = model.robot
    if not is_elastic(robot) and any(model.drives.elastic):
        return "springs behind motors where loops, passive joints or springs are part of the robot"
    if not is_elastic(robot) and robot.damping.any():
        return "the joints' damping where loops, passive joints or springs are part of the robot"
    if model.drives.computed_torque_gain is not None:
        return "computed-torque gains"
    if any(end.reaction == "stop" for end in ends.values()):
        return "motors that stop"
    if any(body.contact.region.plate_mass for body in bodies):
        return "a device's plate"
    return None


@dataclass(frozen=True, eq=False)
class _Moved:
    """Places [m], velocities and speeds [m/s] of all points, P×points×3, ×3 and P×points."""

    place: Array
    velocity: Array
    speed: Array

    def within(self, met: Passes, body: Somebody) -> NDArray[np.bool_]:
        """Return which points move where they may meet somebody, P×points."""
        way = self.speed * met.step[:, None]
        each = [
            body.may_be_met(met.time, self.place[:, p], way[:, p])
            for p in range(self.speed.shape[1])
        ]
        return np.column_stack(each) & (self.speed > STILL)


def _note(
    table: ProgramTable,
    place: NDArray[np.intp],
    rows: NDArray[np.intp],
    factor: Array,
    moved: _Moved,
    point: NDArray[np.intp],
    codes: tuple[int, str, str],
) -> None:
    """Put passes into a table where they are slower than what is there.

    Args:
        table: to be changed.
        place: of each pass in it.
        rows: of the passes.
        factor: of each pass.
        moved: how their points move.
        point: that binds, for each of the rows.
        codes: the body's number, the limit and the kind of motors.
    """
    order = np.argsort(-factor[rows], kind="stable")  # the slower pass of a sample is put last
    rows, point = rows[order], point[order]
    lower = factor[rows] < table.factor[place[rows]]
    rows, point = rows[lower], point[lower]
    at, speed = place[rows], moved.speed[rows, point]
    table.factor[at], table.point[at] = factor[rows], point
    table.speed[at], table.safe_speed[at] = speed, factor[rows] * speed
    table.direction[at] = moved.velocity[rows, point] / speed[:, None]
    table.peak[at] = table.share[at] = np.nan
    number, limit, kind = codes
    table.body[at], table.limit[at] = number, LIMITS.index(limit)
    table.motors[at] = table.names.motors.index(kind)


@dataclass(frozen=True, eq=False)
class CompiledEngine:
    """The compiled arm, and what it may meet; see ``compiled_engine``."""

    package: CompiledPackage
    moving: Any
    model: ImpactModel
    bodies: Sequence[Somebody]
    ends: Mapping[str, Motors]
    horizon: float
    formula: Sequence[float]
    regions: Mapping[Contact, Mapping[str, Any]]

    def fill(self, table: ProgramTable, met: Passes, first: int) -> NDArray[np.intp]:
        """Note factors, and return the samples that Python has to decide.

        Args:
            table: without anything in it yet at these samples.
            met: passes of some samples.
            first: number of the table's first sample.
        """
        moved = self._moved(met)
        factor, unsure = np.ones(len(met.q)), np.zeros(len(met.q), dtype=bool)
        for number, body in enumerate(self.bodies):
            within = moved.within(met, body)
            rows = np.flatnonzero(within.any(axis=1))
            slowest = self.formula[number] / np.where(within, moved.speed, 0.1 * STILL).max(axis=1)
            np.minimum.at(table.two_body, met.sample[rows] - first, slowest[rows])
            allowed = self._allowed(body.limits.transient.force)
            for kind, end in self.ends.items():
                found = self._call(met, rows, factor, allowed, body, kind, end, self.horizon)
                is_ok, lower = found["status"] == OK, found["factor"] < 1
                point = np.where(lower, found["point"], 0).astype(int)
                unsure[rows] |= ~is_ok | (lower & ~within[rows, point])
                lower &= ~unsure[rows]
                factor[rows[lower]] *= found["factor"][lower]
                codes = number, f"transient {body.limits.transient.quantity}", kind
                _note(table, met.sample - first, rows[lower], factor, moved, point[lower], codes)
            unsure[rows] |= self._may_press(met, rows, factor, body)
        at = met.sample[(moved.speed > STILL).any(axis=1)] - first
        table.share[at[table.factor[at] == 1]] = np.nan
        return np.unique(met.sample[unsure])

    def _moved(self, met: Passes) -> _Moved:
        """Return where all points are, and how they move."""
        found = self.moving.map(len(met.q)).call([met.q.T, met.velocity.T])
        place, velocity = (np.array(x).T.reshape(len(met.q), -1, 3) for x in found)
        return _Moved(place, velocity, np.linalg.norm(velocity, axis=2))

    def _allowed(self, force: float) -> float:
        as_it_is = all(self.model.drives.elastic) or not is_elastic(self.model.robot)
        return force if as_it_is else force * (1 - FOR_STIFF)

    def _call(
        self,
        met: Passes,
        rows: NDArray[np.intp],
        factor: Array,
        allowed: float,
        body: Somebody,
        kind: str,
        end: Motors,
        horizon: float,
    ) -> dict[str, Array]:
        """Return by how much passes must slow down beyond a factor."""
        if not rows.size or allowed == np.inf:
            return {
                "factor": np.ones(len(rows)),
                "point": np.zeros(len(rows)),
                "status": np.zeros(len(rows)),
            }
        options = self._options(body, kind, end, horizon)
        slowed = factor[rows, None] * met.velocity[rows]
        return dict(self.package.speed_factor(met.q[rows], slowed, allowed, **options))

    def _options(self, body: Somebody, kind: str, end: Motors, horizon: float) -> dict[str, Any]:
        return {
            "region": self.regions[body.contact],
            "motors": kind,
            "reaction_time": min(end.reaction_time, 2 * horizon),
            "horizon": horizon,
            "steps": STEPS,
        }

    def _may_press(
        self, met: Passes, rows: NDArray[np.intp], factor: Array, body: Somebody
    ) -> NDArray[np.bool_]:
        """Return which passes might reach a quasi-static limit."""
        pressing, could = body.limits.quasi_static, np.zeros(len(rows), dtype=bool)
        if pressing is None or pressing.force == np.inf:
            return could
        until, allowed = max(self.horizon, PRESSED_UNTIL), self._allowed(pressing.force)
        for kind, end in self.ends.items():
            left = np.flatnonzero(~could)
            at = rows[left]
            if not at.size:
                continue
            slowed = factor[at, None] * met.velocity[at]
            options = self._options(body, kind, end, until)
            found = self.package.may_press(met.q[at], slowed, allowed, **options)
            could[left] = (found["status"] != OK) | (found["may"] != 0)
        return could


def compiled_engine(
    model: ImpactModel,
    points: Sequence[str],
    bodies: Sequence[Somebody],
    ends: Mapping[str, Motors],
    *,
    horizon: float,
    payload: float,
) -> CompiledEngine | str:
    """Return the arm in C, or why Python has to do; arguments as ``program_dangers``."""
    unknown = why_not_in_c(model, bodies, ends)
    if unknown is not None:
        return f"the generated C knows nothing of {unknown}"
    robot, first = model.robot, points[0]
    known = replace(model.drives, torque_limits=None)
    if is_elastic(robot):
        springs = np.array(model.drives.springs, dtype=float).ravel()
        rotors = np.maximum(np.array(model.drives.rotors, dtype=float).ravel(), LIGHT)
        known = replace(
            known,
            rotors=ca.DM(rotors),
            springs=ca.DM(np.where(model.drives.elastic, springs, STIFF)),
            elastic=(True,) * robot.n,
        )
    others = {f"p{i}": point for i, point in enumerate(points) if i > 0}
    try:
        package = compiled_arm(robot, known, tip=first, points=others, gravity=model.gravity)
    except NoCompiler as error:
        return str(error).split(";")[0]
    formula = [formula_speed(model, body, payload) for body in bodies]
    try:
        regions = {body.contact: region_parameters(body.contact) for body in bodies}
    except InvalidValue as error:
        return f"the generated C cannot take a law of contact: {error}"
    return CompiledEngine(
        package, moving_points(robot, points), model, bodies, ends, horizon, formula, regions
    )
