# SPDX-License-Identifier: BSD-3-Clause
"""What a generated package says about itself; it depends on nothing but its input."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Literal

from .costs import Costs

GENERATOR = "softimpact.codegen"

MANIFEST = "manifest.json"
"""File name in the package's root."""

Real = Literal["double", "float"]


@dataclass(frozen=True)
class FunctionRecord:
    """Cost and accuracy of one function.

    Attributes:
        name: of the C function.
        flops: additions, multiplications and the like, without checks, sines and cosines.
        sines_and_cosines: how many it takes.
        double_error: in double, not exceeded at 99.9 % of configurations.
        float_error: the same in float. Errors are over the largest entry of an output, or absolute
            for shares of 1.
        float_error_worst: largest error found in float.
    """

    name: str
    flops: int
    sines_and_cosines: int
    double_error: float
    float_error: float
    float_error_worst: float


@dataclass(frozen=True)
class ImpactRecord:
    """Accuracy of peak forces and safe speeds.

    Attributes:
        order: masses of the chain that stands for the robot in them.
        flops: operations that make the chain, before any step in time.
        chain_error_mean: of peak forces against those of the whole linear robot, on average over
            random configurations, directions, parameters, body regions and speeds.
        chain_error_usual: the same, not exceeded by 95 of 100 impacts.
        chain_error_worst: largest found.
        unresolved: share of those impacts that do not end within the steps; errors are the others'.
        double_error: what integration adds, in double.
        float_error: the same in float.
        steps: most steps of an impact.
        trials: most impacts for a safe speed.
    """

    order: int
    flops: int
    chain_error_mean: float
    chain_error_usual: float
    chain_error_worst: float
    unresolved: float
    double_error: float
    float_error: float
    steps: int
    trials: int


@dataclass(frozen=True)
class Manifest:
    """Summary of a package.

    Attributes:
        name: prefix of all its names.
        version: of softimpact.
        model: name of the robot.
        tip: its contact frame.
        digest: hash of the robot's numbers, ``Robot.digest``.
        real: default number type.
        joints: names in the order of q.
        coordinates: number of generalised coordinates.
        gravity: whose curvature enters K0 [m/s²]; zero leaves it out.
        chain_order: masses of the chain.
        parameters: fields of the parameter struct.
        frozen: parameters that are built in, and their numbers.
        floating: whether a function sets the base free.
        functions: all functions.
        poses: names of the built-in candidates of ``select_configuration``, in their order.
        impact: of peak forces and safe speeds, None where the robot has none.
        costs: measured on a Cortex-M, None where they were not.
        files: SHA-256 of each file by path.
    """

    name: str
    version: str
    model: str
    tip: str
    digest: str
    real: Real
    joints: tuple[str, ...]
    coordinates: int
    gravity: tuple[float, float, float]
    chain_order: int
    parameters: tuple[str, ...]
    frozen: Mapping[str, tuple[float, ...]]
    floating: bool
    functions: tuple[FunctionRecord, ...]
    poses: tuple[str, ...]
    impact: ImpactRecord | None
    costs: Costs | None
    files: Mapping[str, str]

    def to_json(self) -> str:
        """Return the text of ``manifest.json``."""
        content = {"generator": GENERATOR, **asdict(self), "files": dict(self.files)}
        return json.dumps(content, indent=2, ensure_ascii=False) + "\n"
