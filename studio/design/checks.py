# SPDX-License-Identifier: BSD-3-Clause
"""What the optimiser found, simulated independently: its force, and the speed that is safe."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from softimpact.optimize import Study
from softimpact.simulate import (
    Approach,
    Fidelity,
    ImpactHistory,
    many_peaks,
    simulate_impact,
)
from softimpact.simulate.assessment import force_limits
from softimpact.simulate.band import Band, impact_band
from softimpact.simulate.trust import safe_speeds
from softimpact.symbolic import Motors
from softimpact.symbolic.body.verdict import limits_of
from softimpact.symbolic.robot.rigid import Array

if TYPE_CHECKING:
    from softimpact.optimize import Outcome

AGREED = 0.01
"""Share by which an independent simulation may exceed an optimum's force unsaid."""


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


def doubts(optimum: float, *simulated: float, of: str = "the winner") -> list[str]:
    """Return a line if simulation finds a force larger than an optimum's by over ``AGREED``."""
    largest = max(simulated)
    if largest <= (1 + AGREED) * optimum:
        return []
    return [
        f"simulation finds {largest:.1f} N for {of}, where the optimum has {optimum:.1f} N: "
        "count on the larger; limits, prices and gains rest on the smaller"
    ]


def checks_in_words(of: str, checks: Sequence[Check]) -> str:
    """Return how near simulation comes to the optima, a sentence.

    Args:
        of: what of each design was simulated, with "of"; empty for the design itself.
        checks: of some designs.
    """
    same = max(abs(check.linearised / check.nlp - 1) for check in checks)
    above = max((check.full / check.nlp - 1 for check in checks), key=abs)
    return (
        f"Check of {f'{of} '.lstrip()}all {len(checks)} points: linearised by SUNDIALS within "
        f"{100 * same:.3f} % of the optimum, nonlinear at most {100 * above:+.2f} % from it."
    )


def checked(study: Study, outcome: Outcome) -> Check:
    """Simulate what a search found."""
    linearised, full = (
        simulated(study, outcome.q, outcome.springs, fidelity).peak
        for fidelity in ("linearised", "full")
    )
    return Check(outcome.force, linearised, full)


def simulated(
    study: Study, q: Array, springs: Array, fidelity: Fidelity = "linearised"
) -> ImpactHistory:
    """Simulate a study's impact with a posture [rad] and joint stiffness [N·m/rad].

    Of what the motors may do, the one of the largest peak counts.
    """
    model = study.with_springs(springs)
    approach = Approach(q, study.direction, study.speed)
    lumped = fidelity in ("one_mass", "two_mass")
    found = [
        simulate_impact(
            model, approach, study.contact, fidelity, motors=motors, horizon=study.horizon
        )
        for motors in ((None,) if lumped else study.motors)
    ]
    return max(found, key=lambda history: history.peak)


def safe_speed(study: Study, q: Array, springs: Array) -> float:
    """Return the speed [m/s] up to which peaks keep the limit, whatever the motors may do.

    It is that of ``simulate``: the nonlinear robot is asked, too.
    """
    model = study.with_springs(springs)
    approach = Approach(q, study.direction, study.speed)
    limit = force_limits(limits_of(study.contact.region, study.contact.clamped))
    ends: dict[str, Motors] = {motors.kind: motors for motors in study.motors}
    run = {"horizon": study.horizon}
    found, _ = safe_speeds(model, approach, study.contact, limit, ends, run)
    return min(found.values())


REACTIONS = (0.0, 0.01, 0.02, 0.05)
"""Times for which motors drive on before they are released, to show what they decide [s]; zero is
free motors."""


def peaks_by_reaction(study: Study, q: Array, springs: Array) -> dict[float, float]:
    """Return the largest force [N] for each of ``REACTIONS``, whatever the study's motors do."""
    model = study.with_springs(springs)
    model = model.with_drives(model.drives.without_gains())
    approach = Approach(q, study.direction, study.speed)
    forces = {}
    for time in REACTIONS:
        motors = Motors("driven" if time else "free", time)
        found = many_peaks(
            model, approach, study.contact, [study.speed], motors=motors, horizon=study.horizon
        )
        forces[time] = float(found.peak[0])
    return forces


def peak_band(study: Study, q: Array, springs: Array) -> Band:
    """Return where the largest force [N] lies in 95 of 100 cases, for what is not known exactly."""
    model = study.with_springs(springs)
    limits = limits_of(study.contact.region, study.contact.clamped)
    approach = Approach(q, study.direction, study.speed)
    motors = study.motors
    return impact_band(model, approach, study.contact, motors, limits, horizon=study.horizon).peak
