# SPDX-License-Identifier: BSD-3-Clause
"""Impacts of robots that MuJoCo steps; the body's side is integrated beside it."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np

from softimpact.symbolic import Contact
from softimpact.symbolic.robot.rigid import Array

STEP = 1e-5
"""Longer of the two time steps [s]."""


def extrapolated(forces: Callable[[float], Array]) -> Array:
    """Return the force at every ``STEP`` [N] without the integrators' error of first order.

    Args:
        forces: the force at every step, for a step [s] (Richardson).
    """
    whole, half = forces(STEP), forces(STEP / 2)[::2]
    length = min(len(whole), len(half))
    return np.asarray(2 * half[:length] - whole[:length])


def impact_forces(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    site: str,
    direction: Array,
    contact: Contact,
    duration: float,
    step: float,
    torques: Callable[[float], Array | float] = lambda _: 0.0,
) -> Array:
    """Step an impact and return the contact force at every step [N].

    Args:
        model: of the robot.
        data: its state at first touch.
        site: that hits.
        direction: unit vector n.
        contact: with the body, clamped.
        duration: in s.
        step: in s.
        torques: applied to the joints at a time [s].
    """
    model.opt.timestep = step
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    mujoco.mj_forward(model, data)
    point = model.site(site)
    start, body = data.site_xpos[point.id].copy(), int(np.ravel(point.bodyid)[0])
    x_0, forces = 0.0, []
    for i in range(round(duration / step)):
        place = data.site_xpos[point.id]
        x_c = float(direction @ (place - start))
        x_0 = _node_after(step, x_0, x_c, contact)
        forces.append(contact.hertz_stiffness * max(x_c - x_0, 0.0) ** 1.5)
        data.qfrc_applied[:] = torques(i * step)
        push = -forces[-1] * direction
        mujoco.mj_applyFT(model, data, push, np.zeros(3), place, body, data.qfrc_applied)
        mujoco.mj_step(model, data)
    return np.array(forces)


def _node_after(step: float, x_0: float, x_c: float, contact: Contact) -> float:
    """Implicit Euler step of c_h ẋ_0 = f_c − k_h x_0."""
    k_f, k_h, c_h = contact.hertz_stiffness, contact.region.stiffness, contact.region.damping
    x = x_0
    for _ in range(8):
        depth = max(x_c - x, 0.0)
        residual = c_h * (x - x_0) / step - k_f * depth**1.5 + k_h * x
        x -= residual / (c_h / step + 1.5 * k_f * depth**0.5 + k_h)
    return x
