# SPDX-License-Identifier: BSD-3-Clause
"""Bodies, poses and robots whose impacts several tests simulate."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from softimpact.simulate import Approach, simulate_impact
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    body_region,
    configuration_at_rest,
    drives,
    impact_model,
    load_robot,
)

HEAD = Contact(body_region("head"))
FREE_HEAD = Contact(body_region("head"), clamped=False)
CHEST = Contact(body_region("chest"))
POSE = np.array([0.1, -0.3, 0.2, -2.0, 0.3, 2.0, 0.5])
"""The Panda away from singular poses."""
ALONG_Y = np.array([0.0, 1.0, 0.0])
EARTH = (0.0, 0.0, -9.81)


def r_min(tip: str = "O13", gain: float | None = None) -> tuple[ImpactModel, Approach]:
    """Return R-Min sagging under gravity in MSM's pose, about to hit along −x at 1 m/s."""
    robot = load_robot("rmin")
    given = drives(robot, computed_torque_gain=gain)
    model = impact_model(robot, tip, drives=given, gravity=EARTH)
    q = configuration_at_rest(model, np.radians([-130.6, -50.0]))
    return model, Approach(q, [-1.0, 0.0, 0.0], 1.0)


def sliding_mass(mass: float) -> ImpactModel:
    """Return a mass that slides along x."""
    xml = f"""
    <mujoco><worldbody><body name="slider">
      <joint type="slide" axis="1 0 0"/><geom size="0.1" mass="{mass!r}"/><site name="tip"/>
    </body></worldbody></mujoco>"""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "slider.xml"
        path.write_text(xml, encoding="utf-8")
        return impact_model(load_robot(path), "tip")


def peak_of_one_mass(mass: float, speed: float, contact: Contact) -> float:
    """Return the largest force of a lone mass until it bounces off [N]."""
    approach = Approach([0.0], [1.0, 0.0, 0.0], speed, [1.0])
    return simulate_impact(sliding_mass(mass), approach, contact, horizon=None).first_contact
