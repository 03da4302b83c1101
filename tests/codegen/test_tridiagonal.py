# SPDX-License-Identifier: BSD-3-Clause
"""QL iterations as the generated C does them."""

from __future__ import annotations

import numpy as np
import pytest

from softimpact.codegen.tridiagonal import Numbers, eigen_rows, sharpened


def dense(diagonal: Numbers, off: Numbers) -> Numbers:
    return np.diag(diagonal) + np.diag(off, 1) + np.diag(off, -1)


@pytest.mark.parametrize("size", [1, 2, 5, 9])
def test_agrees_with_numpy(size: int) -> None:
    random = np.random.default_rng(size)
    diagonal, off = random.normal(size=size), random.normal(size=size - 1)
    values, shapes = eigen_rows(diagonal, off, np.eye(size))
    right = np.linalg.eigvalsh(dense(diagonal, off))
    np.testing.assert_allclose(np.sort(values), right, atol=1e-10)
    np.testing.assert_allclose(shapes @ shapes.T, np.eye(size), atol=1e-13)
    np.testing.assert_allclose(shapes * values @ shapes.T, dense(diagonal, off), atol=1e-5)


def test_uncoupled_entries_are_eigenvalues() -> None:
    values, rows = eigen_rows(np.array([3.0, 1.0, 2.0]), np.zeros(2), np.eye(3))
    np.testing.assert_array_equal(values, [3, 1, 2])
    np.testing.assert_array_equal(rows, np.eye(3))


def test_slow_modes_of_a_chain_survive_in_float_if_its_soft_end_comes_first() -> None:
    mass = np.array([1.034, 0.005069, 0.1903, 21.02, 1.08, 4.739, 1.065], dtype=np.float32)
    springs = np.array([7.477e5, 1.2025e6, 5.278e5, 1.512e4, 3819, 945.2], dtype=np.float32)
    root = np.sqrt(mass)
    diagonal = (np.append(springs, np.float32(0)) + np.append(np.float32(0), springs)) / mass
    off = -springs / (root[:-1] * root[1:])
    slow = np.linalg.eigvalsh(dense(diagonal.astype(float), off.astype(float)))[1]
    rows = np.eye(7, dtype=np.float32)
    grows, shapes = eigen_rows(diagonal[::-1], off[::-1], rows)
    falls, _ = eigen_rows(diagonal, off, rows)
    assert grows.dtype == shapes.dtype == np.float32
    assert abs(np.sort(grows)[1] / slow - 1) < 1e-3 < abs(np.sort(falls)[1] / slow - 1)


def test_sharpened_frequencies_are_right_by_themselves() -> None:
    """A light mass between stiff springs: in float its fast mode hides what the others do to QL."""
    mass = np.array([29.6, 0.0278, 30.3, 28.7, 7.02, 4.18, 1.19])
    springs = np.array([4.83e6, 4.9e6, 4.15e6, 5.61e5, 9.92e5, 5630, 0])
    root = np.sqrt(mass)
    diagonal = (springs + np.append(0, springs[:-1])) / mass
    off = -springs[:-1] / (root[:-1] * root[1:])
    right = np.linalg.eigvalsh(dense(diagonal, off))[1:]
    narrow, beside = (x[::-1].astype(np.float32) for x in (diagonal, off))
    found, _ = eigen_rows(narrow, beside, np.eye(7, dtype=np.float32))
    sharp = sharpened(mass.astype(np.float32), springs.astype(np.float32), found)
    assert sharp.dtype == np.float32
    rough, fine = (abs(np.sort(x)[1:] / right - 1).max() for x in (found, sharp))
    assert rough > 1e-4
    assert fine < 2e-6
    exact, _ = eigen_rows(diagonal[::-1], off[::-1], np.eye(7))
    np.testing.assert_allclose(np.sort(sharpened(mass, springs, exact))[1:], right, rtol=1e-9)
