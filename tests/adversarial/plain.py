# SPDX-License-Identifier: BSD-3-Clause
"""Right forces by Runge and Kutta's method in short steps, as equations are written down.

With neither modes nor matrices' exponentials: what the search's own integrator is held against.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Sequence

import numpy as np
from compiled_impacts import DRIVEN, FREE, FREE_OR_DRIVEN

from softimpact.symbolic.robot.rigid import Array

from .cases import Cases
from .impacts import Robot, library

LONGEST, SHORTEST = 5e-6, 2e-7
"""Steps [s]."""


def plain_forces(robot: Robot, cases: Cases, speeds: Array, coarse: float = 1.0) -> Array:
    """Return the largest force [N] of each case at one speed of its own.

    Only for elastic joints, bodies by Hertz's law and the package's own point.

    Args:
        robot: that hits.
        cases: impacts.
        speeds: of each [m/s].
        coarse: factor on steps; at 8 errors are still below 1e-4.
    """
    entry = library(robot.folder, "plain", "plain").largest_force
    entry.restype = ctypes.c_double
    M, _, J = robot.links(cases)
    found = np.zeros(len(cases))
    for k, speed in enumerate(speeds):
        n = cases.n[k] / np.linalg.norm(cases.n[k])
        row, inverse = n @ J[k], np.linalg.inv(M[k])
        rates = np.linalg.pinv(J[k], rcond=1e-9) @ n
        given = [inverse, row, rates, *(getattr(cases, name)[k] for name in DRIVES)]
        kind = int(cases.motors[k])
        for motors in (FREE, DRIVEN) if kind == FREE_OR_DRIVEN else (kind,):
            numbers = [speed, *(getattr(cases, name)[k] for name in NUMBERS)]
            impact = _impact(robot.n, motors, given, [*numbers, _step(cases, k, inverse, coarse)])
            found[k] = max(found[k], entry(ctypes.byref(impact)))
    return found


DRIVES = ("springs", "rotors", "gains", "damping_gains")
NUMBERS = ("stiffness", "damping", "mass", "skin", "reaction", "horizon")
"""Of what ``plain.c`` reads, in its order."""


def _step(cases: Cases, k: int, inverse: Array, coarse: float) -> float:
    """Return the step [s] that joints, damper and skin allow."""
    root = np.sqrt(cases.springs[k])
    fastest = math.sqrt(float(np.linalg.eigvalsh(root[:, None] * inverse * root).max()))
    step = min(LONGEST * max(1.0, coarse / 2), 0.3 / fastest)
    if cases.damping[k] > 0:
        skin = 1.5 * (cases.skin[k] ** 2 * 3 * cases.limit[k]) ** (1 / 3)
        step = min(step, 0.7 * cases.damping[k] / (cases.stiffness[k] + skin))
    return max(min(coarse, 2.0) * step, SHORTEST)


def _impact(n: int, motors: int, arrays: Sequence[Array], numbers: Sequence[float]) -> _Impact:
    kept = [np.ascontiguousarray(x, dtype=float) for x in arrays]
    pointers = [x.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for x in kept]
    impact = _Impact(n, motors, *pointers, *map(float, numbers))
    impact.kept = kept
    return impact


class _Impact(ctypes.Structure):
    _fields_ = [
        ("n", ctypes.c_int),
        ("motors", ctypes.c_int),
        *((name, ctypes.POINTER(ctypes.c_double)) for name in ("inverse", "row", "rates", *DRIVES)),
        *((name, ctypes.c_double) for name in ("speed", *NUMBERS, "step")),
    ]  # fmt: skip
    kept: Sequence[Array]
