# SPDX-License-Identifier: BSD-3-Clause
"""Forces of a measured impact, over all that is not known of it.

Rotors, springs, payload, pad and posture are drawn from ranges that were fixed before this
page's bands were computed; what the motors do is stated.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from softimpact.simulate.sampled import SampledImpacts, Samples
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    Motors,
    PowerLaw,
    approach_velocity,
    body_region,
    drives,
    impact_model,
    load_robot,
    two_body,
)
from softimpact.symbolic.impact.two_body import moving_mass
from softimpact.symbolic.robot.rigid import Array

from .setups import Measurement

FLANGE = "flange"

ROTOR_PER_TORQUE = (0.005, 0.03)
"""Reflected rotor inertia over largest torque of a joint [s²], where nothing else is known. In the
arms whose rotors somebody states it is 0.007 to 0.017 (Panda, FR3) and 0.011 to 0.029 (iiwa 14)."""

ESTIMATE = (0.5, 2.0)
"""Factors within which a stated estimate of the rotors may be off."""

WIND_UP = (2e-3, 20e-3)
"""By which a joint gives way under its largest torque [rad]: from a stiff strain-wave gear to one
with a torque sensor and the links' own bending. Assumed: no maker states it."""

PAYLOAD, PAYLOAD_AT = (0.0, 1.0), 0.05
"""Mass of an unknown tool [kg], and its distance before the flange [m]."""

PADS = (0.25, 1.0, 4.0)
"""Factors of the pad's stiffness."""

PERCENT = (2.5, 50.0, 97.5)
"""Of the draws below the band, below its middle, and below its top."""


@dataclass(frozen=True)
class Servo:
    """A servo on each rotor alone.

    Attributes:
        rate: √(K_p/B) [rad/s].
        damping: share of critical damping.
    """

    rate: float
    damping: float = 0.7


@dataclass(frozen=True)
class ForceBand:
    """A force that is known so well only [N]."""

    low: float
    middle: float
    high: float

    def holds(self, force: float) -> bool:
        """Return whether a force lies in the band."""
        return self.low <= force <= self.high


def band(forces: Array) -> ForceBand:
    """Return the band that holds 95 of 100 forces, and their median."""
    return ForceBand(*(float(x) for x in np.percentile(forces, PERCENT)))


def foretold(
    measured: Measurement,
    motors: Motors,
    servo: Servo | None = None,
    *,
    count: int = 240,
    seed: int = 0,
) -> ForceBand:
    """Return the band of the peak force of a measured impact.

    Args:
        measured: the impact.
        motors: what they do.
        servo: its gains, for motors of that kind.
        count: of draws.
        seed: of the random numbers.
    """
    random = np.random.default_rng(seed)
    model, symbols, values = _draws(measured, servo, random, count)
    q = measured.postures(random, count)
    rigid = impact_model(load_robot(measured.robot), FLANGE)
    velocity = np.array([approach_velocity(rigid, at, measured.direction) for at in q])
    direction = np.tile(measured.direction, (count, 1))
    region = body_region(measured.device)
    assert isinstance(region.skin, PowerLaw)
    forces = np.zeros(count)
    for i, factor in enumerate(PADS):
        rows = np.arange(i, count, len(PADS))
        pad = PowerLaw(factor * float(region.skin.stiffness), region.skin.exponent)
        contact = Contact(replace(region, skin=pad))
        at = Samples(q[rows], direction[rows], velocity[rows], values[rows], symbols)
        speeds = np.full(len(rows), measured.speed)
        forces[rows] = SampledImpacts(model, at, contact, motors).peaks(speeds).peak
    return band(forces)


def _draws(
    measured: Measurement, servo: Servo | None, random: np.random.Generator, count: int
) -> tuple[ImpactModel, ca.SX, Array]:
    """Return the robot with symbols for what is drawn: rotors, springs, payload."""
    robot = load_robot(measured.robot)
    n, torque = robot.n, robot.torque_limits
    symbols = ca.SX.sym("unknown", 2 * n + 1)
    rotors, springs, payload = symbols[:n], symbols[n : 2 * n], symbols[-1]
    numbers = drives(robot, joint_stiffness=1.0, rotor_inertia=1.0)
    own = replace(numbers, rotors=rotors, springs=springs)
    if servo is not None:
        gain, damping = servo.rate**2, 2 * servo.damping * servo.rate
        own = replace(own, gains=gain * rotors, damping_gains=damping * rotors)
    held = robot.with_payload(FLANGE, payload, (0.0, 0.0, PAYLOAD_AT))
    if robot.armature.any():
        drawn = robot.armature * _spread(random, ESTIMATE, count)
    else:
        drawn = torque * _spread(random, ROTOR_PER_TORQUE, count)
    stiffness = torque / _spread(random, WIND_UP, count)
    load = random.uniform(*PAYLOAD, (count, 1))
    model = impact_model(held, FLANGE, drives=own)
    return model, symbols, np.hstack([drawn, stiffness, load])


def _spread(random: np.random.Generator, between: Sequence[float], count: int) -> Array:
    """Return numbers whose logarithm is uniform, as a column."""
    low, high = np.log(between)
    return np.exp(random.uniform(low, high, (count, 1)))


def two_body_force(measured: Measurement) -> float:
    """Return the force of ISO/TS 15066's formula, with the device's spring and no payload [N]."""
    mass = moving_mass(load_robot(measured.robot))
    return float(two_body(body_region(measured.device), True, mass).force(measured.speed))
