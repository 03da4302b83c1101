# SPDX-License-Identifier: BSD-3-Clause
"""Laws of simulated impacts: energy, speed, and the limit of rigid joints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from impact_cases import EARTH, HEAD, POSE, r_min
from mechanisms import FIVE_BAR, robot_of

from softimpact.simulate import Approach, Controller, simulate_impact
from softimpact.simulate.arrival import arrival_of
from softimpact.simulate.events import course_of, peaks_of
from softimpact.simulate.full import full_scene
from softimpact.simulate.scene import Run, Scene
from softimpact.simulate.simulator import UNIT_TIME
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    Motors,
    Robot,
    body_region,
    closed_chain,
    drives,
    gravity_torques,
    impact_model,
    load_robot,
    loop_gaps,
    loop_tangent,
    mass_matrix,
    potential_energy,
)
from softimpact.symbolic.robot.rigid import Array

Case = Callable[[], tuple[ImpactModel, Approach]]


def elastic_panda() -> tuple[ImpactModel, Approach]:
    robot = load_robot("panda")
    model = impact_model(robot, drives=drives(robot, 2e3), gravity=EARTH)
    return model, Approach(POSE, np.array([0.4, 1.0, -0.3]), 2.0)


def folded_rr() -> tuple[ImpactModel, Approach]:
    model = impact_model(load_robot("rr"), "P")
    return model, Approach(np.array([0.2, 0.0, 0.9, 0.0]), np.array([1.0, 0.5, 0.0]), 2.0)


def fast_r_min() -> tuple[ImpactModel, Approach]:
    model, approach = r_min()
    return model, replace(approach, speed=2.0)


def undamped(contact: Contact) -> Contact:
    return replace(contact, region=replace(contact.region, damping=0.0))


def whole_run(scene: Scene, until: float | None) -> Run:
    """Return an impact with the robot's states: the motions alone, which all laws share."""
    course = course_of(scene, until)
    size = 2 * len(scene.still.position)
    states = [piece.run.state[:size, int(i > 0) :] for i, piece in enumerate(course.pieces)]
    return replace(course.run, state=np.hstack(states))


def followed(model: ImpactModel, approach: Approach, contact: Contact) -> tuple[Run, float | None]:
    """Return an impact of free motors until the first contact has ended, and when it does."""
    scene = full_scene(model, arrival_of(model, approach), contact, Motors("free"), 1e-11)
    return whole_run(scene, None), peaks_of(course_of(scene, None), None).separation


def joints_at(model: ImpactModel, run: Run, node: int, speed: float) -> tuple[Array, Array, Array]:
    """Motion since first touch and rates of all joints, and deflections since."""
    n, E = model.robot.n, [i for i, e in enumerate(model.drives.elastic) if e]
    k = n + len(E)
    state = speed * run.state[:, node]
    moved, rate = UNIT_TIME * state[:k], state[k : 2 * k]
    return moved, rate, moved[:n][E] - moved[n:]


def energy(model: ImpactModel, approach: Approach, run: Run, node: int) -> float:
    """Energy of links, rotors, springs and gravity, less the work of constant motor torques."""
    robot, n = model.robot, model.robot.n
    moved, rate, deflection = joints_at(model, run, node, approach.speed)
    elastic = np.array(model.drives.elastic)
    q, rotors = ca.DM(approach.q + moved[:n]), np.array(model.drives.rotors).ravel()
    M = np.array(mass_matrix(robot, q)) + np.diag(np.where(elastic, 0, rotors))
    kinetic = rate[:n] @ M @ rate[:n] + rotors[elastic] @ rate[n:] ** 2
    G = np.array(loop_tangent(robot, ca.DM(approach.q)))
    holding = G.T @ np.array(gravity_torques(robot, approach.q, model.gravity)).ravel()
    springs = np.array(model.drives.springs).ravel()[elastic]
    stored = float(potential_energy(robot, q, model.gravity))
    if elastic.any():  # the springs' preload holds what the motors hold
        stored += springs @ deflection**2 / 2 - holding[elastic] @ deflection
        return float(kinetic / 2 + stored - holding[elastic] @ moved[n:])
    return float(kinetic / 2 + stored - holding @ moved[list(model.independent)])


