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
    """What peak forces and safe speeds are of.

    Attributes:
        points: contact points, the package's tip first.
        flops: operations that make masses and Jacobians, before any step in time.
        accuracy: bound of a peak force's error, in double and in float.
        horizon: default time in which forces count [s].
        reaction_time: default time until motors are released [s].
        steps: default budget of steps of a call.
        assumed: what was taken to be so for want of a number, a line each.
        searched: what search for safe speeds that are none there was, and the worst that it found.
    """

    points: tuple[str, ...]
    flops: int
    accuracy: float
    horizon: float
    reaction_time: float
    steps: int
    searched: str = ""
    assumed: tuple[str, ...] = ()


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
