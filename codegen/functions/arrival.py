# SPDX-License-Identifier: BSD-3-Clause
"""What impacts start from: a chain or the whole linear robot, and the velocities at touch."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca

from softimpact.symbolic import Matrix

from ..approach import approach_rates, directions_of_motion
from ..description import CFunction, Output
from .guards import arriving
from .symbols import Symbols, function_over


def impact_chain_of(s: Symbols, order: int) -> CFunction | None:
    """Return what a package's impacts start from: masses, springs and velocities of a chain.

    None if motors cannot move the contact point along n alone, or only in directions that depend
    on the configuration.
    """
    directions = directions_of_motion(s.model)
    if directions is None:
        return None
    chain = s.model.chain(s.q, s.n, order, reorthogonalise="once")
    mass: Matrix = ca.vertcat(*chain.mass)
    rates = approach_rates(s.model, s.q, s.n, directions)
    motors = chain.displacement[: rates.numel(), :]
    velocity = ca.mtimes(motors.T, rates)
    outputs = (
        Output("mass", mass, "kg", "the contact force acts on the first"),
        Output("stiffness", ca.vertcat(*chain.stiffness), "N/m", "to the next, last to ground"),
        Output("velocity", velocity, "m/s", "at first touch, for an approach of 1 m/s"),
    )
    guards = arriving(s.model, s.n, mass[0], rates, directions)
    summary = f"Chain of {order} masses as it arrives at an impact; it may end before its last."
    built = function_over(s, "impact_chain", summary, outputs, guards)
    return replace(built, open_ended=True)


def linear_model_of(s: Symbols) -> CFunction | None:
    """Return M0, K0, J_c and all velocities, by which chains are judged.

    None as ``impact_chain_of``.
    """
    directions = directions_of_motion(s.model)
    if directions is None:
        return None
    linear = s.model.linear(s.q, s.n)
    rates = approach_rates(s.model, s.q, s.n, directions)
    velocity = ca.vertcat(rates, ca.SX(s.model.size - rates.numel(), 1))
    outputs = (
        Output("M0", ca.densify(linear.mass.matrix), "kg m^2", ""),
        Output("K0", ca.densify(linear.stiffness), "N m/rad", ""),
        Output("J_c", ca.densify(linear.jacobian), "m/rad", ""),
        Output("velocity", ca.densify(velocity), "rad/s", ""),
    )
    m_c = s.model.reflected_mass(s.q, s.n)
    guards = arriving(s.model, s.n, m_c, rates, directions)
    return function_over(s, "linear_model", "Linear model.", outputs, guards)
