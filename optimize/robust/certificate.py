# SPDX-License-Identifier: BSD-3-Clause
"""All scenarios and all bounds under some hardware, by evaluation."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np

from softimpact.symbolic.robot.rigid import Array, Indices

from ..evaluation import Kept, kept_in_all
from ..impact.timing import Timing
from ..running.workers import Progress, as_completed
from ..search.ipopt import VariableBounds, felt
from ..search.nlp import Program
from ..study.scenarios import Scenarios
from ..study.study import Study
from .screening import SCENARIOS_IN_A_JOB, Screened, Screening, forces_at, screen

SECANTS = 8
"""Most screenings for the greatest safe speed of given hardware."""

SAFE_SPEED_ERROR = 1e-4
"""Share of the limit to which a safe speed is found."""

FIRST_SCENARIO = np.zeros(1, dtype=np.int64)
"""Number of a single scenario."""


@dataclass(frozen=True, eq=False)
class Hardening:
    """Hardware with the postures in which it meets people.

    Attributes:
        v: log10 of all values of the hardware.
        postures: of each pose, P×n [rad].
        factors: on the speed of all scenarios, or of each; None where speeds stay.
    """

    v: Array
    postures: Array
    factors: Array | None = None


@dataclass(frozen=True, eq=False)
class Worst:
    """The worst scenario under some hardware.

    Attributes:
        index: of the scenario.
        force: its largest peak [N].
        share: of the force over its limit.
        deflection: largest over all poses [m].
        value: of the study's objective, in its unit.
        factors: on the speed of all scenarios, or of each, where the objective changes them.
        bounds: how well each is kept, where it is kept worst.
    """

    index: int
    force: float
    share: float
    deflection: float
    value: float
    factors: Array | None
    bounds: tuple[Kept, ...]

    @property
    def keeps(self) -> bool:
        """Whether all bounds are kept."""
        return not any(each.broken for each in self.bounds)


@dataclass(frozen=True, eq=False)
class Setting:
    """What all exchanges of a robust design share."""

    study: Study
    scenarios: Scenarios
    program: Program
    timing: Timing
    limits: VariableBounds
    pool: Executor
    say: Progress

    @property
    def given(self) -> Array:
        """Postures as given, P×n [rad]."""
        return np.array([pose.q for pose in self.scenarios.poses])

    @property
    def numbers(self) -> Indices:
        """Number of each impact's scenario."""
        return np.arange(len(self.scenarios)) // len(self.scenarios.motors)

    def speeds(self) -> Array:
        """Return the speed of each impact as the study has it [m/s]."""
        places = self.scenarios.at(0, len(self.scenarios))
        return np.array(self.scenarios.speeds)[places[:, 5]]

    def worst(self, at: Hardening) -> tuple[Worst, list[Screened]]:
        """Screen all scenarios; return the worst, and the worst of each piece, worst first."""
        objective = self.study.objective
        if objective.all_scenarios:
            return self._of_all(at)
        if objective.scales_speed and at.factors is None:
            return self._at_safe_speed(at)
        found = self._screened(at)
        own = np.array([found[0].share]) if at.factors is None else np.log10(at.factors)
        value = objective.value(own, FIRST_SCENARIO, np.ones(1))
        return self._as_worst(at, found[0], value), found

    def _as_worst(self, at: Hardening, first: Screened, value: float) -> Worst:
        bounds = self.kept(at)
        return Worst(
            first.index, first.force, first.share, bounds[0].figure, value, at.factors, bounds
        )

    def _screened(self, at: Hardening) -> list[Screened]:
        count = len(self.scenarios)
        every = self._screening(at)
        jobs = [
            self.pool.submit(screen, every, begin, min(begin + SCENARIOS_IN_A_JOB, count))
            for begin in range(0, count, SCENARIOS_IN_A_JOB)
        ]
        found: list[Screened] = []
        for i, job in enumerate(as_completed(jobs)):
            found += job.result()
            self.say("screening", i + 1, len(jobs))
        return sorted(found, key=lambda screened: -screened.share)

    def _screening(self, at: Hardening) -> Screening:
        y, step = felt(self.program, at.v), self.timing.step
        return Screening(self.program, self.scenarios, at.postures, y, at.factors, step)

    def _at_safe_speed(self, at: Hardening) -> tuple[Worst, list[Screened]]:
        """Find the factor on all speeds with which the worst force is its limit."""
        ends = self.study.objective.own(
            FIRST_SCENARIO, np.ones(1), np.array([max(self.scenarios.speeds)])
        )
        nearest = 1.0
        for _ in range(SECANTS):
            factor = nearest  # what is told was screened, also where the secants do not end
            at = replace(at, factors=np.array([factor]))
            found = self._screened(at)
            nearest = float(np.clip(factor / found[0].share, *10 ** np.r_[ends.lower, ends.upper]))
            if abs(found[0].share - 1) < SAFE_SPEED_ERROR or nearest == factor:
                break
        return self._as_worst(at, found[0], factor), found

    def _of_all(self, at: Hardening) -> tuple[Worst, list[Screened]]:
        """Evaluate an objective over every scenario."""
        value, factors, shares = self.value(at)
        i = int(np.argmax(shares))
        limit = self.scenarios.limit(self.scenarios[i])
        first = Screened(i, float(shares[i]), float(shares[i] * limit))
        return self._as_worst(replace(at, factors=factors), first, value), [first]

    def value(self, at: Hardening) -> tuple[float, Array | None, Array]:
        """Evaluate the objective over every scenario, here.

        Returns:
            its value; the factors on the speeds, each as large as limits allow unless they are
            given; the share of its limit that each impact reaches then.
        """
        objective, numbers, speeds = self.study.objective, self.numbers, self.speeds()
        if not objective.scales_speed:
            shares = self._shares(at)
            own = objective.own(numbers, shares, speeds).start
            return objective.value(own, numbers, speeds), None, shares
        factors, seek = at.factors, at.factors is None
        if factors is None:
            factors = 10 ** objective.own(numbers, np.ones(numbers.size), speeds).start
        nearer = factors
        for _ in range(SECANTS if seek else 1):
            factors = nearer
            shares = self._shares(replace(at, factors=factors))
            effective = shares / (factors if factors.size == 1 else factors[numbers])
            nearer = 10 ** objective.own(numbers, effective, speeds).start
            if not seek or np.allclose(nearer, factors, rtol=SAFE_SPEED_ERROR):
                break
        return objective.value(np.log10(factors), numbers, speeds), factors, shares

    def _shares(self, at: Hardening) -> Array:
        count = len(self.scenarios)
        forces = forces_at(self._screening(at), 0, count)
        limits = [self.scenarios.limit(self.scenarios[i]) for i in range(count)]
        return np.asarray(forces / np.array(limits))

    def kept(self, at: Hardening) -> tuple[Kept, ...]:
        """Return how well each bound is kept, in the pose where it is kept worst."""
        columns = zip(*self._each(at), strict=True)
        return tuple(max(column, key=lambda k: k.share) for column in columns)

    def shares_of_bounds(self, at: Hardening) -> Array:
        """Return the largest share of a limit that any bound uses in each pose, P."""
        return np.array([max(k.share for k in row) for row in self._each(at)])

    def _each(self, at: Hardening) -> list[list[Kept]]:
        return kept_in_all(self.study, at.postures, *self.limits.parted(at.v))
