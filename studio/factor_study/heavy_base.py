# SPDX-License-Identifier: BSD-3-Clause
"""Why IMF does not apply to fixed bases: on a floating base of growing mass ξ goes to one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from softimpact.symbolic import (
    ImpactModel,
    drives,
    floating_model,
    floating_robot,
    giaf,
    impact_mitigation,
)
from softimpact.symbolic.rigid import Array, Inertia

MASSES = tuple(float(m) for m in np.logspace(0, 8, 17))
"""Masses of the base [kg]."""

RADIUS = 0.3
"""Of the base, a solid ball around its origin [m]."""


@dataclass(frozen=True, eq=False)
class HeavyBase:
    """IMF and GIAF on a floating base, P poses by M masses.

    Attributes:
        not_mitigated: 1 − ξ.
        giaf: ζ of the floating robot.
    """

    not_mitigated: Array
    giaf: Array


def on_heavy_base(model: ImpactModel, poses: Sequence[Array], rotors: Array) -> HeavyBase:
    """Return the factors of a fixed robot put on floating bases.

    Args:
        model: robot and tip.
        poses: link angles, each of length n.
        rotors: reflected inertias, length n [kg m²].
    """
    found = np.array([_on_base(model, poses, rotors, mass) for mass in MASSES])
    return HeavyBase(1 - found[:, :, 0].T, found[:, :, 1].T)


def _on_base(
    model: ImpactModel, poses: Sequence[Array], rotors: Array, mass: float
) -> list[tuple[float, float]]:
    base = Inertia.from_center_of_mass(mass, np.zeros(3), 0.4 * mass * RADIUS**2 * np.eye(3))
    robot = floating_robot(model.robot, base)
    given = drives(model.robot, rotor_inertia=rotors)
    floating = floating_model(robot, model.tip, drives_=given)
    q = ca.SX.sym("q", model.robot.n)
    x = robot.coordinates(q)
    xi = impact_mitigation(floating.rotor_mass_matrix(x), floating.jacobian(x)).factor
    zeta = giaf(floating.free_mobility(x), floating.mobility(x))
    function = ca.Function("on_base", [q], ca.cse([xi, zeta]))
    return [(float(xi), float(zeta)) for xi, zeta in (function(q) for q in poses)]
