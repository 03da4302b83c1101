# SPDX-License-Identifier: BSD-3-Clause
"""What impacts start from: masses, the model's own springs and the contact points' motions."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca

from softimpact.symbolic import Matrix, contact_point_jacobian, loop_tangent

from ..inputs.parameters import is_elastic
from .description import CFunction, Output
from .symbols import Symbols, function_over


def has_potential(s: Symbols) -> bool:
    """Whether gravity or springs of the model file pull on the links."""
    return s.robot.has_springs or any(s.model.gravity)


def links_of(s: Symbols, points: tuple[str, ...]) -> CFunction:
    """Return M, the curvature K of the model's own potential, and J of each contact point.

    They are over the independent joints. M is the links' own where springs are between them and
    the rotors, and holds the rotors where joints are rigid.

    Args:
        s: symbols of the package.
        points: frames of the contact points.
    """
    M = s.mass_matrix if is_elastic(s.robot) else s.model.generalised_mass(s.q).matrix
    outputs = [Output("M", ca.densify(M), "kg m^2", "over the joints", symmetric=True)]
    if has_potential(s):
        K = ca.densify(ca.SX(s.model.potential_stiffness(s.q)))
        outputs.append(Output("K", K, "N m/rad", "of springs and gravity", symmetric=True))
    J = ca.vertcat(*[_jacobian(s, point) for point in points])
    outputs.append(Output("J", ca.densify(J), "m/rad", "three rows a contact point, base axes"))
    built = function_over(s, "links", "Links as they arrive at an impact.", tuple(outputs))
    return replace(built, open_ended=True)


def _jacobian(s: Symbols, point: str) -> Matrix:
    J = contact_point_jacobian(s.robot, point, s.q)
    return ca.mtimes(J, loop_tangent(s.robot, s.q)) if s.robot.loops else J
