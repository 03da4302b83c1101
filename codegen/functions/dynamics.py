# SPDX-License-Identifier: BSD-3-Clause
"""Functions of the dynamics: M, J, and M0, K0, J_c over the generalised coordinates."""

from __future__ import annotations

import casadi as ca

from .description import CFunction, Output
from .symbols import Symbols, function_over


def mass_matrix(s: Symbols) -> CFunction:
    """Return M(q)."""
    M = Output("M", s.mass_matrix, "kg m^2", "links only", symmetric=True)
    return function_over(s, "mass_matrix", "Mass matrix M(q) of the links, without rotors.", (M,))


def jacobian(s: Symbols) -> CFunction:
    """Return J(q)."""
    J = Output("J", s.jacobian, "m/rad", "base axes")
    summary = "Translational Jacobian J(q) of the contact point: velocity = J dq/dt."
    return function_over(s, "jacobian", summary, (J,))


def generalised_mass_matrix(s: Symbols) -> CFunction:
    """Return M0(q)."""
    M0 = s.model.generalised_mass(s.q).matrix
    output = Output("M0", ca.densify(M0), "kg m^2", "", symmetric=True)
    summary = "Mass matrix M0 over the generalised coordinates (MSM Eq. 42)."
    return function_over(s, "generalised_mass_matrix", summary, (output,))


def stiffness_matrix(s: Symbols) -> CFunction:
    """Return K0(q)."""
    K0 = ca.densify(s.model.generalised_stiffness(s.q))
    output = Output("K0", K0, "N m/rad", "", symmetric=True)
    summary = "Stiffness matrix K0 over the generalised coordinates (MSM Eq. 45)."
    return function_over(s, "stiffness_matrix", summary, (output,))


def contact_jacobian(s: Symbols) -> CFunction:
    """Return J_c(q, n)."""
    row = ca.densify(s.model.contact_jacobian(s.q, s.n))
    summary = "Row J_c = n'J over the generalised coordinates (MSM Eq. 4)."
    return function_over(s, "contact_jacobian", summary, (Output("J_c", row, "m/rad", ""),))
