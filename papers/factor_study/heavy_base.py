# SPDX-License-Identifier: BSD-3-Clause
"""Why IMF does not apply to fixed bases: on a floating base of growing mass ξ goes to one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

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
from softimpact.symbolic.robot.rigid import Array, Inertia

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


def on_heavy_base(
    model: ImpactModel, poses: Sequence[Array], rotor_sets: Mapping[str, Array]
) -> dict[str, HeavyBase]:
    """Return the factors of a fixed robot put on floating bases, by set of rotors.

    Args:
        model: robot and tip.
        poses: link angles, each of length n.
        rotor_sets: reflected inertias by name, length n each [kg m²].
    """
    functions = [_on_base(model, mass) for mass in MASSES]

    def of(rotors: Array) -> HeavyBase:
        found = np.array(
            [[np.array(on_base(q, rotors)).ravel() for on_base in functions] for q in poses]
        )
        return HeavyBase(1 - found[:, :, 0], found[:, :, 1])

    return {name: of(rotors) for name, rotors in rotor_sets.items()}


def _on_base(model: ImpactModel, mass: float) -> ca.Function:
    """Return (ξ, ζ) of link angles and rotors, on a base of a given mass."""
    base = Inertia.from_center_of_mass(mass, np.zeros(3), 0.4 * mass * RADIUS**2 * np.eye(3))
    robot = floating_robot(model.robot, base)
    q, rotors = ca.SX.sym("q", model.robot.n), ca.SX.sym("B", model.robot.n)
    geared = replace(drives(model.robot), rotors=rotors)
    floating = floating_model(robot, model.tip, drives=geared)
    x = robot.coordinates(q)
    xi = impact_mitigation(floating.rotor_mass_matrix(x), floating.jacobian(x)).factor
    zeta = giaf(floating.free_mobility(x), floating.mobility(x))
    return ca.Function("on_base", [q, rotors], [ca.cse(ca.vertcat(xi, zeta))])
