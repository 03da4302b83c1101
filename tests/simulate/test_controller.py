# SPDX-License-Identifier: BSD-3-Clause
"""The controller: against MuJoCo, against its linear form, and when it reacts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import mujoco
import numpy as np
import pytest
from impact_cases import CHEST, HEAD, POSE, r_min
from mujoco_impacts import STEP, extrapolated, impact_forces

from softimpact.robots import built_in_robots
from softimpact.simulate import (
    Approach,
    Controller,
    ControllerReference,
    ImpactHistory,
    largest_safe_speed,
    simulate_impact,
)
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    InvalidValue,
    Motors,
    Robot,
    UnknownName,
    body_region,
    drives,
    impact_model,
    load_robot,
)
from softimpact.symbolic.robot.rigid import Array

RR = Controller(6050.0, 121.0, 1.25e5)
R_MIN = Controller(1076.0, 51.0, 9.26e3)
FOLDED = np.array([0.2, 0.0, 1.1, 0.0])


def turned_by_both_motors(gain: float | None = None) -> tuple[ImpactModel, Approach]:
    robot = load_robot("rr")
    model = impact_model(robot, "P", drives=drives(robot, computed_torque_gain=gain))
    rates = np.array([1.0, 0.0, 0.7, 0.0])
    moved = np.array(model.jacobian(FOLDED)) @ rates
    speed = float(np.linalg.norm(moved))
    return model, Approach(FOLDED, moved / speed, 1.0, rates / speed)


def elastic_panda(robot: Robot) -> tuple[ImpactModel, Approach]:
    model = impact_model(robot, drives=drives(robot, 5e3), gravity=(1.0, -2.0, -9.0))
    return model, Approach(POSE, np.array([0.5, 1.0, 0.3]), 1.0)


def forces_by_mujoco(
    approach: Approach, controller: Controller, contact: Contact, duration: float, step: float
) -> Array:
    """Step RR with the control law written out again over MuJoCo's own M and bias."""
    model = mujoco.MjModel.from_xml_path(str(built_in_robots()["rr"]))
    model.opt.gravity[:] = 0
    data = mujoco.MjData(model)
    A = [0, 2]
    assert approach.link_velocity is not None
    data.qpos[:], data.qvel[:] = approach.q, approach.speed * approach.link_velocity
    rates = data.qvel[A].copy() * (controller.reference == "moving")
    summed, M = np.zeros(2), np.zeros((4, 4))

    def torques(time: float) -> Array:
        behind = approach.q[A] + rates * time - data.qpos[A]
        mujoco.mj_fullM(model, data, M)
        wanted = controller.proportional * behind + controller.integral * summed
        wanted = wanted + controller.derivative * (rates - data.qvel[A])
        summed[:] += step * behind
        applied = np.zeros(4)
        if time < controller.reaction_time:
            applied[A] = M[np.ix_(A, A)] @ wanted + data.qfrc_bias[A]
        return applied

    return impact_forces(model, data, "P", approach.direction, contact, duration, step, torques)


@pytest.mark.parametrize("reference", ["moving", "held"])
def test_controlled_rr_agrees_with_mujoco_before_and_after_the_reaction(
    reference: ControllerReference,
) -> None:
    model, approach = turned_by_both_motors()
    controller = replace(RR, reference=reference, reaction_time=0.006)
    ours = simulate_impact(model, approach, HEAD, "full", motors=controller, horizon=0.016)
    theirs = extrapolated(partial(forces_by_mujoco, approach, controller, HEAD, 0.0161))
    seen = ours.time <= 0.016  # a clamped body is followed further
    time, force = ours.time[seen], ours.force[seen]
    difference = force - np.interp(time, STEP * np.arange(len(theirs)), theirs)
    assert abs(difference).max() < 4e-4 * ours.first_contact  # at the first steps of touch


def test_the_reaction_is_an_event() -> None:
    model, approach = turned_by_both_motors()
    when = 0.00437

    def force(reaction_time: float) -> ImpactHistory:
        controller = replace(RR, reaction_time=reaction_time)
        return simulate_impact(model, approach, HEAD, "full", motors=controller, horizon=0.02)

    reacting, not_reacting = force(when), force(np.inf)
    assert when in reacting.time
    assert when not in not_reacting.time
    before = reacting.time <= when
    same = np.interp(reacting.time, not_reacting.time, not_reacting.force)
    assert abs(reacting.force - same)[before].max() < 2e-3 * reacting.first_contact
    assert abs(reacting.force - same)[~before].max() > 0.02 * reacting.first_contact


