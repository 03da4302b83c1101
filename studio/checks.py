# SPDX-License-Identifier: BSD-3-Clause
"""What the optimiser found, simulated independently: its force, and the speed that is safe."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from softimpact.optimize import Outcome, Study
from softimpact.simulate import (
    Approach,
    Fidelity,
    ImpactHistory,
    largest_safe_speed,
    simulate_impact,
)
from softimpact.symbolic.robot.rigid import Array


@dataclass(frozen=True, eq=False)
class Check:
    """A peak force [N], as the NLP has it and by independent simulation.

    Attributes:
        nlp: the optimum.
        linearised: the same model, integrated by SUNDIALS.
        full: the nonlinear robot, one rung up the ladder.
    """

    nlp: float
    linearised: float
    full: float


def checked(study: Study, outcome: Outcome) -> Check:
    """Simulate what a search found."""
    linearised, full = (
        simulated(study, outcome.q, outcome.springs, fidelity).first_contact
        for fidelity in ("linearised", "full")
    )
    return Check(outcome.force, linearised, full)


def simulated(
    study: Study, q: Array, springs: Array, fidelity: Fidelity = "linearised"
) -> ImpactHistory:
    """Simulate a study's impact with a posture [rad] and joint stiffness [N·m/rad]."""
    model = study.model.with_springs(ca.DM(springs))
    approach = Approach(q, study.direction, study.speed)
    return simulate_impact(model, approach, study.contact, fidelity)


def safe_speed(study: Study, q: Array, springs: Array) -> float:
    """Return the speed [m/s] at which the peak force is the region's limit."""
    model = study.model.with_springs(ca.DM(springs))
    approach = Approach(q, study.direction, study.speed)
    return largest_safe_speed(model, approach, study.contact, study.contact.region.force_limit)
