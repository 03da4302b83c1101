# SPDX-License-Identifier: BSD-3-Clause
"""Sine and cosine of float builds."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np
import pytest
from compiled_packages import Generated

from softimpact.codegen.sine import ERROR, LIMIT, sine_and_cosine

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
def _in_c(package: Callable[[str], Generated]) -> Callable[[float], tuple[float, float]]:
    entry = package("rr").load("float").library.rr_sine_cosine
    entry.argtypes = [ctypes.c_float, *[ctypes.POINTER(ctypes.c_float)] * 2]

    def call(x: float) -> tuple[float, float]:
        s, c = ctypes.c_float(), ctypes.c_float()
        entry(x, s, c)
        return s.value, c.value

    return call


def test_c_computes_the_same_to_the_last_bit(in_c: Callable[[float], tuple[float, float]]) -> None:
    angles = ANGLES[::7]
    found = np.array([in_c(float(x)) for x in angles], dtype=np.float32)
    np.testing.assert_array_equal(found, np.array(sine_and_cosine(angles)).T)


@pytest.mark.parametrize("angle", [LIMIT, -1e4, 3.4e38])
def test_large_angles_go_to_the_library(
    in_c: Callable[[float], tuple[float, float]], angle: float
) -> None:
    x = float(np.float32(angle))
    assert in_c(x) == pytest.approx((np.sin(x), np.cos(x)), abs=1e-6)
