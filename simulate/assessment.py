# SPDX-License-Identifier: BSD-3-Clause
"""Whether an impact keeps what the body may bear, under the worst that the motors may do."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic import Contact, ImpactModel, InvalidValue, Motors
from softimpact.symbolic.body.shapes import Shape
from softimpact.symbolic.body.verdict import Limits, Verdict, judge, limits_of
from softimpact.symbolic.impact.motors import refuse_held
from softimpact.symbolic.impact.two_body import TwoBody, moving_mass, two_body
from softimpact.symbolic.record import Record, Row
from softimpact.symbolic.robot.rigid import Array

from .arrival import Approach, arrival_of
from .band import ImpactBand, impact_band
from .bracket import bracket
from .controller import Controller
from .history import HORIZON, Fidelity, ImpactHistory
from .impact import simulate_impact
from .safe_speed import ForceLimits
from .tolerances import Tolerances
from .trust import CHECKED, by_full_order, largest_linear_error, not_trusted, safe_speeds


@dataclass(frozen=True, eq=False)
class Assessment(Record):
    """One impact, held against every limit.

    Attributes:
        ends: what happens, by kind of motors: one where the kind is known, else the two ends of
            the bracket {free, driven} that a servo lies between.
        worst: kind of the end that counts.
        limits: of what is hit.
        verdict: on the worst end.
        energy: that the region's spring takes up at the peak [J].
        two_body: force [N] by the standard's formula, and the speed [m/s] that keeps its limit.
        safe_speeds: largest speed that keeps every limit, by kind of motors; None if not asked for.
        joint_velocity: at first touch, length n [rad/s, m/s].
        joint_speed_limit_exceeded: names of joints that are then faster than they can be.
        torque_limit_exceeded: names of joints on which a servo asks for more than its motor has,
            in a linear model, which lets it have that.
        band: of the impact for what is not known exactly; None if not asked for.
        linear_error: share of the force by which a linear model may be off, see ``linear_error``;
            None for other models and closed chains. Beyond ``TRUSTED``, and where it may break a
            limit, the nonlinear robot was simulated, too, and the worse of both counts.
        warnings: what was assumed for want of a number, a line each.
    """

    ends: Mapping[str, ImpactHistory]
    worst: str
    limits: Limits
    verdict: Verdict
    energy: float
    two_body: Mapping[str, float]
    safe_speeds: Mapping[str, float] | None
    joint_velocity: Array
    joint_speed_limit_exceeded: tuple[str, ...]
    torque_limit_exceeded: tuple[str, ...]
    band: ImpactBand | None
    linear_error: float | None
    warnings: tuple[str, ...]

    @property
    def history(self) -> ImpactHistory:
        """What happens at the worst end."""
        return self.ends[self.worst]

    @property
    def safe_speed(self) -> float | None:
        """Largest speed that keeps every limit at every end [m/s]."""
        return None if self.safe_speeds is None else min(self.safe_speeds.values())

    def rows(self) -> list[Row]:
        """Return a line for each end of what the motors may do."""
        return [self._row(kind, history) for kind, history in self.ends.items()]

    def _row(self, kind: str, history: ImpactHistory) -> Row:
        verdict = _verdict(self.limits, history)
        return {
            "motors": kind,
            "peak": history.peak,
            "time_of_peak": history.time_of_peak,
            "first_contact": history.first_contact,
            "pressing": history.pressing,
            "share_of_limit": verdict.share,
            "binding": verdict.binding,
            "verdict": verdict.ruling,
            "safe_speed": None if self.safe_speeds is None else self.safe_speeds[kind],
        }


def assess_impact(
    model: ImpactModel,
    approach: Approach,
    contact: Contact,
    fidelity: Fidelity = "linearised",
    *,
    motors: Motors | Controller | None = None,
    reaction: Motors | None = None,
    horizon: float = HORIZON,
    shape: Shape | None = None,
    payload: float = 0.0,
    order: int = 3,
    safe_speed: bool = False,
    tolerances: Tolerances | None = None,
    tolerance: float = 1e-10,
) -> Assessment:
    """Assess one impact.

    Args:
        model: the robot and its contact point.
        approach: how it arrives.
        contact: what it hits.
        fidelity: as in ``simulate_impact``.
        motors: what they do; None: a servo where the model has gains, else the bracket.
        reaction: reaction time and what follows, where ``motors`` is None; default as ``Motors``.
        horizon: up to which the largest force counts [s].
        shape: of what touches; None: pressure is not judged.
        payload: that the robot holds, for the standard's formula [kg]; the model has it already.
        order: of a chain.
        safe_speed: whether to find the largest safe speed.
        tolerances: how far numbers may be from the truth, for the band; None leaves it out.
        tolerance: as in ``simulate_impact``.

    Raises:
        InvalidValue: motors are free or a servo, and a rotor's inertia is unknown; a safe speed of
            held motors; and as ``simulate_impact`` does.
    """
    arrival = arrival_of(model, approach)
    if safe_speed and isinstance(motors, Motors):
        refuse_held(motors, "a safe speed")
    lumped = fidelity in ("one_mass", "two_mass")
    ends, warnings = bracket(model, motors, reaction, lumped)
    run: dict[str, Any] = {
        "fidelity": fidelity,
        "horizon": horizon,
        "order": order,
        "tolerance": tolerance,
    }
    found = {
        name: simulate_impact(model, approach, contact, motors=end, **run)
        for name, end in ends.items()
    }
    error = largest_linear_error(model, approach, found)
    limits = limits_of(contact.region, contact.clamped, shape)

    def harm(history: ImpactHistory) -> tuple[float, float]:
        return _verdict(limits, history).share, history.peak

    if not_trusted(error, max(harm(history)[0] for history in found.values())):
        warnings.append(f"the linear model may be off by {100 * error:.1f} %: {CHECKED}")
        by_full = by_full_order(model, approach, contact, ends, horizon, tolerance)
        found = {k: max(h, by_full[k], key=harm) for k, h in found.items()}
    worst = max(found, key=lambda name: harm(found[name]))
    formula = two_body(contact.region, contact.clamped, moving_mass(model.robot) - payload, payload)
    speeds = None
    if safe_speed:
        speeds, lines = safe_speeds(model, approach, contact, force_limits(limits), ends, run)
        warnings += lines
    return Assessment(
        ends=found,
        worst=worst,
        limits=limits,
        verdict=_verdict(limits, found[worst]),
        energy=found[worst].peak ** 2 / (2 * contact.region.stiffness),
        two_body=_by_formula(formula, arrival.speed, contact),
        safe_speeds=speeds,
        joint_velocity=arrival.speed * arrival.link_velocity,
        joint_speed_limit_exceeded=_too_fast(model, arrival.speed * arrival.link_velocity),
        torque_limit_exceeded=_too_strong(model, found[worst]),
        band=_band(model, approach, contact, ends, limits, tolerances, horizon),
        linear_error=error,
        warnings=(*warnings, *unused_of_the_file(model, lumped)),
    )


def _band(
    model: ImpactModel,
    approach: Approach,
    contact: Contact,
    ends: Mapping[str, Motors | Controller | None],
    limits: Limits,
    tolerances: Tolerances | None,
    horizon: float,
) -> ImpactBand | None:
    if tolerances is None:
        return None
    known = [end for end in ends.values() if isinstance(end, Motors)]
    if len(known) < len(ends):
        raise InvalidValue("band", "needs motors of a kind: a chain, linearised or full model")
    return impact_band(
        model, approach, contact, known, limits, tolerances=tolerances, horizon=horizon
    )


def unused_of_the_file(model: ImpactModel, lumped: bool = False) -> Iterator[str]:
    """Yield what of the file is used in a way to know of, or not used."""
    robot = model.robot
    if robot.damping.any() and not lumped:
        yield (
            "the joints' damping counts; motors are taken to go on with what it needed of them "
            "before the impact, as the worse case"
        )
    rubbing = _names(model, np.array([robot.joints[i].friction > 0 for i in model.independent]))
    if rubbing:
        yield f"dry friction of joints {', '.join(rubbing)} is not used; it would lower the force"
    if robot.position_gains.any() and not model.drives.has_gains:
        yield "the file's servos are not used; 'servo' motors take their gains from it"


def force_limits(limits: Limits) -> ForceLimits:
    """Return limits as the forces that reach them."""
    pressing = inf if limits.quasi_static is None else limits.quasi_static.force
    return ForceLimits(limits.transient.force, pressing)


def _verdict(limits: Limits, history: ImpactHistory) -> Verdict:
    return judge(limits, history.peak, history.pressing)


def _by_formula(formula: TwoBody, speed: float, contact: Contact) -> dict[str, float]:
    limit = contact.region.force_limit
    return {"force": float(formula.force(speed)), "safe_speed": float(formula.safe_speed(limit))}


def _too_fast(model: ImpactModel, velocity: Array) -> tuple[str, ...]:
    limits = model.robot.speed_limits[list(model.independent)]
    return _names(model, abs(velocity) > limits * (1 + 1e-9))


def _too_strong(model: ImpactModel, history: ImpactHistory) -> tuple[str, ...]:
    limits = model.drives.torque_limits
    if history.largest_torque is None or limits is None:
        return ()
    return _names(model, history.largest_torque > limits[list(model.independent)])


def _names(model: ImpactModel, chosen: NDArray[np.bool_]) -> tuple[str, ...]:
    names = [model.robot.joint_names[i] for i in model.independent]
    return tuple(name for name, is_chosen in zip(names, chosen, strict=True) if is_chosen)
