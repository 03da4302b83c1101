# SPDX-License-Identifier: BSD-3-Clause
"""Peak forces and safe speeds of a package: their chain, its order and their golden results."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from softimpact.symbolic import Robot
from softimpact.symbolic.robot.rigid import Array

from . import impact
from .accuracy import rounded_up
from .approach import directions_of_motion
from .functions import Symbols, coordinates_of, impact_chain_of, linear_model_of
from .impact_error import (
    CASES,
    FINER,
    GAIN,
    Impact,
    chain_forces,
    draw_impacts,
    errors_of_order,
    holds_a_motor,
    linear_forces,
    regular_impacts,
)
from .manifest import FunctionRecord, ImpactRecord
from .source import CSource

LONGEST_CHAIN = 8
"""Most masses of a generated chain; longer ones lose their last masses to rounding."""

GOOD_ENOUGH = 0.01
"""Error of a chain's peak force that 95 of 100 impacts must stay below."""

TOLERABLE = 0.1
"""The same of all of them."""

GOLDEN_IMPACTS = 12
"""Impacts in a package's own test."""

FEWEST = CASES // 4
"""Impacts without which there is too little to state an error of."""

ACCURACY = 1e-3
"""Least bound stated of the integration's error."""


@dataclass(frozen=True, eq=False)
class ImpactSource:
    """What the templates need for ``peak_force`` and ``safe_speed``.

    Attributes:
        robot: the rigid robot.
        chain: the internal function they start from.
        record: their accuracy.
        golden: impacts and the right peak forces [N].
    """

    robot: Robot
    chain: CSource
    record: ImpactRecord
    golden: tuple[tuple[Impact, float], ...]

    @property
    def order(self) -> int:
        """Masses of the chain."""
        return self.record.order

    @property
    def held(self) -> bool | None:
        """Whether a controller holds a motor; None if the parameters at run time tell."""
        (gains,) = [p.frozen for p in self.chain.parameters if p.name == GAIN]
        return None if gains is None else holds_a_motor(self.robot, gains)

    @property
    def motors(self) -> list[int]:
        """Indices of the joints that a controller can hold."""
        return [i for i, actuated in enumerate(self.robot.actuated) if actuated]

    @property
    def peak_force(self) -> str:
        """Prototype without the semicolon."""
        return self._declaration("peak_force", "speed")

    @property
    def safe_speed(self) -> str:
        """Prototype without the semicolon."""
        return self._declaration("safe_speed", "limit")

    @property
    def select_configuration(self) -> str:
        """Prototype without the semicolon."""
        real, joints = f"{self.chain.prefix}_real", self.chain.joints
        table = [f"const {real} poses[][{joints}]", "int count", "const unsigned char *allowed"]
        return self._prototype("select_configuration", "selection", table, "speed")

    def _declaration(self, function: str, number: str) -> str:
        q = f"const {self.chain.prefix}_real q[{self.chain.joints}]"
        return self._prototype(function, function, [q], number)

    def _prototype(self, function: str, result: str, first: list[str], number: str) -> str:
        prefix = self.chain.prefix
        arguments = [
            *first,
            f"const {prefix}_real n[3]",
            f"{prefix}_real {number}",
            f"const {prefix}_region *region",
            *([f"const {prefix}_params *p"] if self.chain.has_struct else []),
            f"{prefix}_{result}_t *out",
        ]
        return f"int {prefix}_{function}(\n    " + ",\n    ".join(arguments) + ")"


def longest_chain(robot: Robot) -> int:
    """Return the most masses that a generated chain of a robot may have."""
    return min(LONGEST_CHAIN, coordinates_of(robot))


def impact_source(prefix: str, symbols: Symbols, order: int | None) -> ImpactSource | None:
    """Return the impacts of a robot.

    None where there are none: if the contact point's directions of motion depend on the
    configuration, or if it arrives at too few random impacts that end within the steps.

    Args:
        prefix: of the C names.
        symbols: of the robot's package.
        order: masses of the chain; None takes the fewest that are good enough.
    """
    robot, parameters = symbols.robot, symbols.parameters
    linear, directions = linear_model_of(symbols), directions_of_motion(symbols.model)
    if linear is None or directions is None:
        return None
    drawn = draw_impacts(robot, parameters, directions, CASES, seed=3)
    impacts = regular_impacts(linear, drawn)
    if len(impacts) < FEWEST:
        return None
    right = linear_forces(linear, impacts)
    masses = order or _fewest_masses(symbols, impacts, right)
    chain = impact_chain_of(symbols, masses)
    assert chain is not None
    forces = chain_forces(chain, symbols, impacts, masses)
    narrow = chain_forces(chain, symbols, impacts, masses, np.float32)
    reference = chain_forces(chain, symbols, impacts, masses, finer=FINER)
    ended = np.isfinite([right, forces, narrow, reference]).all(axis=0)
    if ended.sum() < FEWEST:
        return None
    errors = errors_of_order((forces / right - 1)[ended])
    record = ImpactRecord(
        order=masses,
        flops=chain.flops,
        chain_error_mean=errors[0],
        chain_error_usual=errors[1],
        chain_error_worst=errors[2],
        unresolved=float(f"{1 - ended.mean():.2g}"),
        double_error=_integration_error((forces / reference - 1)[ended]),
        float_error=_integration_error((narrow / reference - 1)[ended]),
        steps=impact.STEPS,
        trials=impact.TRIALS,
    )
    golden = np.flatnonzero(ended)[:GOLDEN_IMPACTS]
    return ImpactSource(
        robot=robot,
        chain=CSource(prefix, robot.n, parameters, chain, _no_record(chain.name)),
        record=record,
        golden=tuple((impacts[k], float(f"{reference[k]:.6g}")) for k in golden),
    )


def _fewest_masses(symbols: Symbols, impacts: Sequence[Impact], right: Array) -> int:
    """Return the order of the shortest chain that is good enough, or of the longest."""
    longest = longest_chain(symbols.robot)
    chain = impact_chain_of(symbols, longest)
    assert chain is not None
    for masses in range(1, longest):
        off = chain_forces(chain, symbols, impacts, masses) / right - 1
        ended = off[np.isfinite(off)]
        if ended.size < FEWEST:
            continue
        _, usual, worst = errors_of_order(ended)
        if usual <= GOOD_ENOUGH and worst <= TOLERABLE:
            return masses
    return longest


def _integration_error(off: Array) -> float:
    return max(ACCURACY, rounded_up(float(abs(off).max())))


def _no_record(name: str) -> FunctionRecord:
    """Return the record of a function whose errors only count in what is made of it."""
    return FunctionRecord(name, 0, 0, 0.0, 0.0, 0.0)
