# SPDX-License-Identifier: BSD-3-Clause
"""Laws of closed chains."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from mechanisms import FIVE_BAR, SPATIAL, four_bar, robot_of
from scipy.integrate import solve_ivp

from softimpact.symbolic import (
    Robot,
    bias_torques,
    chain,
    close_loops,
    closed_chain,
    configuration_at_rest,
    drives,
    gravity_torques,
    impact_factors,
    impact_model,
    load_robot,
    loop_acceleration,
    loop_gaps,
    loop_jacobian,
    loop_tangent,
    mass_matrix,
    potential_energy,
    static_stiffness,
)
from softimpact.symbolic.robot.rigid import Array

GRAVITY = (0.0, 0.0, -9.81)
MOTORS = np.radians([-120.0, -55.0])
N = ca.DM([0.6, 0.0, 0.8])
CHOICES = [
    ("q11", "q21", "q13", "q23"),
    ("q11", "q21", "q12", "q22"),
    ("q21", "q11", "q22", "q13"),
    ("q23", "q12", "q11", "q21"),
]
"""Joints that can describe R-Min, in different orders."""


@pytest.fixture(params=["four_bar", "five_bar", "spatial", "rmin"])
def mechanism(request: pytest.FixtureRequest, tmp_path: Path) -> Robot:
    if request.param == "rmin":
        return load_robot("rmin")
    if request.param == "four_bar":
        return four_bar(tmp_path, tilt="20")
    return robot_of(tmp_path, {"five_bar": FIVE_BAR, "spatial": SPATIAL}[request.param])


def near_home(robot: Robot, count: int = 5) -> Iterator[Array]:
    """Yield closed configurations."""
    chain_ = closed_chain(robot)
    random = np.random.default_rng(1)
    for _ in range(count):
        u = chain_.home[list(chain_.independent)]
        yield close_loops(robot, u + random.uniform(-0.1, 0.1, len(u)))


def test_mass_matrix_is_symmetric_and_positive_definite(mechanism: Robot) -> None:
    for q in near_home(mechanism):
        M0 = np.array(impact_model(mechanism).generalised_mass(q).matrix)
        assert np.array_equal(M0, M0.T)
        assert np.linalg.eigvalsh(M0).min() > 0


def test_reflected_mass_is_what_a_force_accelerates(mechanism: Robot) -> None:
    """Unit force at the contact point, loops held by forces: M q̈ + Φᵀλ = Jᵀn, Φ q̈ = 0."""
    model = impact_model(mechanism)
    for q in near_home(mechanism):
        M = np.array(mass_matrix(mechanism, q)) + np.diag(mechanism.armature)
        phi = np.array(loop_jacobian(mechanism, q))
        open_chain = replace(mechanism, loops=())
        row = impact_model(open_chain, mechanism.tip).contact_jacobian(q, N)
        zero = np.zeros((len(phi), len(phi)))
        whole = np.block([[M, phi.T], [phi, zero]])
        push = np.concatenate([np.array(row).ravel(), np.zeros(len(phi))])
        mobility = push @ np.linalg.solve(whole, push)
        assert float(model.reflected_mass(q, N)) == pytest.approx(1 / mobility, rel=1e-8)


def test_rotors_of_joints_that_follow_count_as_links(mechanism: Robot) -> None:
    """Springs hide the rotors behind them; joints that follow from others have none."""
    turning = mechanism.with_armature(np.linspace(0.05, 0.2, mechanism.n))
    chain_ = closed_chain(turning)
    springs = np.where(np.isin(np.arange(turning.n), chain_.independent), 1e3, np.inf)
    elastic = impact_model(turning, drives=drives(turning, springs))
    behind = np.where(np.isfinite(springs), 0.0, turning.armature)
    rigid = impact_model(turning, drives=drives(turning, rotor_inertia=behind))
    for q in near_home(mechanism, 2):
        expected = float(rigid.reflected_mass(q, N))
        assert float(elastic.reflected_mass(q, N)) == pytest.approx(expected, rel=1e-10)
        assert float(elastic.reduced(q, N).m_c) == pytest.approx(expected, rel=1e-8)
        links = impact_model(mechanism.with_armature(np.zeros(mechanism.n)))
        assert expected > 1.01 * float(links.reflected_mass(q, N))


def test_impulses_in_a_closed_chain_are_those_of_the_whole_balance(mechanism: Robot) -> None:
    """H Δq̇ + Φᵀλ + Jᵀn p = 0 over all joints, Φ Δq̇ = 0, and the wanted rebound."""
    turning = mechanism.with_armature(np.linspace(0.05, 0.2, mechanism.n))
    model, e, other = impact_model(turning), 0.3, 5.0
    for q in near_home(mechanism, 2):
        H = np.array(mass_matrix(turning, q)) + np.diag(turning.armature)
        phi = np.array(loop_jacobian(turning, q))
        open_chain = impact_model(replace(turning, loops=()), turning.tip)
        push = np.array(open_chain.contact_jacobian(q, N)).ravel()
        held = np.vstack([phi, push])
        below = np.zeros((len(held), len(held)))
        below[-1, -1] = -1 / other
        whole = np.block([[H, held.T], [held, below]])
        answer = np.linalg.solve(whole, [*np.zeros(len(whole) - 1), -(1 + e) * 0.7])
        found = impact_factors(
            model, q, np.array(N).ravel(), speed=0.7, restitution=e, other_mass=other
        ).impulse
        assert found.contact == pytest.approx(answer[-1], rel=1e-8)
        np.testing.assert_allclose(found.velocity_change, answer[: turning.n], atol=1e-9)
        np.testing.assert_allclose(found.joints, -push * answer[-1], atol=1e-9)
        np.testing.assert_allclose(found.gears, turning.armature * answer[: turning.n], atol=1e-9)


@pytest.mark.parametrize("tip", ["P", "O13", "link22@0.15,0,0.02"])
@pytest.mark.parametrize("choice", CHOICES[1:])
def test_what_an_impact_feels_does_not_depend_on_the_independent_joints(
    tip: str, choice: tuple[str, ...]
) -> None:
    """m_c, k_r, k_c and the chain; the motors are held, the passive joints at rest."""
    robot = replace(
        load_robot("rmin"),
        joints=tuple(
            replace(j, stiffness=20.0 if j.stiffness else 0.0) for j in load_robot("rmin").joints
        ),
    )
    found = []
    for names in (CHOICES[0], choice):
        chosen = replace(robot, independent=names)
        gains = drives(chosen, position_gain=[50.0, 0.0, 0.0, 80.0, 0.0, 0.0])
        model = impact_model(chosen, tip, drives=gains, gravity=GRAVITY)
        linear = model.linear(configuration_at_rest(model, MOTORS), N)
        reduced = chain(linear, 4)
        found.append([static_stiffness(linear), *reduced.mass, *reduced.stiffness])
    ours, theirs = (np.array([float(x) for x in numbers]) for numbers in found)
    np.testing.assert_allclose(theirs, ours, rtol=1e-6)
    assert ours[0] > 0


def test_a_slow_push_meets_k_c() -> None:
    """R-Min pushed by a small force gives way by force over k_c."""
    robot = load_robot("rmin")
    gains = drives(robot, position_gain=[50.0, 0.0, 0.0, 80.0, 0.0, 0.0])
    model = impact_model(robot, "O13", drives=gains, gravity=GRAVITY)
    rest = configuration_at_rest(model, MOTORS)
    k_c = float(static_stiffness(model.linear(rest, N)))
    force, q = 0.05, rest
    balance = gravity_torques(robot, rest, GRAVITY)  # motors go on holding what they held
    held = np.array(loop_tangent(robot, rest)).T @ np.array(balance).ravel()
    ind = list(closed_chain(robot).independent)
    gain = np.diag([50.0, 80.0, 0.0, 0.0])
    for _ in range(20):
        G = np.array(loop_tangent(robot, q))
        torque = G.T @ np.array(gravity_torques(robot, q, GRAVITY)).ravel() - held
        torque += gain @ (q - rest)[ind]
        torque -= force * np.array(model.contact_jacobian(q, N)).ravel()
        K = np.array(model.generalised_stiffness(q))
        q = close_loops(robot, q[ind] - np.linalg.solve(K, torque))
    moved = float(model.contact_jacobian(rest, N) @ (q - rest)[ind])
    assert moved == pytest.approx(force / k_c, rel=1e-4)


@pytest.mark.parametrize("text", [FIVE_BAR, SPATIAL])
def test_energy_is_conserved_and_loops_stay_closed(text: str, tmp_path: Path) -> None:
    """Free motion over all joints, with the loops' accelerations as constraints."""
    robot = robot_of(tmp_path, text)
    q, v = ca.SX.sym("q", robot.n), ca.SX.sym("v", robot.n)
    M, phi = mass_matrix(robot, q), loop_jacobian(robot, q)
    torque = -bias_torques(robot, q, v, (0.0, 0.0, 0.0)) - gravity_torques(robot, q, GRAVITY)
    rows = phi.shape[0]
    whole = ca.blockcat([[M, phi.T], [phi, ca.SX(rows, rows)]])
    right = ca.vertcat(torque, -loop_acceleration(robot, q, v))
    system = ca.Function("f", [q, v], [ca.densify(whole), ca.densify(right)])
    energy = ca.Function(
        "E", [q, v], [0.5 * ca.dot(v, M @ v) + potential_energy(robot, q, GRAVITY)]
    )

    def rate(_: float, state: Array) -> Array:
        matrix, force = (np.array(x) for x in system(state[: robot.n], state[robot.n :]))
        return np.concatenate([state[robot.n :], np.linalg.solve(matrix, force)[: robot.n, 0]])

    home = closed_chain(robot).home
    start = np.array(loop_tangent(robot, home)) @ [0.5, -0.4]
    run = solve_ivp(rate, (0, 0.1), np.concatenate([home, start]), rtol=1e-10, atol=1e-12)
    end = run.y[:, -1]
    assert abs(end[: robot.n] - home).max() > 0.01
    first, last = (float(energy(*np.split(s, 2))) for s in (run.y[:, 0], end))
    kinetic = first - float(potential_energy(robot, home, GRAVITY))
    assert last == pytest.approx(first, abs=1e-7 * kinetic)
    assert abs(np.array(loop_gaps(robot, end[: robot.n]))).max() < 1e-8
