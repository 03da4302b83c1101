# SPDX-License-Identifier: BSD-3-Clause
"""The least worst force over springs, postures held: no springs nearby are better."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from studies import study_of

from softimpact.optimize.impact.peaks import peaks_in_windows, top_weights, tops
from softimpact.optimize.search.ipopt import Begin, Nlp, minimise, ranked
from softimpact.optimize.search.minimax import least_worst
from softimpact.optimize.search.minimax_point import Held
from softimpact.optimize.search.problem import Problem, prepare
from softimpact.symbolic.robot.rigid import Array

ASKED: dict[str, dict[str, Any]] = {
    "impact": {"region": "head", "speed": 1.0},
    "motors": {"reaction_time": 0.02, "horizon": 0.1},
}
"""Both ends of what motors may do: two impacts with peaks of their own."""

FORCES = st.lists(st.floats(0.0, 100.0), min_size=5, max_size=12)


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return prepare(study_of(tmp_path_factory.mktemp("minimax"), ASKED, ("q9", "q18")))


def posture(problem: Problem) -> Array:
    return problem.poses[0].q[None, :]


@pytest.mark.slow
@pytest.mark.parametrize("begin", ["lower", "nominal", "upper"])
def test_no_springs_nearby_are_better(problem: Problem, begin: str) -> None:
    bounds, instance, study = problem.bounds, problem.numbers(), problem.study
    q = posture(problem)
    nlp = Nlp(problem.program, instance, bounds)
    found = least_worst(nlp, Begin(q, getattr(study, begin)))
    assert found.success
    assert found.violation <= 1e-5
    held, random = Held(nlp, q), np.random.default_rng(1)
    v = bounds.vector(found.springs)
    for length in (1e-3, 1e-2, 3e-2):
        for _ in range(30):
            near = held.at(
                np.clip(v + random.normal(0, length, v.size), bounds.lower, bounds.upper)
            )
            if near.violation <= found.violation:
                assert near.worst > found.cost * (1 - 1e-4)


@pytest.mark.slow
def test_it_is_no_worse_than_ipopt_from_where_that_ends(problem: Problem) -> None:
    bounds, instance, q = problem.bounds, problem.numbers(), posture(problem)
    nlp = Nlp(problem.program, instance, bounds)
    ipopt = minimise(nlp, Begin(q, problem.study.nominal), free=False)
    found = least_worst(nlp, Begin(q, ipopt.springs))
    assert found.cost <= ipopt.cost * (1 + 1e-5)
    assert found.violation <= max(ipopt.violation, 1e-7)
    forces = held_forces(problem, q, bounds.vector(found.springs))
    np.testing.assert_allclose(found.shares, forces / instance.units, rtol=1e-9)


def held_forces(problem: Problem, q: Array, v: Array) -> Array:
    """Largest peaks by the function that certificates are made of [N]."""
    rows, peaks = problem.numbers().impacts, problem.program.impacts[0]["peaks"]
    return np.array([np.max(np.array(peaks(np.r_[q[0], v], row, 0))) for row in rows])


@pytest.mark.slow
def test_derivatives_are_those_of_the_peaks(problem: Problem) -> None:
    nlp = Nlp(problem.program, problem.numbers(), problem.bounds)
    held = Held(nlp, posture(problem))
    v = problem.bounds.vector(problem.study.nominal)
    at = held.at(v)
    for impact, (nodes, heights) in enumerate(at.tops):
        node = int(nodes[np.argmax(heights)])
        slope, step = at.slopes_of([(impact, node)])[0], 1e-5
        for joint in range(v.size):
            unit = step * np.eye(v.size)[joint]
            ends = [held.at(v + sign * unit).same_top(impact, node) for sign in (1, -1)]
            assert ends[0]
            assert ends[1]
            difference = (ends[0][1] - ends[1][1]) / (2 * step)
            expected = difference * held.decades[joint]
            assert slope[joint] == pytest.approx(expected, rel=1e-4, abs=1e-6)


@given(FORCES)
def test_the_largest_top_is_the_peak(forces: list[float]) -> None:
    [(_, heights)] = tops(np.array([forces]))
    peak = float(np.max(np.array(peaks_in_windows(ca.DM(forces), 0))))
    assert heights.max() == pytest.approx(peak, rel=1e-12, abs=1e-12)


@given(FORCES)
def test_weights_are_the_derivatives_of_a_top(forces: list[float]) -> None:
    values, step = np.array(forces) + np.linspace(0.0, 1e-3, len(forces)), 1e-7
    [(nodes, heights)] = tops(values[None, :])
    node, height = int(nodes[0]), float(heights[0])
    weights = top_weights(values, node)
    for i in np.flatnonzero(weights):
        moved = values.copy()
        moved[i] += step
        after = dict(zip(*tops(moved[None, :])[0], strict=True))
        curved = 2 * values[node] - values[[node - 1, node + 1 - len(values)]].sum()
        if node in after and node not in (0, len(values) - 1) and curved > 1e-2:
            assert weights[i] == pytest.approx((after[node] - height) / step, rel=1e-2, abs=1e-2)


def test_what_breaks_a_bound_is_never_preferred() -> None:
    """By however little, and however large the other's force."""
    kept, broken, optimal = (
        ranked(False, 0.0, 5.0),
        ranked(False, 1e-3, 0.9),
        ranked(True, 0.0, 9.0),
    )
    assert optimal < kept < broken
