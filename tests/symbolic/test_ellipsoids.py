# SPDX-License-Identifier: BSD-3-Clause
"""Manipulability, force and dynamic impact measures against NumPy's SVD and pseudo-inverse."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from oracles import assert_near, configurations

from softimpact.symbolic import (
    Ellipsoid,
    ImpactModel,
    dynamic_impact_ellipsoid,
    dynamic_impact_measure,
    force_measure,
    generalised_inertia_ellipsoid,
    impact_model,
    load_robot,
    manipulability,
    manipulability_ellipsoid,
)
from softimpact.symbolic.robot.rigid import Array

Arm = tuple[Array, Array, ImpactModel, Array]
"""J, H, the model and q."""


@pytest.fixture(scope="module", params=range(4))
def arm(request: pytest.FixtureRequest) -> Arm:
    model = impact_model(load_robot("panda"))
    q = list(configurations(model.robot, 4, seed=11))[request.param]
    return np.array(model.jacobian(q)), np.array(model.rotor_mass_matrix(q)), model, q


def shape(ellipsoid: Ellipsoid) -> Array:
    """The matrix A of {A^½ u}."""
    a, V = np.array(ellipsoid.semi_axes).ravel(), np.array(ellipsoid.axes)
    return np.asarray(V @ np.diag(a**2) @ V.T)


def test_manipulability_is_the_product_of_singular_values(arm: Arm) -> None:
    J = arm[0]
    sigma = np.linalg.svd(J)[1]
    assert float(manipulability(ca.DM(J))) == pytest.approx(np.prod(sigma), rel=1e-10)
    assert float(force_measure(ca.DM(J))) == pytest.approx(1 / np.prod(sigma), rel=1e-10)
    found = manipulability_ellipsoid(ca.DM(J))
    assert_near(found.semi_axes, np.sort(sigma), 1e-12)
    assert_near(shape(found), J @ J.T, 1e-12)


def test_dynamic_impact_measure_is_the_volume_of_its_ellipsoid(arm: Arm) -> None:
    J, H = arm[:2]
    load = H @ np.linalg.pinv(J)
    E = load.T @ load
    found = dynamic_impact_ellipsoid(ca.DM(H), ca.DM(J))
    assert_near(shape(found), E, 1e-9)
    measure = float(dynamic_impact_measure(ca.DM(H), ca.DM(J)))
    assert measure == pytest.approx(np.sqrt(np.linalg.det(E)), rel=1e-8)
    assert measure == pytest.approx(np.prod(np.array(found.semi_axes)), rel=1e-8)


def test_long_axes_of_the_impact_ellipsoid_load_the_joints(arm: Arm) -> None:
    """|H J⁺ Δẋ| of a unit velocity change along an axis is its length."""
    J, H = arm[:2]
    found = dynamic_impact_ellipsoid(ca.DM(H), ca.DM(J))
    for length, axis in zip(np.array(found.semi_axes).ravel(), np.array(found.axes).T, strict=True):
        assert np.linalg.norm(H @ np.linalg.pinv(J) @ axis) == pytest.approx(length, rel=1e-8)


def test_velocities_on_the_inertia_ellipsoid_have_equal_energy(arm: Arm) -> None:
    _, _, model, q = arm
    mobility = model.mobility(q)
    found = generalised_inertia_ellipsoid(mobility)
    L = np.array(mobility.inertia)
    for length, axis in zip(np.array(found.semi_axes).ravel(), np.array(found.axes).T, strict=True):
        assert length**2 * axis @ L @ axis == pytest.approx(1, rel=1e-8)


def test_a_stretched_arm_loses_a_direction() -> None:
    """Two bars in a line: no manipulability, no NaN."""
    J = ca.DM([[0.0, 0.0], [2.0, 1.0], [0.0, 0.0]])
    assert float(manipulability(J)) == 0
    assert float(force_measure(J)) == np.inf
    assert_near(manipulability_ellipsoid(J).semi_axes, [0, 0, np.sqrt(5)], 1e-14)
