# SPDX-License-Identifier: BSD-3-Clause
"""The search for rest in C and its mirror in Python, which measures its errors, part nowhere.

``codegen/verification/configuration.py`` repeats the C function over many samples. Both are asked
on rays of motor angles from home to where the chain comes apart, beside the edge, and far beyond.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from compiled_packages import Generated

from softimpact.codegen.verification.configuration import (
    LONGEST_MOVE,
    MOST_MOVES,
    Configuration,
    rounded_configurations,
)
from softimpact.symbolic.robot.rigid import Array

OK, NO_EQUILIBRIUM = 0, 7
BESIDE = np.r_[-np.logspace(-2, -6, 5), np.logspace(-6, -2, 5)]
"""Distances from an edge [rad]; nearer, digits decide."""


def edge(configuration: Configuration, start: Array, ray: Array) -> float:
    """Return how far along a ray the chain first finds no rest [rad]; 3 if it always does."""
    inside, outside = 0.0, 3.0
    for _ in range(6):
        shares = np.linspace(inside, outside, 41)
        places = start[:, None] + shares * ray[:, None]
        _, good = rounded_configurations(configuration, places, np.float64)
        if good[1:].all():
            return outside
        first = 1 + int(np.argmin(good[1:]))
        inside, outside = shares[first - 1], shares[first]
    return float(outside)


def asked(configuration: Configuration) -> Iterator[Array]:
    start, edges = configuration.home[list(configuration.motors)], 0
    for angle in np.radians([100, 120, 140, 160, 280, 300, 320, 340]):  # motors against each other
        ray = np.array([np.cos(angle), np.sin(angle)])
        limit = edge(configuration, start, ray)
        edges += limit < 3.0
        yield from (start + (limit + away) * ray for away in BESIDE)
        yield from (start + share * limit * ray for share in (0.3, 0.7, 1.5, 2.5))
    assert edges >= 4
    for full_turns in (1, -1):  # the same place, too far for so many moves, and just not
        yield start + full_turns * MOST_MOVES * LONGEST_MOVE * np.array([1.0, 0.0]) * (1 + 1e-6)
        yield start + np.array([0.0, full_turns * 2 * np.pi])


@pytest.mark.slow
@pytest.mark.parametrize("real", ["double", "float"])
def test_both_find_the_same_and_refuse_the_same(
    package: Callable[[str], Generated], real: str
) -> None:
    rmin = package("rmin")
    library = rmin.load(real)
    entry = getattr(library.library, f"{rmin.manifest.name}_configuration")
    kind = np.float64 if real == "double" else np.float32
    x, y, z = rmin.manifest.gravity
    configuration = Configuration(rmin.robot, (x, y, z))
    statuses, tolerance = [], 1e-9 if real == "double" else 2e-3
    inputs = np.array(list(asked(configuration))).T.astype(kind)
    mirrored, good = rounded_configurations(configuration, inputs.astype(float), kind)
    for k, motors in enumerate(inputs.T):
        q = np.full(rmin.robot.n, np.nan, dtype=kind)
        held = np.ascontiguousarray(motors)
        status = entry(ctypes.c_void_p(held.ctypes.data), None, ctypes.c_void_p(q.ctypes.data))
        assert status == (OK if good[k] else NO_EQUILIBRIUM), (k, motors)
        if status == OK:
            assert abs(q - mirrored[:, k]).max() < tolerance
        statuses.append(status)
    assert 30 < statuses.count(OK) < len(statuses) - 20
