# SPDX-License-Identifier: BSD-3-Clause
"""The factors of a robot at one tip as compiled functions of posture and rotors."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, directional_giaf, giaf, single_joint_giaf
from softimpact.symbolic.robot.rigid import Array


@dataclass(frozen=True, eq=False)
class FactorFunctions:
    """Functions of link angles q, reflected rotor inertias B and a direction n."""

    function: ca.Function

    def at(self, q: Array, rotors: Array, direction: Array) -> PostureFactors:
        """Return the factors of one configuration."""
        zeta, alone, along, free, rigid = self.function(q, rotors, direction)
        return PostureFactors(
            giaf=float(zeta),
            single_joint_giaf=np.array(alone).ravel(),
            directional_giaf=float(along),
            mass_free=float(free),
            mass_rigid=float(rigid),
        )


@dataclass(frozen=True, eq=False)
class PostureFactors:
    """Factors of one configuration.

    Attributes:
        giaf: ζ (GIAF Eq. 28).
        single_joint_giaf: ζ_i with one rotor alone, length n.
        directional_giaf: ζ_x along the impact (GIAF Eq. 29).
        mass_free: (nᵀΛ_F⁻¹n)⁻¹, the elastic robot's m_c [kg].
        mass_rigid: (nᵀΛ⁻¹n)⁻¹ [kg].
    """

    giaf: float
    single_joint_giaf: Array
    directional_giaf: float
    mass_free: float
    mass_rigid: float

    @property
    def mass_ratio(self) -> float:
        """nᵀΛ⁻¹n / nᵀΛ_F⁻¹n, where the two papers meet."""
        return self.mass_free / self.mass_rigid


def factor_functions(model: ImpactModel) -> FactorFunctions:
    """Return the factors of a model's robot and tip; its own rotors do not count."""
    q, n = ca.SX.sym("q", model.robot.n), ca.SX.sym("n", 3)
    rotors = ca.SX.sym("B", model.robot.n)
    geared = replace(model, drives=replace(model.drives, rotors=rotors))
    free, real = geared.free_mobility(q), geared.mobility(q)
    masses = [1 / ca.bilin(mobility.matrix, n, n) for mobility in (free, real)]
    outputs = [
        giaf(free, real),
        single_joint_giaf(geared.mass_matrix(q), rotors, geared.jacobian(q)),
        directional_giaf(free, real, n),
        *masses,
    ]
    return FactorFunctions(ca.Function("factors", [q, rotors, n], ca.cse(outputs)))
