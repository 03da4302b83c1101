# SPDX-License-Identifier: BSD-3-Clause
"""The factors of every pose at one tip with one set of rotors (GIAF Fig. 1-4)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from softimpact.symbolic.robot.rigid import Array

from .functions import FactorFunctions

SCALES = (0.25, 0.5, 1.0, 2.0, 4.0)
"""Reflected inertias of the sweep, as multiples of the set's."""

RATIOS = (0.5, 0.75, 1.0, 1.5, 2.0)
"""Gear ratios of the sweep, as multiples of the robot's; inertia grows with their square."""

ANGLES = np.linspace(0.0, 2 * np.pi, 361)
"""Directions of the polar plot [rad]."""

PLANES = ("base_xy", "base_xz", "tip_xy", "tip_xz")
"""Planes of the polar plot, by the frame in whose axes they lie; angles count from its x."""


@dataclass(frozen=True, eq=False)
class PoseFactors:
    """Factors of P poses for one tip and one set of rotors.

    Attributes:
        giaf: ζ, length P (GIAF Fig. 1).
        inertia_sweep: ζ with reflected inertias times ``SCALES``, P×S (Fig. 2, top).
        gear_sweep: ζ with gear ratios times ``RATIOS``, P×S (Fig. 2, bottom).
        single_joint_giaf: P×n (Fig. 3).
        directional_giaf: along the study's direction, length P.
        mass_free: the elastic robot's m_c along it, length P [kg].
        mass_rigid: the rigid robot's, length P [kg].
        polar: ζ_x of the first pose at ``ANGLES`` in each of ``PLANES`` (Fig. 4).
    """

    giaf: Array
    inertia_sweep: Array
    gear_sweep: Array
    single_joint_giaf: Array
    directional_giaf: Array
    mass_free: Array
    mass_rigid: Array
    polar: Mapping[str, Array]


def pose_factors(
    functions: FactorFunctions,
    poses: Sequence[Array],
    rotors: Array,
    direction: Array,
    tip_axes: Array,
) -> PoseFactors:
    """Return the factors of poses.

    Args:
        functions: of the robot and tip.
        poses: link angles, each of length n.
        rotors: reflected inertias, length n [kg m²].
        direction: of the impact, length 3.
        tip_axes: rotation of the tip in the first pose, 3×3.
    """
    found = [functions.at(q, rotors, direction) for q in poses]

    def sweep(factors: Sequence[float]) -> Array:
        return np.array(
            [[functions.at(q, f * rotors, direction).giaf for f in factors] for q in poses]
        )

    def polar(axes: Array, plane: str) -> Array:
        first, second = (axes[:, "xyz".index(axis)] for axis in plane)
        directions = np.outer(np.cos(ANGLES), first) + np.outer(np.sin(ANGLES), second)
        return np.array([functions.at(poses[0], rotors, x).directional_giaf for x in directions])

    return PoseFactors(
        giaf=np.array([f.giaf for f in found]),
        inertia_sweep=sweep(SCALES),
        gear_sweep=sweep([r**2 for r in RATIOS]),
        single_joint_giaf=np.array([f.single_joint_giaf for f in found]),
        directional_giaf=np.array([f.directional_giaf for f in found]),
        mass_free=np.array([f.mass_free for f in found]),
        mass_rigid=np.array([f.mass_rigid for f in found]),
        polar={
            name: polar(tip_axes if name.startswith("tip") else np.eye(3), name[-2:])
            for name in PLANES
        },
    )
