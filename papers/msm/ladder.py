# SPDX-License-Identifier: BSD-3-Clause
"""The models of a robot, from one mass to the nonlinear robot with its controller."""

from __future__ import annotations

from dataclasses import dataclass

from softimpact.simulate import (
    Controller,
    ControllerReference,
    Fidelity,
    ImpactHistory,
    PeakDefinition,
    simulate_impact,
)
from softimpact.symbolic import Contact, Motors, body_region

from .scenarios import PaperScenario

REGIONS = ("head", "chest")
CHAIN_ORDER = 3

DEFINITIONS: tuple[PeakDefinition, ...] = ("first_contact", "first_peak")
"""Peaks that the paper may mean."""


@dataclass(frozen=True)
class Rung:
    """A model of the robot.

    Attributes:
        title: for people.
        fidelity: as in ``simulate_impact``.
        reference: of the controller's motors; None: no controller, K_p holds the motors.
    """

    title: str
    fidelity: Fidelity
    reference: ControllerReference | None = None


LADDER = {
    "one_mass": Rung("one mass m_c", "one_mass"),
    "two_mass": Rung("two masses (paper)", "two_mass"),
    "chain": Rung("chain of 3, K_p held", "chain"),
    "linearised": Rung("linearised, K_p held", "linearised"),
    "chain_controlled": Rung("chain of 3, controller", "chain", "moving"),
    "linearised_controlled": Rung("linearised, controller", "linearised", "moving"),
    "full_uncontrolled": Rung("full, K_p held", "full"),
    "full_held": Rung("full, controller, reference held", "full", "held"),
    "full": Rung("full, controller", "full", "moving"),
}
"""All models by name; the last is what the others are held against."""


def motors_on(scenario: PaperScenario, step: Rung) -> Motors | Controller | None:
    """Return what the motors do on a rung; K_p holds them where the paper's Eq. 5 does."""
    if step.reference is not None:
        return scenario.arm.controller(step.reference)
    return None if step.fidelity in ("one_mass", "two_mass") else Motors("held")


def impact_at(
    scenario: PaperScenario,
    rung: str,
    stiffness: float,
    region: str,
    speed: float = 1.0,
    horizon: float | None = None,
) -> ImpactHistory:
    """Simulate a scenario with a model of the ladder.

    Args:
        scenario: of the paper.
        rung: name in ``LADDER``.
        stiffness: k_s [N·m/rad].
        region: of the body.
        speed: of the contact point [m/s].
        horizon: as in ``simulate_impact``; None ends with the first contact.
    """
    step = LADDER[rung]
    model, approach = scenario.at(stiffness, speed)
    return simulate_impact(
        model,
        approach,
        Contact(body_region(region)),
        step.fidelity,
        order=CHAIN_ORDER,
        motors=motors_on(scenario, step),
        horizon=horizon,
        pressing=False,
    )
