# SPDX-License-Identifier: BSD-3-Clause
"""Sine and cosine of float builds."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np
import pytest
from compiled_packages import Generated
from numpy.typing import NDArray

from softimpact.codegen.sine import ERROR, LIMIT, sine_and_cosine

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
    entry = package("rr").load("float").library.rr_sines_cosines
    array = ctypes.POINTER(ctypes.c_float)
    entry.argtypes = [array, ctypes.c_int, array, array]

    def call(x: Angles) -> Angles:
        both = np.zeros((2, x.size), dtype=np.float32)
        angles, sines, cosines = (values.ctypes.data_as(array) for values in (x, *both))
        entry(angles, x.size, sines, cosines)
        return both

    return call


def test_c_computes_the_same_to_the_last_bit(in_c: Callable[[Angles], Angles]) -> None:
    np.testing.assert_array_equal(in_c(ANGLES), np.array(sine_and_cosine(ANGLES)))


@pytest.mark.parametrize("angle", [LIMIT, -1e4, 3.4e38])
def test_large_angles_go_to_the_library(in_c: Callable[[Angles], Angles], angle: float) -> None:
    x = np.array([0.5, angle, -1.0], dtype=np.float32)
    np.testing.assert_allclose(in_c(x), [np.sin(x, dtype=float), np.cos(x, dtype=float)], atol=1e-7)
