# SPDX-License-Identifier: BSD-3-Clause
"""Functions of the robot with its base set free: what its joints spare it of an impact."""

from __future__ import annotations

import casadi as ca

from softimpact.symbolic import (
    contact_mobility,
    contact_point_jacobian,
    floating_robot,
    giaf,
)
from softimpact.symbolic import impact_mitigation as mitigation
from softimpact.symbolic.impact.floating import BASE_COORDINATES

from .description import CFunction, Output
from .guards import movable_in_space
from .symbols import Symbols, function_over


def impact_mitigation(s: Symbols) -> CFunction:
    """Return ξ, Ξ and their kin; where the base is and how it is turned does not matter."""
    free = floating_robot(s.robot)
    M = free.mass_matrix(s.q)
    J = contact_point_jacobian(free.freed, s.model.tip, free.coordinates(s.q))
    rotors = ca.vertcat(ca.DM(BASE_COORDINATES, 1), s.values["rotor_inertia"])
    found, without = mitigation(M + ca.diag(rotors), J), contact_mobility(M, J)
    absorption = "absorption factor (GIAF Eq. 28)"
    outputs = (
        Output("imf", found.factor, "dimensionless", "xi = det Xi (GIAF Eq. 21)", scale=1.0),
        Output("Xi", found.matrix, "dimensionless", "I - Lambda Lambda_L^-1 (GIAF Eq. 20)"),
        Output("giaf", giaf(without, found.real), "dimensionless", absorption, scale=1.0),
        Output("Lambda", found.real.inertia, "kg", "with rotors (GIAF Eq. 13)", symmetric=True),
        Output("Lambda_L", found.locked.inertia, "kg", "joints locked", symmetric=True),
    )
    mobilities = (found.real, without)
    guards = tuple(movable_in_space(s.robot, mobility.inertia) for mobility in mobilities)
    summary = "Impact mitigation of the robot with its base set free, in the base's axes."
    return function_over(s, "impact_mitigation", summary, outputs, guards)
