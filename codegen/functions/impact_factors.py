# SPDX-License-Identifier: BSD-3-Clause
"""Functions of the operational space inertia: Λ, Λ_F, impact factors, and their directions."""

from __future__ import annotations

from dataclasses import replace

from softimpact.symbolic import (
    Matrix,
    contact_mobility,
    directional_giaf,
    extreme_directional_giaf,
    giaf,
    giif,
)
from softimpact.symbolic.matrices import count_flops
from softimpact.symbolic.robot.robot import BASE

from .description import CFunction, Guard, Output
from .guards import movable_in_space
from .symbols import Symbols, function_over


def osim(s: Symbols) -> CFunction:
    """Return Λ and Λ_F."""
    real, free = s.mobility, s.free_mobility
    outputs = (
        Output("Lambda", real.inertia, "kg", "with rotors (GIAF Eq. 13)", symmetric=True),
        Output("Lambda_F", free.inertia, "kg", "without (GIAF Eq. 24)", symmetric=True),
    )
    summary = "Operational space inertias of the contact point, in the base's axes."
    return function_over(s, "osim", summary, outputs, _in_space(s, real.inertia, free.inertia))


def impact_factors(s: Symbols) -> CFunction:
    """Return GIAF and GIIF in the axes in which they take the fewest operations.

    Those are the first joint's, where J has most zeros, or those in which J itself takes fewest.
    """
    found = (_impact_factors_in(s, axes) for axes in axes_of_factors(s))
    return min(found, key=lambda function: function.flops)


def axes_of_factors(s: Symbols) -> list[int]:
    """Return the joints in whose axes, or the base's, the factors may be."""
    robot = s.robot
    path = robot.ancestors(robot.frame(s.model.tip).joint)
    leanest = min(reversed(path), key=lambda axes: count_flops(s.model.jacobian(s.q, axes)))
    return list(dict.fromkeys((BASE, min(path), leanest)))


def _impact_factors_in(s: Symbols, axes: int) -> CFunction:
    J = s.model.jacobian(s.q, axes)
    real, free = contact_mobility(s.rotor_mass_matrix, J), contact_mobility(s.mass_matrix, J)
    absorption, increment = "absorption factor (GIAF Eq. 28)", "increment factor (GIAF Eq. 27)"
    outputs = (
        Output("giaf", giaf(free, real), "dimensionless", absorption, scale=1.0),
        Output("giif", giif(free, real), "dimensionless", increment, scale=1.0),
    )
    guards = _in_space(s, real.inertia, free.inertia)
    return function_over(s, "giaf", "Generalised impact factors.", outputs, guards)


def directional_factor(s: Symbols) -> CFunction:
    """Return GIAF along n."""
    real, free = s.mobility, s.free_mobility
    value = directional_giaf(free, real, s.n)
    guards = _in_space(s, real.inertia, free.inertia)
    output = Output("giaf", value, "dimensionless", "1 if rotors do not count", scale=1.0)
    summary = "Share of the inertia along n that is not the rotors' (GIAF Eq. 29)."
    return function_over(s, "directional_giaf", summary, (output,), guards)


def absorption_extremes(s: Symbols) -> CFunction:
    """Return the least and the greatest GIAF along a direction, and where they are."""
    real, free = s.mobility, s.free_mobility
    found = extreme_directional_giaf(free, real)
    one_of_many = "unit vector; where two values meet, one of many"
    outputs = (
        Output("least", found.least, "dimensionless", "smallest value", scale=1.0),
        Output("greatest", found.greatest, "dimensionless", "largest value", scale=1.0),
        Output("least_direction", found.least_direction, "dimensionless", one_of_many),
        Output("greatest_direction", found.greatest_direction, "dimensionless", "the same for it"),
    )
    guards = _in_space(s, real.inertia, free.inertia)
    summary = "Directions of least and greatest absorption, base axes (GIAF Eq. 29)."
    extremes = function_over(s, "absorption_extremes", summary, outputs, guards)
    return replace(extremes, divides=True)  # directions magnify rounding


def _in_space(s: Symbols, *inertias: Matrix) -> tuple[Guard, ...]:
    return tuple(movable_in_space(s.robot, inertia) for inertia in inertias)
