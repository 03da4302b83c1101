# SPDX-License-Identifier: BSD-3-Clause
"""Functions that stand for the robot along n: one mass, two masses and a spring, a chain."""

from __future__ import annotations

import casadi as ca

from .description import CFunction, Guard, Output
from .guards import movable
from .symbols import Symbols, function_over

CHAIN_ENDS = 1e-10
"""Square of the share of a mass's pull that must reach further masses for a chain to go on."""


def reflected_mass(s: Symbols) -> CFunction:
    """Return m_c(q, n)."""
    m_c = s.model.reflected_mass(s.q, s.n)
    output = Output("m_c", m_c, "kg", "mass felt at the contact point")
    summary = "Mass m_c that the contact point feels along n (MSM Eq. 36)."
    guards = (movable(s.robot, m_c),)
    return function_over(s, "reflected_mass", summary, (output,), guards)


def reduced_model(s: Symbols) -> CFunction:
    """Return m_c, k_r and m_a."""
    reduced = s.model.reduced(s.q, s.n)
    outputs = (
        Output("m_c", reduced.m_c, "kg", "mass felt at the contact point"),
        Output("k_r", reduced.k_r, "N/m", "reflected stiffness"),
        Output("m_a", reduced.m_a, "kg", "mass on the actuators' side"),
    )
    summary = "Two masses and a spring that stand for the robot along n (MSM Eq. 36-38)."
    guards = (movable(s.robot, reduced.m_c),)
    return function_over(s, "reduced_model", summary, outputs, guards)


def chain(s: Symbols, order: int) -> CFunction:
    """Return the masses and springs of a chain."""
    found = s.model.chain(s.q, s.n, order)
    mass, k = list(found.mass), list(found.stiffness)
    guards = [movable(s.robot, mass[0])]
    for i in range(1, order):  # how much of the pull of mass i goes on to the next
        own = (k[i - 1] + k[i - 2] if i > 1 else k[i - 1]) ** 2 / mass[i - 1]
        guards.append(Guard(k[i - 1] ** 2 / (mass[i] * own), CHAIN_ENDS))
    outputs = (
        Output("mass", ca.vertcat(*mass), "kg", "the contact force acts on the first"),
        Output("stiffness", ca.vertcat(*k), "N/m", "[i] joins mass i and i+1; last to ground"),
    )
    summary = f"Chain of {order} masses that stands for the robot along n."
    return function_over(s, "chain", summary, outputs, tuple(guards))
