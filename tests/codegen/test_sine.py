# SPDX-License-Identifier: BSD-3-Clause
"""Sine and cosine, in float to the last bit as Python has them, in double against NumPy's."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from compiled_packages import Generated
from numpy.typing import NDArray

from softimpact.codegen.expressions import wide_sine
from softimpact.codegen.expressions.sine import ERROR, LIMIT, TURN, sine_and_cosine

Angles = NDArray[np.float32]

ANGLES = np.concatenate(
    [np.linspace(-LIMIT, LIMIT, 40001)[1:-1], np.arange(-120, 121) * np.pi / 2, [0.0, 1e-30]]
).astype(np.float32)


def test_error_is_within_its_bound() -> None:
    sine, cosine = sine_and_cosine(ANGLES)
    assert sine.dtype == cosine.dtype == np.float32
    exact = ANGLES.astype(float)
    error = max(abs(sine - np.sin(exact)).max(), abs(cosine - np.cos(exact)).max())
    assert ERROR / 2 < error < ERROR


@pytest.fixture(name="in_c")
def _in_c(package: Callable[[str], Generated]) -> Callable[[Angles], Angles]:
    return entry_of(package, "float", ctypes.c_float)


def entry_of(package: Callable[[str], Generated], real: str, kind: Any) -> Callable[[Any], Any]:
    entry = package("rr").load(real).library.rr_sines_cosines
    array = ctypes.POINTER(kind)
    entry.argtypes = [array, ctypes.c_int, array, array]

    def call(x: NDArray[Any]) -> NDArray[Any]:
        both = np.zeros((2, x.size), dtype=x.dtype)
        angles, sines, cosines = (values.ctypes.data_as(array) for values in (x, *both))
        entry(angles, x.size, sines, cosines)
        return both

    return call


def test_c_computes_the_same_to_the_last_bit(in_c: Callable[[Angles], Angles]) -> None:
    np.testing.assert_array_equal(in_c(ANGLES), np.array(sine_and_cosine(ANGLES)))


@pytest.mark.parametrize("angle", [LIMIT, -1e4, 5e7, 3.4e38])
def test_large_angles_are_within_half_a_unit_in_their_last_place(
    in_c: Callable[[Angles], Angles], angle: float
) -> None:
    x = np.array([0.5, angle, -1.0], dtype=np.float32)
    turn = float(np.float32(TURN))
    assert abs(turn / math.tau - 1) < np.finfo(np.float32).eps / 4  # as much as x is off, in turns
    rest = np.fmod(x.astype(float), turn)
    rest[1] = rest[1] if np.spacing(abs(x[1])) < 8 else 0.0  # half of it is more than half a turn
    np.testing.assert_allclose(in_c(x), [np.sin(rest), np.cos(rest)], rtol=0, atol=ERROR)


def test_what_is_not_finite_has_no_sine(in_c: Callable[[Angles], Angles]) -> None:
    found = in_c(np.array([np.inf, 0.5, np.nan, -np.inf], dtype=np.float32))
    np.testing.assert_array_equal(np.isnan(found), [[True, False, True, True]] * 2)


def test_double_is_within_its_bound(package: Callable[[str], Generated]) -> None:
    in_c = entry_of(package, "double", ctypes.c_double)
    turns = np.arange(-63000, 63001, 7) * np.pi / 2
    x = np.concatenate([np.linspace(-7, 7, 40001), turns, turns + 0.3, [0.0, 1e-300, 99999.0]])
    found, right = in_c(x), np.array([np.sin(x), np.cos(x)])
    assert abs(found - right).max() < wide_sine.ERROR
    far = np.array([0.5, wide_sine.LIMIT, -1e9, 1e300])
    rest = np.fmod(far, wide_sine.TURN)
    rest[-1] = 0.0  # half a unit in its last place is more than half a turn
    np.testing.assert_allclose(
        in_c(far), [np.sin(rest), np.cos(rest)], rtol=0, atol=wide_sine.ERROR
    )
