# SPDX-License-Identifier: BSD-3-Clause
"""R-Min's nonlinear impacts: against MuJoCo, against the linear models, and its loop."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from mujoco_impacts import node_after

from softimpact.robots import built_in_robots
from softimpact.simulate import Approach, simulate_impact
from softimpact.simulate.approach import arrival_of
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    body_region,
    configuration_at_rest,
    drives,
    gravity_torques,
    impact_model,
    load_robot,
    loop_tangent,
)

GRAVITY = (0.0, 0.0, -9.81)
MOTORS = np.radians([-130.6, -50.0])


def r_min(tip: str, gain: float | None = None) -> tuple[ImpactModel, Approach]:
    robot = load_robot("rmin")
    model = impact_model(
        robot, tip, drives_=drives(robot, computed_torque_gain=gain), gravity=GRAVITY
    )
    q = configuration_at_rest(model, MOTORS)
    return model, Approach(q, np.array([-1.0, 0.0, 0.0]), 1.0)


def peak_by_mujoco(
    model: ImpactModel, approach: Approach, contact: Contact, duration: float
) -> tuple[float, float]:
    """Return the largest force with constant motor torques, and the widest gap of the loop."""
    other = mujoco.MjModel.from_xml_path(str(built_in_robots()["rmin"]))
    other.opt.timestep = step = 5e-6
    other.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    other.eq_solref[:] = [2 * step, 1.0]
    other.eq_solimp[:, :2] = 0.9999
    data = mujoco.MjData(other)
    G = np.array(loop_tangent(model.robot, approach.q))
    weight = np.array(gravity_torques(model.robot, approach.q, GRAVITY)).ravel()
    motors = np.zeros(model.robot.n)
    motors[list(model.independent)] = (G.T @ weight) * np.array(model.actuated)
    data.qpos[:] = approach.q
    data.qvel[:] = G @ arrival_of(model, approach).link_velocity * approach.speed
    mujoco.mj_forward(other, data)
    point = other.site(model.tip)
    start, body = data.site_xpos[point.id].copy(), int(np.ravel(point.bodyid)[0])
    n, x_0, highest, widest = approach.direction, 0.0, 0.0, 0.0
    for _ in range(round(duration / step)):
        x_c = float(n @ (data.site_xpos[point.id] - start))
        x_0 = node_after(step, x_0, x_c, contact)
        force = contact.hertz_stiffness * max(x_c - x_0, 0.0) ** 1.5
        highest = max(highest, force)
        data.qfrc_applied[:] = motors
        mujoco.mj_applyFT(
            other, data, -force * n, np.zeros(3), data.site_xpos[point.id], body, data.qfrc_applied
        )
        mujoco.mj_step(other, data)
        ends = data.site_xpos[other.site("P").id] - data.site_xpos[other.site("P_of_arm_2").id]
        widest = max(widest, float(np.linalg.norm(ends)))
    return highest, widest


@pytest.mark.parametrize("tip", ["P", "O13"])
@pytest.mark.parametrize("region", ["head", "chest"])
def test_r_min_agrees_with_mujoco(tip: str, region: str) -> None:
    """MuJoCo holds the loop softly, but at this step to a nanometre."""
    model, approach = r_min(tip)
    contact = Contact(body_region(region))
    ours = simulate_impact(model, approach, contact, "full")
    duration = ours.time_of_first_contact_peak + 5e-4
    theirs, gap = peak_by_mujoco(model, approach, contact, duration)
    assert gap < 1e-4
    assert ours.first_contact == pytest.approx(theirs, rel=5e-3)