@pytest.mark.parametrize("reference", ["moving", "held"])
@pytest.mark.parametrize(
    "arm", ["rr", *(pytest.param(arm, marks=pytest.mark.slow) for arm in ("panda", "rmin"))]
)
def test_slow_controlled_impacts_are_linear(
    panda: Robot, arm: str, reference: ControllerReference
) -> None:
    cases: dict[str, Callable[[], tuple[ImpactModel, Approach]]] = {
        "rr": turned_by_both_motors,
        "rmin": r_min,
        "panda": partial(elastic_panda, panda),
    }
    model, approach = cases[arm]()
    controller = replace(R_MIN if arm == "rmin" else RR, reference=reference, reaction_time=0.004)
    errors = []
    for speed in (1e-2, 1e-3):
        slow = replace(approach, speed=speed)
        full, linear = (
            simulate_impact(model, slow, HEAD, fidelity, motors=controller).first_contact
            for fidelity in ("full", "linearised")
        )
        errors.append(abs(full / linear - 1))
    assert errors[1] < 1e-4
    assert errors[1] < 0.3 * errors[0]  # in proportion to speed


def test_proportional_control_of_a_standing_reference_is_k_p() -> None:
    """The gain that enters K0 (MSM's footnote 4) is this controller's."""
    model, approach = turned_by_both_motors(6050.0)
    slow = replace(approach, speed=1e-3)
    only_p = Controller(6050.0, 0.0, 0.0, "held", np.inf)
    controlled = simulate_impact(model, slow, CHEST, "full", motors=only_p)
    held = simulate_impact(model, slow, CHEST, "full", motors=Motors("held"))
    assert controlled.first_contact == pytest.approx(held.first_contact, rel=1e-5)
    linear = simulate_impact(model, slow, CHEST, "linearised", motors=only_p)
    modal = simulate_impact(model, slow, CHEST, "linearised", motors=Motors("held"))
    assert linear.first_contact == pytest.approx(modal.first_contact, rel=1e-7)


@pytest.mark.parametrize("reference", ["moving", "held"])
def test_a_controlled_chain_of_full_order_is_the_linear_robot(
    panda: Robot, reference: ControllerReference
) -> None:
    controller = replace(RR, reference=reference)
    model, approach = elastic_panda(panda)
    whole = simulate_impact(model, approach, CHEST, "linearised", motors=controller)
    chain = simulate_impact(model, approach, CHEST, "chain", order=model.size, motors=controller)
    assert chain.first_contact == pytest.approx(whole.first_contact, rel=1e-6)


def test_without_gains_only_potential_forces_are_held() -> None:
    """A controller of zero gains differs from a reaction at once by Coriolis forces alone."""
    model, approach = turned_by_both_motors()
    slow = replace(approach, speed=1e-3)
    nothing = Controller(0.0, 0.0, 0.0, "moving", np.inf)
    idle = simulate_impact(model, slow, CHEST, "full", motors=nothing)
    free = simulate_impact(model, slow, CHEST, "full")
    assert idle.first_contact == pytest.approx(free.first_contact, rel=1e-5)


def test_the_safe_speed_of_the_controlled_robot_gives_the_limit() -> None:
    model, approach = turned_by_both_motors()
    limit = body_region("chest").force_limit
    speed = largest_safe_speed(model, approach, CHEST, limit, "full", motors=RR)
    found = simulate_impact(model, replace(approach, speed=speed), CHEST, "full", motors=RR)
    assert found.first_contact == pytest.approx(limit, rel=1e-6)
    held = largest_safe_speed(
        model, approach, CHEST, limit, "full", motors=replace(RR, reference="held")
    )
    assert held > 1.05 * speed


BAD = [
    (replace(RR, proportional=-1.0), "controller.proportional"),
    (replace(RR, derivative=np.inf), "controller.derivative"),
    (replace(RR, integral=np.nan), "controller.integral"),
    (replace(RR, reaction_time=0.0), "controller.reaction_time"),
    (replace(RR, reaction_time=np.nan), "controller.reaction_time"),
]


@pytest.mark.parametrize(("controller", "field"), BAD)
def test_impossible_controllers_are_refused(controller: Controller, field: str) -> None:
    model, approach = turned_by_both_motors()
    with pytest.raises(InvalidValue) as refused:
        simulate_impact(model, approach, CHEST, "full", motors=controller)
    assert refused.value.field == field


def test_unknown_references_are_refused() -> None:
    model, approach = turned_by_both_motors()
    wrong = replace(RR, reference="waiting")  # type: ignore[arg-type]
    with pytest.raises(UnknownName, match="moving, held"):
        simulate_impact(model, approach, CHEST, "full", motors=wrong)


@pytest.mark.parametrize("options", [{"fidelity": "two_mass"}, {"fidelity": "one_mass"},
                                     {"fidelity": "chain", "end": "free"}])  # fmt: skip
def test_models_without_motors_take_no_controller(options: dict[str, str]) -> None:
    model, approach = turned_by_both_motors()
    with pytest.raises(InvalidValue, match=r"motors|controller"):
        simulate_impact(model, approach, CHEST, **options, motors=RR)  # type: ignore[arg-type]
