# SPDX-License-Identifier: BSD-3-Clause
"""The band in which the forces of an impact lie, for what is not known exactly."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from softimpact.symbolic import (
    Contact,
    ImpactModel,
    InvalidValue,
    Motors,
    Robot,
    generalised_velocity,
)
from softimpact.symbolic.body.verdict import Limits
from softimpact.symbolic.impact.motors import MotorLaw
from softimpact.symbolic.robot.rigid import Array, Inertia

from .arrival import Approach, Arrival, arrival_of
from .history import HORIZON, PRESSED_UNTIL
from .linear import LinearSystem, given_motion, linear_system, modes
from .stepping import Bodies, LargestForces, ManyPeaks, SteppedStage, at_first_touch, faster, slower
from .tolerances import ErrorFactors, Tolerances, error_factors

SAMPLES = 1000
"""Impacts from which a band is taken."""

COVERED = 0.95
"""Share of the cases that a band holds."""


@dataclass(frozen=True)
class Band:
    """Where 95 of 100 cases lie.

    Attributes:
        low: below it lie 2.5 of 100.
        high: above it lie 2.5 of 100.
    """

    low: float
    high: float

    @staticmethod
    def of(samples: Array) -> Band:
        """Return the band of some samples."""
        tail = (1 - COVERED) / 2
        low, high = np.quantile(samples, [tail, 1 - tail])
        return Band(float(low), float(high))


@dataclass(frozen=True)
class ImpactBand:
    """The bands of an impact, each impact at the worst that its motors may do.

    Attributes:
        peak: of the largest force over all contacts [N].
        pressing: of what presses on a clamped body after 0.5 s [N]; None on one that gives way.
        share: of the verdict: how much of the limit that binds is used.
        samples: how many impacts it is taken from.
    """

    peak: Band
    pressing: Band | None
    share: Band
    samples: int


def impact_band(
    model: ImpactModel,
    approach: Approach,
    contact: Contact,
    ends: Iterable[Motors],
    limits: Limits,
    *,
    tolerances: Tolerances | None = None,
    horizon: float = HORIZON,
    samples: int = SAMPLES,
) -> ImpactBand:
    """Return the bands of an impact of the linearised robot.

    Args:
        model: the robot.
        approach: how it arrives.
        contact: what it hits.
        ends: what the motors may do; of each sample the worse end counts.
        limits: of what is hit.
        tolerances: default ``Tolerances()``.
        horizon: up to which the largest force counts [s].
        samples: how many impacts.

    Raises:
        InvalidValue: as ``varied_peaks`` does.
    """
    found = [
        varied_peaks(
            model,
            approach,
            contact,
            motors=motors,
            tolerances=tolerances,
            horizon=horizon,
            samples=samples,
        )
        for motors in ends
    ]
    peak = np.max([each.peak for each in found], axis=0)
    pressing = np.max([each.pressing for each in found], axis=0)
    share = peak / limits.transient.force
    if limits.quasi_static is not None:
        share = np.maximum(share, pressing / limits.quasi_static.force)
    late = Band.of(pressing) if contact.clamped else None
    return ImpactBand(Band.of(peak), late, Band.of(share), samples)


def varied_peaks(
    model: ImpactModel,
    approach: Approach,
    contact: Contact,
    *,
    motors: Motors,
    tolerances: Tolerances | None = None,
    horizon: float = HORIZON,
    samples: int = SAMPLES,
) -> ManyPeaks:
    """Return the peaks of one linearised impact with numbers that vary within tolerances.

    Gravity's and the file's springs' share in the stiffness, and the joints' own damping, do not
    vary: their effect on a peak is below 0.1 % and a few per cent (findings in the docs).

    Args:
        model: the robot.
        approach: how it arrives.
        contact: what it hits.
        motors: what they do; not held.
        tolerances: default ``Tolerances()``.
        horizon: up to which the largest force counts [s].
        samples: how many impacts.

    Raises:
        InvalidValue: fewer than 40 samples, which hold no band of 95 %.
    """
    if samples < 40:
        raise InvalidValue("samples", f"must be at least 40 for a band of 95 %, not {samples}")
    arrival = arrival_of(model, approach)
    before = generalised_velocity(model, arrival.link_velocity)
    varied = error_factors(tolerances or Tolerances(), model.robot.n, samples)
    bodies = _bodies(contact, varied)
    until = max(horizon, PRESSED_UNTIL) if contact.clamped else horizon
    largest = LargestForces(samples, horizon, contact.clamped)
    state = at_first_touch(samples, model.size, bodies)
    v = np.full(samples, arrival.speed)
    links = _mass_of_each_link(model, arrival)
    later = motors.reaction_time * (varied.reaction_time - 1) if len(motors.laws) > 1 else 0.0
    begins = [np.full(samples, time) + (later if time else 0.0) for time, _ in motors.laws]
    ends = [np.minimum(end, until) for end in [*begins[1:], np.full(samples, until)]]
    for (_, law), begin, end in zip(motors.laws, begins, ends, strict=True):
        if not (end > begin).any():
            continue
        system = _varied(model, linear_system(model, arrival, law), law, links, varied, arrival)
        found = modes(system)
        stage = SteppedStage.of(system, found, bodies, np.minimum(begin, until), end)
        given = given_motion(
            system, found, law, slower(state.motion, v), before, begin, motors.stopping_time
        )
        state = stage.run(*faster(*given, v), state, largest)
    return largest.found


def _bodies(contact: Contact, varied: ErrorFactors) -> Bodies:
    region = contact.region
    regions = [
        replace(region, stiffness=region.stiffness * k, damping=region.damping * c)
        for k, c in zip(varied.body, varied.damping, strict=True)
    ]
    return Bodies.of(regions, contact.clamped, contact.law, varied.law)


def _mass_of_each_link(model: ImpactModel, arrival: Arrival) -> Array:
    """Return what each link adds to the mass matrix over the independent joints, n×m×m."""
    found = [replace(model, robot=alone).mass_matrix(arrival.q) for alone in _links(model.robot)]
    return np.array([np.array(M, dtype=float) for M in found])


@lru_cache(maxsize=8)
def _links(robot: Robot) -> tuple[Robot, ...]:
    """Return the robot with one of its links at a time, the same ones for the same robot.

    Their expressions are then derived once.
    """
    massless = [replace(joint, inertia=Inertia.zero()) for joint in robot.joints]
    return tuple(
        replace(robot, joints=(*massless[:i], own, *massless[i + 1 :]), payload=None)
        for i, own in enumerate(robot.joints)
    )


def _varied(
    model: ImpactModel,
    system: LinearSystem,
    law: MotorLaw,
    links: Array,
    varied: ErrorFactors,
    arrival: Arrival,
) -> LinearSystem:
    """Return a system in many versions: M0, K0 and D are linear in what varies."""
    M, K, D, J = system.whole
    n = len(model.elastic)
    independent = list(model.independent)
    E = [i for i, is_elastic in enumerate(model.elastic) if is_elastic]
    angles = np.hstack([np.eye(n), np.eye(n)[:, E]])  # link angles over motors and deflections
    M = M + np.einsum("sk,kij->sij", varied.links - 1, angles.T @ links @ angles)
    K = np.repeat(K[None], len(M), axis=0)
    D = np.repeat(D[None], len(M), axis=0)
    rotors = np.array(model.drives.rotors, dtype=float).ravel()[independent]
    motor, spring = np.arange(n), n + np.arange(len(E))
    M[:, motor, motor] += (varied.rotors[:, independent] - 1) * rotors
    k_s = np.array(model.drives.springs, dtype=float).ravel()[independent][E]
    K[:, spring, spring] += (varied.springs[:, independent][:, E] - 1) * k_s
    if law == "servo":
        K_p = np.array(model.position_gains(arrival.q), dtype=float)
        K[:, :n, :n] += (varied.position_gains - 1)[:, None, None] * K_p
        K_d = model.drives.damping_gains
        rates = np.zeros(n) if K_d is None else np.array(K_d, dtype=float).ravel()[independent]
        D[:, motor, motor] += (varied.damping_gains - 1)[:, None] * rates
    F = system.moving
    block = np.ix_(range(len(M)), F, F)
    return replace(
        system,
        mass=M[block],
        stiffness=K[block],
        damping=None if system.damping is None else D[block],
        whole=(M, K, D, J),
    )
