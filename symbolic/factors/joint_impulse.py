# SPDX-License-Identifier: BSD-3-Clause
"""What an impact with restitution does to the joints (GIAF Eq. 5-14).

Momentum balance at the instant of impact: H Δq̇ = −Jᵀ n p, with n the direction of approach and
the impulse p ≥ 0 that the robot receives against it. Newton's restitution asks for the relative
speed along n after the impact to be −e times the one before. Together

    p = (1 + e) nᵀ(ẋ − ẋ_2) / (nᵀΛ⁻¹n + 1/m_2),      Γ = −Jᵀ n p.

The print of Eq. 14 has nᵀΛn where nᵀΛ⁻¹n belongs (the units tell), lacks the n behind Jᵀ, and
names a change of velocity where the approach velocity belongs. In a closed chain the balance is
that of the independent joints, GᵀHG Δq̇_ind = −GᵀJᵀ n p and Δq̇ = G Δq̇_ind.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from ..matrices import Factorisation, Matrix
from .rotor_influence import rotor_mass


@dataclass(frozen=True, eq=False)
class JointImpulse:
    """An instantaneous impact without friction.

    Attributes:
        contact: impulse p between the bodies [N s].
        joints: Γ = −Jᵀ n p, the contact's impulse on each joint's axis, length n [N·m s]; loops
            add theirs.
        gears: impulse that each gear hands from link to rotor, b_i Δq̇_i, length n [N·m s].
        velocity_change: Δq̇, length n [rad/s].
    """

    contact: Matrix
    joints: Matrix
    gears: Matrix
    velocity_change: Matrix


def joint_impulse(
    mass_matrix: Matrix,
    rotors: Matrix,
    jacobian: Matrix,
    direction: Matrix,
    speed: Matrix = 1.0,
    restitution: Matrix = 0.0,
    other_mobility: Matrix = 0.0,
    tangent: Matrix | None = None,
) -> JointImpulse:
    """Return what an impact does to the joints (GIAF Eq. 14, derived anew).

    Args:
        mass_matrix: M without rotors, n×n; of a closed chain over its m independent joints, m×m.
        rotors: reflected inertias b, length n; zero where a joint has no rotor.
        jacobian: translational J, 3×n.
        direction: unit normal n, along which the contact point approaches, length 3.
        speed: of approach, nᵀ(ẋ − ẋ_2) [m/s].
        restitution: e, from 0 (no rebound) to 1 (elastic).
        other_mobility: 1/m_2 of the other body [1/kg]; zero if it is held.
        tangent: G = ∂q/∂q_ind of a closed chain, n×m; None is G = I.
    """
    push = ca.mtimes(jacobian.T, direction)
    return impulse_along(mass_matrix, rotors, push, speed, restitution, other_mobility, tangent)


def impulse_along(
    mass_matrix: Matrix,
    rotors: Matrix,
    push: Matrix,
    speed: Matrix = 1.0,
    restitution: Matrix = 0.0,
    other_mobility: Matrix = 0.0,
    tangent: Matrix | None = None,
) -> JointImpulse:
    """Return the same from the joint torques Jᵀn of a unit force, length n."""
    along = push if tangent is None else ca.mtimes(tangent.T, push)
    answer = Factorisation(mass_matrix + rotor_mass(rotors, tangent)).solve(along)
    contact = (1 + restitution) * speed / (ca.dot(along, answer) + other_mobility)
    turned: Matrix = answer if tangent is None else ca.mtimes(tangent, answer)
    change = -turned * contact
    return JointImpulse(contact, -push * contact, rotors * change, change)
