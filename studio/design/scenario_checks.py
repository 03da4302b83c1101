# SPDX-License-Identifier: BSD-3-Clause
"""Scenarios of a machine that was designed for many, simulated independently."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import casadi as ca
import numpy as np

from softimpact.optimize import Study
from softimpact.optimize.evaluation import equipped
from softimpact.optimize.impact.impact_program import hertz_in_series
from softimpact.optimize.machine.hardware import built
from softimpact.optimize.robust.certificate import Worst
from softimpact.optimize.robust.robust import RobustDesign
from softimpact.optimize.study.scenarios import Scenarios
from softimpact.simulate import Approach, Fidelity, simulate_impact
from softimpact.symbolic import Contact, ImpactModel, impact_model, with_load
from softimpact.symbolic.robot.rigid import Array

from .checks import AGREED, Check, doubts

MOST_CHECKED = 4
"""Scenarios of a robust design that are simulated: a quarter of a second each to a second."""


class Designed(Protocol):
    """A machine for scenarios, of a robust design or on a front."""

    @property
    def study(self) -> Study:
        """The problem."""

    @property
    def scenarios(self) -> Scenarios:
        """All impacts that it must bear."""

    @property
    def springs(self) -> Array:
        """Joint stiffness, length n [N·m/rad]."""

    @property
    def others(self) -> Array:
        """Values of the other variables of the hardware."""

    @property
    def postures(self) -> Array:
        """Posture of each pose, P×n [rad]."""

    @property
    def worst(self) -> Worst:
        """The worst scenario."""


@dataclass(frozen=True, eq=False)
class CheckedScenario:
    """A scenario whose force was simulated.

    Attributes:
        index: of the scenario.
        limit: of its force [N].
        check: its force, as the optimiser has it and by simulation.
    """

    index: int
    limit: float
    check: Check

    @property
    def simulated(self) -> float:
        """The larger of both simulated forces over the limit."""
        return max(self.check.linearised, self.check.full) / self.limit


def checked_worst(design: Designed) -> Check:
    """Simulate the worst scenario."""
    return _checked(design, design.worst.index, design.worst.force)


def checked_scenarios(design: RobustDesign) -> tuple[CheckedScenario, ...]:
    """Simulate the worst scenario, and those that are nearly as bad; the worst first.

    Where several are equally bad, as in an optimum they are, another may be the worst one of the
    nonlinear robot.
    """
    scenarios, worst = design.scenarios, design.worst
    limits = {i: scenarios.limit(scenarios[i]) for i in (worst.index, *design.active)}
    shares = dict(zip(design.active, design.shares, strict=True))
    near = [i for i, share in shares.items() if share >= (1 - AGREED) * worst.share]
    others = sorted((i for i in near if i != worst.index), key=lambda i: -shares[i])
    forces = {i: shares[i] * limits[i] for i in others} | {worst.index: worst.force}
    return tuple(
        CheckedScenario(i, limits[i], _checked(design, i, forces[i]))
        for i in (worst.index, *others[: MOST_CHECKED - 1])
    )


def doubts_in_words(design: Designed, checks: Sequence[CheckedScenario]) -> list[str]:
    """Return a line if some scenario is worse by simulation than the worst may be."""
    most = max(checks, key=lambda each: each.simulated)
    allowed = design.worst.share * most.limit
    place = place_in_words(design, most.index)
    return doubts(allowed, most.check.linearised, most.check.full, of=f"the winner ({place})")


def _checked(design: Designed, index: int, force: float) -> Check:
    linearised, full = (_peak(design, index, each) for each in ("linearised", "full"))
    return Check(force, linearised, full)


def _peak(design: Designed, index: int, fidelity: Fidelity) -> float:
    study, scenarios = design.study, design.scenarios
    one = scenarios[index]
    load = scenarios.payloads[one.payload]
    model = designed_model(design)
    robot, point = model.robot, scenarios.points[one.point]
    if load:
        robot = with_load(robot, study.model.tip, load)
    hit = impact_model(robot, point, drives=model.drives)
    speed = scenarios.speeds[one.speed] * _factor(design, index)
    approach = Approach(design.postures[one.pose], scenarios.directions[one.direction], speed)
    motors = scenarios.motors[one.motors]
    contact = _covered(design, scenarios.contacts[one.contact])
    return simulate_impact(
        hit, approach, contact, fidelity, motors=motors, horizon=study.horizon
    ).peak


def _factor(design: Designed, index: int) -> float:
    """Return the factor on the speed of a scenario."""
    factors = design.worst.factors
    if factors is None:
        return 1.0
    return float(factors[index // len(design.scenarios.motors) if factors.size > 1 else 0])


def designed_model(design: Designed) -> ImpactModel:
    """Return the robot with the hardware that was found."""
    study = design.study
    hardware = equipped(study, ca.DM(design.springs), design.others)
    return built(study.with_springs(design.springs), hardware)


def _covered(design: Designed, contact: Contact) -> Contact:
    """Return what is hit as the design's cover makes it."""
    cover = equipped(design.study, ca.DM(design.springs), design.others).cover
    if cover is None:
        return contact
    own = contact.series_stiffness
    return replace(contact, cover=None, hertz_stiffness=float(hertz_in_series(own, ca.DM(cover))))


def scenario_record(design: Designed, index: int) -> dict[str, object]:
    """Return a scenario in words and numbers, as fast as it is."""
    one = design.scenarios[index]
    words = design.scenarios.describe(one)
    speed = design.scenarios.speeds[one.speed] * _factor(design, index)
    return {**words, "speed": speed, "limit": design.scenarios.limit(one)}


def place_in_words(design: Designed, index: int) -> str:
    """Return who is hit where in a scenario, and how fast."""
    words = scenario_record(design, index)
    direction = np.round(np.array(words["direction"], dtype=float), 3).tolist()
    return (
        f"pose {words['pose']}, {words['point']} along {direction} against {words['region']}, "
        f"{words['payload']:g} kg, {words['speed']:.4g} m/s, motors {words['motors']}"
    )
