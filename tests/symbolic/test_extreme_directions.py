# SPDX-License-Identifier: BSD-3-Clause
"""The directions in which rotors matter most and least, against SciPy's eigenvalue problem."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from hypothesis import assume, given, settings
from oracles import column, configurations
from random_robots import arms, seeds, unit_vector, vectors
from scipy.linalg import eigh

from softimpact.symbolic import (
    ContactMobility,
    ImpactModel,
    Matrix,
    Robot,
    directional_giaf,
    extreme_directional_giaf,
    extreme_mass_ratio,
    giaf,
    impact_model,
    load_robot,
)
from softimpact.symbolic.robot.rigid import Array


def mobilities(model: ImpactModel, q: Array) -> tuple[ContactMobility, ContactMobility]:
    free, real = model.free_mobility(q), model.mobility(q)
    assume(np.linalg.cond(np.array(free.matrix)) < 1e5)
    return free, real


@settings(max_examples=20)
@given(arms(), vectors(5), seeds)
def test_no_direction_lies_beyond_the_extremes(robot: Robot, q: Array, seed: int) -> None:
    free, real = mobilities(impact_model(robot), q[: robot.n])
    found = extreme_directional_giaf(free, real)
    spectrum = eigh(np.array(free.inertia), np.array(real.inertia), eigvals_only=True)
    least, greatest = float(found.least), float(found.greatest)
    assert [least, greatest] == pytest.approx([spectrum[0], spectrum[2]], rel=1e-7)
    assert 0 <= least <= greatest <= 1 + 1e-9
    assert least - 1e-9 <= float(directional_giaf(free, real, unit_vector(seed))) <= greatest + 1e-9
    at = [
        directional_giaf(free, real, x) for x in (found.least_direction, found.greatest_direction)
    ]
    assert [float(x) for x in at] == pytest.approx([least, greatest], rel=1e-7)
    assert np.linalg.norm(column(found.least_direction)) == pytest.approx(1)


@settings(max_examples=20)
@given(arms(), vectors(5), seeds)
def test_mass_ratio_has_the_same_extremes_elsewhere(robot: Robot, q: Array, seed: int) -> None:
    free, real = mobilities(impact_model(robot), q[: robot.n])
    G_F, G = np.array(free.matrix), np.array(real.matrix)
    ratios, shares = extreme_mass_ratio(free, real), extreme_directional_giaf(free, real)
    assert float(ratios.least) == pytest.approx(float(shares.least), rel=1e-9)

    def ratio(n: Array) -> float:
        return float(n @ G @ n / (n @ G_F @ n))

    least, greatest = column(ratios.least_direction), column(ratios.greatest_direction)
    assert ratio(least) == pytest.approx(float(ratios.least), rel=1e-7)
    assert ratio(greatest) == pytest.approx(float(ratios.greatest), rel=1e-7)
    assert ratio(least) - 1e-9 <= ratio(unit_vector(seed)) <= ratio(greatest) + 1e-9


def test_symbols_and_numbers_agree() -> None:
    model = impact_model(load_robot("panda"))
    q = next(configurations(model.robot, 1, seed=2))
    x = ca.SX.sym("q", 7)

    def all_of(q: Matrix) -> list[Matrix]:
        found = extreme_directional_giaf(model.free_mobility(q), model.mobility(q))
        product = found.least_direction * ca.sign(found.least_direction[0])
        return [found.least, found.greatest, product]

    ours = ca.Function("f", [x], all_of(x))(q)
    for a, b in zip(ours, all_of(ca.DM(q)), strict=True):
        np.testing.assert_allclose(np.array(a), np.array(b), rtol=1e-9)


def test_extremes_multiply_to_giaf_where_all_are_equal() -> None:
    from softimpact.symbolic import ContactMobility

    free, real = (
        ContactMobility(ca.DM(np.diag([1.0, 2.0, 4.0]))),
        ContactMobility(ca.DM(np.diag([0.5, 1.0, 2.0]))),
    )
    found = extreme_directional_giaf(free, real)
    assert float(found.least) == pytest.approx(0.5)
    assert float(found.greatest) == pytest.approx(0.5)
    assert float(giaf(free, real)) == pytest.approx(0.125)
