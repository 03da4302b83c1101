# SPDX-License-Identifier: BSD-3-Clause
"""Functions of the arm's shape: manipulability, force measure and dynamic impact measure."""

from __future__ import annotations

import casadi as ca

from softimpact.symbolic import Matrix
from softimpact.symbolic.factors import ellipsoids
from softimpact.symbolic.matrices import symmetric

from .description import CFunction, Guard, Output
from .symbols import Symbols, function_over

LEAST_MANIPULABILITY = 1e-3
"""Share of the product of the lengths of J's rows below which ω_m counts as zero."""


def manipulability(s: Symbols) -> CFunction:
    """Return ω_m and J Jᵀ; they have a value at every configuration."""
    J = s.jacobian
    omega_m, most = ellipsoids.manipulability(J), ellipsoids.longest_manipulability(J)
    JJ = symmetric(lambda i, j: ca.dot(J[i, :], J[j, :]), 3)
    outputs = (
        Output("omega_m", omega_m, "m^3/rad^3", "0 where singular (GIAF Eq. 2)", scale=most),
        Output("JJ", JJ, "m^2/rad^2", "J J', base axes", symmetric=True),
    )
    summary = "Manipulability and the matrix of its ellipsoid {(J J')^(1/2) u: |u| <= 1}."
    return function_over(s, "manipulability", summary, outputs)


def force_measure(s: Symbols) -> CFunction:
    """Return ω_f."""
    J = s.jacobian
    output = Output("omega_f", ellipsoids.force_measure(J), "rad^3/m^3", "")
    summary = "Force measure 1/omega_m (GIAF Eq. 3)."
    return function_over(s, "force_measure", summary, (output,), (_upright(J),))


def impact_measure(s: Symbols) -> CFunction:
    """Return ω_di and the matrix of the dynamic impact ellipsoid."""
    H, J = s.rotor_mass_matrix, s.jacobian
    omega_di, E = ellipsoids.dynamic_impact_measure(H, J), ellipsoids.impact_matrix(H, J)
    outputs = (
        Output("omega_di", omega_di, "kg^3 m^3", "sqrt(det E)"),
        Output("E", E, "kg^2 m^2", "(H J+)' (H J+), base axes", symmetric=True),
    )
    summary = "Dynamic impact measure and the matrix of its ellipsoid, with rotors (GIAF Eq. 15)."
    return function_over(s, "impact_measure", summary, outputs, (_upright(J),))


def _upright(J: Matrix) -> Guard:
    """Guard the rank of J."""
    return Guard(
        ellipsoids.manipulability(J) / ellipsoids.longest_manipulability(J), LEAST_MANIPULABILITY
    )
