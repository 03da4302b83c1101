# SPDX-License-Identifier: BSD-3-Clause
"""Which functions a robot's package has."""

from __future__ import annotations

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel

from .description import CFunction
from .dynamics import (
    contact_jacobian,
    generalised_mass_matrix,
    jacobian,
    mass_matrix,
    stiffness_matrix,
)
from .impact_factors import absorption_extremes, directional_factor, impact_factors, osim
from .joints import joint_impulse, rotor_influence, single_joint
from .linearity import linear_error
from .measures import force_measure, impact_measure, manipulability
from .mitigation import impact_mitigation
from .reductions import chain, reduced_model, reflected_mass
from .symbols import Symbols, coordinates_of


def functions_of(s: Symbols, chain_order: int, *, floating: bool = False) -> tuple[CFunction, ...]:
    """Return all functions of a robot's package.

    Those of the operational space inertia are left out where the contact point cannot move in all
    three directions at any configuration, those with a result for each joint where joints follow
    from others through a loop, and two masses where there is one coordinate.

    Args:
        s: symbols of the package.
        chain_order: masses of the chain.
        floating: whether there is a function for the robot with its base set free.
    """
    functions = [
        mass_matrix(s),
        jacobian(s),
        generalised_mass_matrix(s),
        stiffness_matrix(s),
        contact_jacobian(s),
        reflected_mass(s),
    ]
    if coordinates_of(s.robot) > 1:
        functions.append(reduced_model(s))
    functions.append(chain(s, chain_order))
    if moves_in_space(s.model):
        functions += [osim(s), impact_factors(s), directional_factor(s), absorption_extremes(s)]
        functions += [manipulability(s), force_measure(s), impact_measure(s)]
        if not s.robot.loops:
            functions += [rotor_influence(s), single_joint(s)]
    if not s.robot.loops:
        functions.append(joint_impulse(s))
        if moves_in_space(s.model):
            functions.append(linear_error(s))
    if floating:
        functions.append(impact_mitigation(s))
    return tuple(functions)


def moves_in_space(model: ImpactModel) -> bool:
    """Whether the contact point can move in all directions somewhere."""
    q = np.random.default_rng(1).uniform(-1, 1, model.robot.n)
    return bool(np.linalg.matrix_rank(np.array(model.jacobian(ca.DM(q))), 1e-6) == 3)
