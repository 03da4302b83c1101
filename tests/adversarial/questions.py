# SPDX-License-Identifier: BSD-3-Clause
"""What packages are asked for that must not exceed a limit, and what they answer."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np
from compiled_impacts import SINGULAR
from compiled_packages import KINDS, Generated
from numpy.typing import NDArray

from softimpact.symbolic.robot.rigid import Array

from .cases import Cases
from .laws import laws

FIELDS = {
    "joint_stiffness": "springs",
    "rotor_inertia": "rotors",
    "position_gain": "gains",
    "damping_gain": "damping_gains",
    "reaction_time": "reaction",
}
"""Fields of a package's parameters that have other names here."""

AT_REST = 1e-3
"""Speed of a contact point that is not looked at [m/s]."""

LEAST = 0.05
"""Force [N] below which none matters: laws by tables are not told further."""

ARGUMENTS = {
    "peak_force": "q n number region params out",
    "safe_speed": "q n number region params out",
    "safe_speed_on": "q frame place n number region params out",
    "speed_factor": "q dq number region params out",
    "allowed_speed_at": "q point n region params out",
    "worst_direction_at": "q point number region params out",
}
"""Of functions that are asked."""


@dataclass(frozen=True)
class Question:
    """What a search asks.

    Attributes:
        function: of the package.
        laws: share of inputs whose contact does not follow Hertz's law.
        slower: how many speeds below the answer are tried.
        climbs: whether inputs are climbed from by their forces at those speeds alone.
        share: of the inputs of a round that take longer than others.
    """

    function: str = "safe_speed"
    laws: float = 0.0
    slower: int = 3
    climbs: bool = False
    share: float = 1.0

    @property
    def presses(self) -> bool:
        """Whether what presses later has a limit, too."""
        return self.function == "allowed_speed_at"

    @property
    def moves(self) -> bool:
        """Whether joint velocities are given and not a direction."""
        return self.function == "speed_factor"

    @property
    def elsewhere(self) -> bool:
        """Whether the contact point is given, too."""
        return self.function == "safe_speed_on"


QUESTIONS = {
    "limit": Question(),
    "slower": Question(slower=24, climbs=True, share=0.25),
    "laws": Question(laws=1.0),
    "pressing": Question("allowed_speed_at", laws=0.3, share=0.1),
    "place": Question("safe_speed_on", laws=0.1),
    "motion": Question("speed_factor", laws=0.1),
    "worst": Question("worst_direction_at", laws=0.1, slower=0, share=0.5),
}
"""By name: forces at safe speeds; at many slower ones; of other laws of contact; what presses after
0.5 s; points given at run time; joint velocities; and the direction in which
a point hits hardest, against any that motors can move it in."""


@dataclass(frozen=True, eq=False)
class Answers:
    """What a package says, one a row.

    Attributes:
        status: of each.
        speed: up to which a force keeps its limit [m/s].
        limit: that it should keep [N].
    """

    status: NDArray[np.int32]
    speed: Array
    limit: Array


def called(
    package: Generated, function: str, cases: Cases, numbers: Array, real: str
) -> tuple[NDArray[np.int32], NDArray[Any]]:
    """Return statuses and results of a function for all rows.

    Args:
        package: that is asked.
        function: without the package's prefix.
        cases: inputs.
        numbers: limits or speeds, where the function takes one.
        real: number type of the build.
    """
    c_real, kind = KINDS[real]
    count, interface = len(cases), package.interface
    shape = function.removesuffix("_at").removesuffix("_on")
    arrays = {
        name: np.ascontiguousarray(getattr(cases, name), kind) for name in ("q", "n", "dq", "place")
    }
    arrays["params"] = _params(package, cases, real)
    arrays["region"], kept = _regions(package, cases, real)
    arrays["out"] = np.zeros(count, interface.dtype(f"{shape}_t", real))
    given: dict[str, list[Any]] = {
        name: (x.ctypes.data + np.arange(count) * x.strides[0]).tolist()
        for name, x in arrays.items()
    }
    given |= {"number": numbers.tolist(), "frame": cases.frame.tolist(), "point": [0] * count}
    names = ARGUMENTS[function].split()
    types: dict[str, Any] = {"number": c_real, "frame": ctypes.c_int, "point": ctypes.c_int}
    entry = package.load(real).library[f"{package.manifest.name}_{function}"]
    entry.argtypes = [types.get(name, ctypes.c_void_p) for name in names]
    rows = zip(*(given[name] for name in names), strict=True)
    status = np.array([entry(*row) for row in rows], np.int32)
    del kept
    return status, arrays["out"]


def _params(package: Generated, cases: Cases, real: str) -> NDArray[Any]:
    p = np.zeros(len(cases), package.interface.dtype("params", real))
    p["layout"] = package.interface.layout_in(real)
    for field in p.dtype.names or ():
        values = getattr(cases, FIELDS.get(field, field), None)
        if values is not None:
            p[field] = values
    return p


def _regions(package: Generated, cases: Cases, real: str) -> tuple[NDArray[Any], Any]:
    """Return structs of regions, and what they point to."""
    region = np.zeros(len(cases), package.interface.dtype("region", real))
    region["stiffness"], region["damping"] = cases.stiffness, cases.damping
    region["effective_mass"] = np.where(cases.mass > 0, cases.mass, 1)
    region["hertz_stiffness"] = cases.skin
    region["clamped"] = cases.mass == 0
    region["force_limit"], region["quasi_static_limit"] = cases.limit, cases.pressing
    tables = [np.ascontiguousarray(law.points, KINDS[real][1]) for law in laws()] if any(
        cases.law) else []  # fmt: skip
    addresses = np.array([0, *(x.ctypes.data for x in tables)], np.uint64)
    sizes = np.array([0, *map(len, tables)], np.int32)
    region["law"], region["law_points"] = addresses[cases.law], sizes[cases.law]
    return region, tables


def answers(
    package: Generated, question: Question, cases: Cases, real: str, moved: Array
) -> Answers:
    """Return what a package answers.

    Args:
        package: that is asked.
        question: what.
        cases: inputs.
        real: number type of the build.
        moved: speed of the contact point at the joint velocities given [m/s].
    """
    function = question.function
    numbers = cases.speed if function == "worst_direction_at" else cases.limit
    status, out = called(package, function, cases, numbers, real)
    if function == "worst_direction_at":
        worst = np.array(out["force"] * (1.0 + out["error"]), float)
        there, _ = called(package, "peak_force", cases, numbers, real)
        reached = np.where(there == SINGULAR, there, status)
        return Answers(reached, cases.speed, np.maximum(worst, LEAST))
    if question.moves:  # of a point at rest nothing is said
        status = np.where(moved > AT_REST, status, SINGULAR)
    speed = out["factor"] * moved if question.moves else out["speed"]
    return Answers(status, np.array(speed, float), cases.limit)