@pytest.mark.parametrize("case", [elastic_panda, folded_rr, fast_r_min])
def test_energy_is_conserved_without_damping(case: Case) -> None:
    """What the body gives back is what it took: free motors, no damper, c_h = 0."""
    model, approach = case()
    run, separation = followed(model, approach, undamped(HEAD))
    assert separation is not None
    assert run.force[-1] == 0
    before, after = (energy(model, approach, run, node) for node in (0, -1))
    moving = joints_at(model, run, 0, approach.speed)[1]
    scale = (
        moving[: model.robot.n]
        @ np.array(mass_matrix(model.robot, approach.q))
        @ (moving[: model.robot.n])
    )
    assert abs(after - before) < 1e-6 * scale
    damped, _ = followed(model, approach, HEAD)
    lost = energy(model, approach, damped, 0) - energy(model, approach, damped, -1)
    assert lost > 1e-4 * scale


def test_loops_stay_closed_through_an_impact() -> None:
    model, approach = fast_r_min()
    controller = Controller(1076.0, 51.0, 9.26e3)
    scene = full_scene(model, arrival_of(model, approach), HEAD, controller, 1e-10)
    run = whole_run(scene, 0.06)
    for node in range(0, len(run.time), 100):
        moved = joints_at(model, run, node, approach.speed)[0]
        assert abs(np.array(loop_gaps(model.robot, approach.q + moved))).max() < 1e-8
    assert abs(moved).max() > 0.05


@pytest.mark.parametrize("case", [elastic_panda, folded_rr, fast_r_min])
def test_forces_grow_with_speed(case: Case) -> None:
    model, approach = case()
    peaks = [
        simulate_impact(model, replace(approach, speed=v), HEAD, "full").first_contact
        for v in (0.05, 0.2, 0.5, 1.0, 1.6, 2.4)
    ]
    assert all(faster > slower for slower, faster in pairwise(peaks))


@pytest.mark.slow
def test_stiff_joints_hit_like_rigid_ones(panda: Robot) -> None:
    """As k_s → ∞ the peak tends to that of the rigid robot's reflected mass, rotors included."""
    n = np.array([0.4, 1.0, -0.3])
    approach = Approach(POSE, n, 1.0)
    rigid = simulate_impact(impact_model(panda), approach, HEAD, "one_mass").first_contact
    links = impact_model(panda.with_armature(np.zeros(panda.n)))
    assert rigid > 1.05 * simulate_impact(links, approach, HEAD, "one_mass").first_contact
    errors = [
        abs(
            simulate_impact(
                impact_model(panda, drives=drives(panda, stiffness)), approach, HEAD
            ).first_contact
            / rigid
            - 1
        )
        for stiffness in (1e5, 1e7, 1e9)
    ]
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 1e-3
    full = impact_model(panda, drives=drives(panda, 1e8))
    slow = replace(approach, speed=1e-2)
    nearly = simulate_impact(full, slow, HEAD, "full").first_contact
    alone = simulate_impact(impact_model(panda), slow, HEAD, "one_mass").first_contact
    assert nearly == pytest.approx(alone, rel=1e-4)


def test_computed_torque_keeps_a_closed_chain_on_its_way(tmp_path: Path) -> None:
    """Against next to nothing, motors go on at the speed of arrival though nothing else does."""
    robot = robot_of(tmp_path, FIVE_BAR)
    model = impact_model(robot, gravity=EARTH)
    nothing = Contact(body_region("hand"), hertz_stiffness=1e-6)
    rates = np.array([-3.0, 4.0])
    moved = np.array(model.jacobian(closed_chain(robot).home)) @ rates
    speed = float(np.linalg.norm(moved))
    approach = Approach(closed_chain(robot).home, moved / speed, speed, rates / speed)
    controller = Controller(100.0, 20.0, 0.0)
    scene = full_scene(model, arrival_of(model, approach), nothing, controller, 1e-10)
    moved = joints_at(model, whole_run(scene, 0.02), -1, speed)[0]
    assert moved[list(model.independent)] == pytest.approx(0.02 * rates, abs=1e-8)
    G = np.array(loop_tangent(robot, ca.DM(approach.q)))
    assert abs(moved - G @ (0.02 * rates)).max() > 1e-3  # the others speed up
