# SPDX-License-Identifier: BSD-3-Clause
"""How long the impacts of a study last, and how finely they must be stepped."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from softimpact.symbolic import InvalidValue
from softimpact.symbolic.robot.rigid import Array

from .nlp import build_nlp, parameters
from .study import Study

SHORTEST, LONGEST = 0.02, 0.64
"""Durations tried [s]."""

MARGIN = 1.5
"""Duration simulated, as a multiple of the longest first contact among the candidates."""

LARGEST_PHASE = 1.5
"""Largest angular frequency times the step; the leapfrog is stable below 2."""


NODES = 150
"""Fewest times at which the force bounds the peak from below (there are less than twice as many);
between them the force exceeds that bound by some 0.01 %."""

MOST_STEPS = 4500
"""Time steps beyond which compiling and running the impact would take minutes."""


@dataclass(frozen=True)
class Timing:
    """Time steps of the simulated impacts.

    Attributes:
        duration: simulated [s].
        nodes: times, evenly spaced up to the duration, at which the force is taken.
        substeps: time steps from node to node.
    """

    duration: float
    nodes: int
    substeps: int

    @property
    def steps(self) -> int:
        """Number of time steps."""
        return self.nodes * self.substeps

    @property
    def step(self) -> float:
        """Time step [s]."""
        return self.duration / self.steps


def impact_timing(study: Study, postures: Sequence[Array]) -> Timing:
    """Return a duration that holds every first contact, and steps that resolve the robot.

    Contacts are tried with the softest, the nominal and the stiffest springs; frequencies with the
    stiffest.

    Raises:
        InvalidValue: the stiffest springs are so stiff that an impact needs too many steps.
    """
    frequency = max(_largest_frequency(study, q) for q in postures)
    duration = SHORTEST
    while True:
        timing = _timing(study, duration, frequency)
        longest = _longest_contact(study, postures, timing)
        if longest is not None or duration >= LONGEST:
            break
        duration *= 2.0
    wanted = min(LONGEST, MARGIN * (duration if longest is None else float(longest)))
    return _timing(study, wanted, frequency)


def _timing(study: Study, duration: float, frequency: float) -> Timing:
    steps = max(NODES, int(np.ceil(duration * frequency / LARGEST_PHASE)))
    if steps > MOST_STEPS:
        raise InvalidValue(
            f"{study.source}: stiffness.upper",
            f"joints that stiff vibrate so fast that {duration:g} s of impact need {steps} time "
            f"steps, more than {MOST_STEPS}; lower the bound or raise robot.rotor_inertia",
        )
    substeps = steps // NODES
    return Timing(duration, int(np.ceil(steps / substeps)), substeps)


def _largest_frequency(study: Study, q: Array) -> float:
    linear = study.model.with_springs(study.upper).linear(q, study.direction)
    mass, stiffness = np.array(linear.mass.matrix), np.array(linear.stiffness)
    return float(np.sqrt(np.abs(np.linalg.eigvals(np.linalg.solve(mass, stiffness))).max()))


def _longest_contact(study: Study, postures: Sequence[Array], timing: Timing) -> float | None:
    """Longest first contact [s]; None if one of them outlasts the duration."""
    nlp = build_nlp(study.model, len(study.forces), timing.nodes, timing.substeps)
    numbers = parameters(study, np.zeros(3), np.eye(3), timing.step, 1.0)
    longest = 0.0
    for q in postures:
        for springs in (study.lower, study.nominal, study.upper):
            x = np.concatenate([q, np.log10(springs), [0.0]])
            force = np.array(nlp.oracle(x, numbers)[1])[nlp.forces].ravel()
            if force[-1] > 0.0:
                return None
            longest = max(longest, timing.duration * np.count_nonzero(force) / timing.nodes)
    return longest
