# SPDX-License-Identifier: BSD-3-Clause
"""GIAF Eq. 14, derived anew, against the balance of impulse and momentum itself."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from oracles import column
from random_robots import arms, robots, seeds, unit_vector, vectors

from softimpact.symbolic import (
    Robot,
    contact_mobility,
    impact_model,
    joint_impulse,
    load_robot,
)
from softimpact.symbolic.robot.rigid import Array

restitutions = st.sampled_from([0.0, 0.3, 1.0])
masses = st.sampled_from([0.2, 4.4, 40.0, np.inf])


def balance(
    H: Array, push: Array, velocity: Array, e: float, inverse_mass: float, other_speed: float
) -> tuple[Array, float]:
    """Solve H Δq̇ + Jᵀn p = 0, Δv_2 = p/m_2 and Newton's law of restitution as one system."""
    n = len(H)
    A = np.zeros((n + 2, n + 2))
    A[:n, :n], A[:n, n] = H, push
    A[n, n], A[n, n + 1] = inverse_mass, -1
    A[n + 1, :n], A[n + 1, n + 1] = push, -1
    relative = push @ velocity - other_speed
    solution = np.linalg.solve(A, [*np.zeros(n + 1), -(1 + e) * relative])
    return solution[:n], solution[n]


@settings(max_examples=40)
@given(robots(max_joints=5), vectors(5), vectors(5), seeds, restitutions, masses)
def test_agrees_with_the_balance(
    robot: Robot, q: Array, velocity: Array, seed: int, e: float, other: float
) -> None:
    q, velocity, n = q[: robot.n], velocity[: robot.n], unit_vector(seed)
    model = impact_model(robot)
    M, J = model.mass_matrix(q), model.jacobian(q)
    push = np.array(J).T @ n
    assume(np.linalg.norm(push) > 1e-2)
    H = np.array(M) + np.diag(robot.armature)
    other_speed = 0.4
    change, p = balance(H, push, velocity, e, 1 / other, other_speed)
    speed = push @ velocity - other_speed
    found = joint_impulse(M, ca.DM(robot.armature), J, ca.DM(n), speed, e, 1 / other)
    assert float(found.contact) == pytest.approx(p, rel=1e-8)
    np.testing.assert_allclose(
        column(found.velocity_change), change, rtol=1e-7, atol=1e-9 * abs(change).max()
    )
    np.testing.assert_allclose(column(found.joints), -push * p, atol=1e-9 * abs(p))
    np.testing.assert_allclose(
        column(found.gears), robot.armature * change, atol=1e-8 * abs(change).max()
    )


@settings(max_examples=30)
@given(arms(), vectors(5), vectors(5), seeds, restitutions, masses)
def test_energy_and_rebound(
    robot: Robot, q: Array, velocity: Array, seed: int, e: float, other: float
) -> None:
    """An elastic impact keeps the energy, any other loses what 1 − e² says."""
    q, velocity, n = q[: robot.n], velocity[: robot.n], unit_vector(seed)
    model = impact_model(robot)
    M, J = model.mass_matrix(q), model.jacobian(q)
    push = np.array(J).T @ n
    H = np.array(M) + np.diag(robot.armature)
    speed = push @ velocity
    found = joint_impulse(M, ca.DM(robot.armature), J, ca.DM(n), speed, e, 1 / other)
    change, p = column(found.velocity_change), float(found.contact)
    own = 0.5 * (velocity + change) @ H @ (velocity + change) - 0.5 * velocity @ H @ velocity
    lost = -(own + 0.5 * p**2 / other)
    mobility = push @ np.linalg.solve(H, push) + 1 / other
    assert lost == pytest.approx(0.5 * (1 - e**2) * speed**2 / mobility, rel=1e-7, abs=1e-9)
    rebound = push @ (velocity + change) - p / other
    assert rebound == pytest.approx(-e * speed, rel=1e-7, abs=1e-9)


def test_links_take_what_gears_do_not() -> None:
    """Each joint: link momentum M Δq̇ = Γ − b Δq̇, the contact's impulse less the rotor's."""
    model = impact_model(load_robot("panda"))
    q = np.array([0.0, 0.3, 0.0, -1.8, 0.1, 2.0, 0.5])
    M, J = model.mass_matrix(q), model.jacobian(q)
    found = joint_impulse(M, model.drives.rotors, J, ca.DM([0, 1, 0]), 0.7, 0.2)
    links = np.array(M) @ column(found.velocity_change)
    np.testing.assert_allclose(links, column(found.joints) - column(found.gears), atol=1e-12)


def test_printed_equation_has_other_units() -> None:
    """With nᵀΛn for nᵀΛ⁻¹n the impulse would shrink as the robot grows heavier."""
    J, n = ca.DM.eye(3), ca.DM([0, 0, 1])
    light, heavy = (joint_impulse(m * ca.DM.eye(3), ca.DM.zeros(3), J, n) for m in (1, 10))
    assert float(heavy.contact) == pytest.approx(10 * float(light.contact))
    assert float(heavy.contact) == pytest.approx(
        1 / float(contact_mobility(10 * ca.DM.eye(3), J).matrix[2, 2])
    )
