# SPDX-License-Identifier: BSD-3-Clause
"""R-Min's nonlinear impacts: against MuJoCo, against the linear models, and its loop."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from impact_cases import EARTH, r_min
from mujoco_impacts import extrapolated, impact_forces

from softimpact.robots import built_in_robots
from softimpact.simulate import Approach, simulate_impact
from softimpact.simulate.arrival import arrival_of
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    body_region,
    gravity_torques,
    loop_tangent,
)
from softimpact.symbolic.robot.rigid import Array


def peak_by_mujoco(
    model: ImpactModel, approach: Approach, contact: Contact, duration: float
) -> tuple[float, float]:
    """Return the largest force with constant motor torques, and the widest gap of the loop."""
    G = np.array(loop_tangent(model.robot, approach.q))
    weight = np.array(gravity_torques(model.robot, approach.q, EARTH)).ravel()
    motors = np.zeros(model.robot.n)
    motors[list(model.independent)] = (G.T @ weight) * np.array(model.actuated)
    gaps = []

    def forces(step: float) -> Array:
        other = mujoco.MjModel.from_xml_path(str(built_in_robots()["rmin"]))
        other.eq_solref[:] = [2 * step, 1.0]
        other.eq_solimp[:, :2] = 0.9999
        data = mujoco.MjData(other)
        data.qpos[:] = approach.q
        data.qvel[:] = G @ arrival_of(model, approach).link_velocity * approach.speed

        def torques(_: float) -> Array:
            ends = data.site("P").xpos - data.site("P_of_arm_2").xpos
            gaps.append(float(np.linalg.norm(ends)))
            return motors

        n = approach.direction
        return impact_forces(other, data, model.tip, n, contact, duration, step, torques)

    return float(extrapolated(forces).max()), max(gaps)


@pytest.mark.parametrize("tip", ["P", "O13"])
@pytest.mark.parametrize("region", ["head", "chest"])
def test_r_min_agrees_with_mujoco(tip: str, region: str) -> None:
    """MuJoCo holds the loop softly, but at these steps to some nanometres."""
    model, approach = r_min(tip)
    contact = Contact(body_region(region))
    ours = simulate_impact(model, approach, contact, "full")
    duration = ours.time_of_first_contact_peak + 5e-4
    theirs, gap = peak_by_mujoco(model, approach, contact, duration)
    assert gap < 1e-8
    assert ours.first_contact == pytest.approx(theirs, rel=5e-5)
