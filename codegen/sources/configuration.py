# SPDX-License-Identifier: BSD-3-Clause
"""The solver of a closed chain's equilibrium as the templates show it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from softimpact.symbolic import NoEquilibrium

from ..expressions.printer import Statements, print_graph
from ..inputs.samples import Sample
from ..record.manifest import FunctionRecord
from ..verification.accuracy import DOUBLE_ERROR, MARGIN, SHARE_STATED, rounded_up
from ..verification.configuration import (
    LAST_STEP,
    LONGEST_MOVE,
    LONGEST_STEP,
    MOST_MOVES,
    NEWTON_STEPS,
    Configuration,
    golden_configuration,
    rounded_configurations,
)


@dataclass(frozen=True, eq=False)
class ConfigurationSource:
    """The function that finds joint coordinates from motor angles, in C.

    Attributes:
        prefix: of the package's names.
        configuration: its equations.
        record: its cost, for one Newton step, and accuracy.
        cases: golden motor angles and joint coordinates.
    """

    prefix: str
    configuration: Configuration
    record: FunctionRecord
    cases: tuple[tuple[list[float], list[float]], ...]

    newton_steps = NEWTON_STEPS
    move = LONGEST_MOVE
    moves = MOST_MOVES
    farthest = LONGEST_STEP
    last_step_double = LAST_STEP[np.float64]
    last_step_float = LAST_STEP[np.float32]

    @property
    def name(self) -> str:
        """Full name."""
        return f"{self.prefix}_configuration"

    @property
    def home(self) -> list[float]:
        """A closed configuration."""
        return [float(x) for x in self.configuration.home]

    @property
    def motor_names(self) -> list[str]:
        """Names of the joints with motors."""
        return [self.configuration.robot.joint_names[i] for i in self.configuration.motors]

    @cached_property
    def equations(self) -> Statements:
        """Residuals, and their derivatives column by column."""
        found, n = self.configuration, self.configuration.robot.n
        size = found.unknowns
        inputs = [[f"q[{i}]" for i in range(n)], [f"force[{i}]" for i in range(found.forces)]]
        matrix = [f"d{i + 1}_{j + 1}" for j in range(size) for i in range(size)]
        names = [[f"r{i + 1}" for i in range(size)], matrix]
        return print_graph(found.equations, inputs, names, self.prefix, angles=0)

    @property
    def assignments(self) -> list[str]:
        """Statements that write them."""
        residual, matrix = self.equations.results
        size = self.configuration.unknowns
        lines = [f"residual[{i}] = {text};" for i, text in enumerate(residual)]
        places = [(i, j) for j in range(size) for i in range(size)]
        return lines + [
            f"matrix[{i}][{j}] = {text};" for (i, j), text in zip(places, matrix, strict=True)
        ]

    @cached_property
    def checks(self) -> Statements:
        """Numbers that must be positive."""
        inputs = [[f"q[{i}]" for i in range(self.configuration.robot.n)]]
        count = len(self.configuration.checks.results[0])
        names = [[f"check{i + 1}" for i in range(count)]]
        return print_graph(self.configuration.checks, inputs, names, self.prefix, angles=0)


def configuration_source(
    prefix: str, configuration: Configuration, golden: Sequence[Sample], measured: Sequence[Sample]
) -> ConfigurationSource:
    """Return the solver with golden cases and measured errors.

    Args:
        prefix: of the package's names.
        configuration: equations of a closed chain.
        golden: samples whose motor angles become the golden cases.
        measured: samples whose motor angles the float error is measured at.

    Raises:
        NoEquilibrium: nowhere near home do springs and gravity balance stably.
    """
    motors = list(configuration.motors)
    cases = []
    for sample in golden:
        angles = [sample.q[i] for i in motors]
        q = golden_configuration(configuration, angles)
        if q is not None:
            cases.append((angles, q.tolist()))
    columns = np.array([sample.q for sample in measured]).T[motors]
    wide, found = rounded_configurations(configuration, columns, np.float64)
    narrow, still_found = rounded_configurations(configuration, columns, np.float32)
    both = found & still_found
    if not cases or not both.any():
        raise NoEquilibrium(
            configuration.imbalance,
            "none at any motor angles near home; raise the springs' stiffness or change gravity",
        )
    errors = np.sort(abs(narrow - wide)[:, both].max(axis=0) / abs(wide)[:, both].max(axis=0))
    record = FunctionRecord(
        name=f"{prefix}_configuration",
        flops=configuration.flops,
        sines_and_cosines=configuration.sines_and_cosines,
        double_error=DOUBLE_ERROR,
        float_error=rounded_up(MARGIN * float(errors[int(SHARE_STATED * (errors.size - 1))])),
        float_error_worst=rounded_up(float(errors[-1])),
    )
    return ConfigurationSource(prefix, configuration, record, tuple(cases))
