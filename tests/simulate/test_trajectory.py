# SPDX-License-Identifier: BSD-3-Clause
"""Velocities of a motion that is given as samples."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from softimpact.simulate.trajectory import (
    Trajectory,
    passes,
    passes_of_parts,
    time_at_speeds,
    trajectory,
)
from softimpact.symbolic import InvalidValue


def test_a_smooth_motion_passes_each_sample_once() -> None:
    t = np.linspace(0, 2, 201)
    moved = trajectory(t, np.column_stack([np.sin(t), np.cos(2 * t) + 3 * t]))
    met = passes(moved)
    np.testing.assert_array_equal(met.sample, np.arange(201))
    true = np.column_stack([np.cos(t), 3 - 2 * np.sin(2 * t)])
    np.testing.assert_allclose(met.velocity[1:-1], true[1:-1], atol=2e-4)


def test_times_need_not_be_even() -> None:
    t = np.array([0, 0.1, 0.25, 0.3, 0.5])
    met = passes(trajectory(t, ((1 + t) ** 2)[:, None]))
    np.testing.assert_allclose(met.velocity[1:-1, 0], 2 * (1 + t[1:-1]))


def test_a_corner_counts_for_both_sides() -> None:
    t = np.linspace(0, 1, 11)
    there_and_back = np.where(t <= 0.5, t, 1 - t)[:, None]
    met = passes(trajectory(t, there_and_back))
    assert met.velocity[met.sample == 5].ravel() == pytest.approx([1, -1])
    assert np.abs(met.velocity).min() == pytest.approx(1)


def test_slowing_down_takes_longer() -> None:
    t = np.linspace(0, 2, 5)
    assert time_at_speeds(t, np.ones(5)) == pytest.approx(2)
    assert time_at_speeds(t, np.full(5, 0.5)) == pytest.approx(4)
    assert time_at_speeds(t, np.array([1, 1, 0.5, 1, 1])) == pytest.approx(2.5)


@pytest.mark.parametrize(
    ("t", "q", "reason"),
    [
        ([0.0], [[0.0]], "two samples at least, not 1"),
        ([0.0, 1e-300], [[0.0], [1.0]], "faster than 1000 rad/s or m/s to sample 2"),
        ([0, 1, 1], [[0.0]] * 3, "t: must rise, but goes from 1 to 1 s at sample 3"),
        ([0, 1], [[0.0], [np.nan]], "sample 2 holds no finite number"),
        ([0, 1], [[0.0]], "one row of joint angles for each time"),
    ],
)
def test_what_is_no_motion(t: list[float], q: list[list[float]], reason: str) -> None:
    with pytest.raises(InvalidValue, match=reason):
        trajectory(t, q)


@pytest.mark.parametrize("sizes", [[50], [1] * 50, [2, 3, 1, 40, 4], [49, 1], [1, 49]])
def test_parts_are_passed_as_the_whole_is(sizes: list[int]) -> None:
    random = np.random.default_rng(3)
    time, q = np.cumsum(random.uniform(0.1, 1, 50)), random.normal(size=(50, 3))
    edges = np.cumsum([0, *sizes])
    parts = [Trajectory(time[a:b], q[a:b]) for a, b in pairwise(edges)]
    found = list(passes_of_parts(parts))
    whole = passes(trajectory(time, q))
    for name, right in vars(whole).items():
        together = np.concatenate([getattr(part, name) for part in found])
        np.testing.assert_array_equal(together, right)


def test_parts_that_go_back_are_named_by_their_sample() -> None:
    time = np.array([0, 1, 2, 3, 2.5, 4.0])
    parts = [Trajectory(time[a : a + 2], np.zeros((2, 1))) for a in (0, 2, 4)]
    with pytest.raises(InvalidValue, match=r"goes from 3 to 2\.5 s at sample 5"):
        list(passes_of_parts(parts))
