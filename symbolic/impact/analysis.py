# SPDX-License-Identifier: BSD-3-Clause
"""Everything there is to say about an impact at one configuration, as plain numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InvalidValue, SingularDirection
from ..factors.contact_mobility import directional_giaf, giaf, giif
from ..loops.closure import require_closed_at
from ..record import Record
from ..robot.rigid import Array
from ..robot.robot import JointKind
from .approach import unit_direction
from .chain import chain
from .elastic import LinearModel
from .impact_model import ImpactModel
from .motors import MotorLaw
from .reduction import contact_mode, reduce_to_two_masses, static_stiffness

IMMOBILE = 1e-6
"""Velocity per unit of joint velocity, as a share of the arm's reach, that counts as none."""

UNLOADED = 1e-12
"""Share of K0's size below which the contact mode counts as not loading any spring."""


@dataclass(frozen=True)
class ChainNumbers:
    """Masses [kg] and springs [N/m] of the chain.

    ``stiffness[i]`` joins mass i and i+1; the last entry holds the last mass to ground.
    """

    mass: tuple[float, ...]
    stiffness: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Analysis(Record):
    """What an impact at a contact point along n meets; what does not apply is None.

    Attributes:
        m_c: mass felt at the contact point [kg] (MSM Eq. 36); rotors behind springs do not count,
            those of rigid joints do.
        k_r: reflected stiffness [N/m] (Eq. 37), None if the contact mode loads no spring.
        m_a: mass on the actuators' side [kg] (Eq. 38), None where k_r is or nothing is left.
        chain: masses and springs; fewer than asked for where the chain closes before.
        static_stiffness: k_c that a slow push meets [N/m]; None unless K0 ≻ 0.
        giaf: generalised impact absorption factor (GIAF Eq. 28); this and the next four are None
            where the point cannot move in all three directions.
        giif: generalised impact increment factor (GIAF Eq. 27).
        directional_giaf: along n (GIAF Eq. 29).
        osim: Λ = (J (M+B)⁻¹ Jᵀ)⁻¹ with rotors, 3×3 [kg].
        osim_free: Λ_F = (J M⁻¹ Jᵀ)⁻¹ without them, 3×3 [kg].
        reflected_mass_rigid: (nᵀ Λ⁻¹ n)⁻¹, felt if all joints were rigid [kg].
        mass_matrix: M of the links, n×n [kg m²]; of a closed chain over its independent joints.
        jacobian: translational J in the base's axes, 3×n, over the same joints.
    """

    m_c: float
    k_r: float | None
    m_a: float | None
    chain: ChainNumbers
    static_stiffness: float | None
    giaf: float | None
    giif: float | None
    directional_giaf: float | None
    osim: Array | None
    osim_free: Array | None
    reflected_mass_rigid: float
    mass_matrix: Array
    jacobian: Array


def analyse(
    model: ImpactModel,
    q: ArrayLike,
    direction: ArrayLike,
    order: int = 3,
    law: MotorLaw | None = None,
) -> Analysis:
    """Return all figures of an impact at rest at q along a direction.

    Args:
        model: robot, contact point and drives, in numbers.
        q: link angles, length n.
        direction: of the impact in the base's axes, length 3, of any length but zero.
        order: of the chain, at least 1.
        law: of the motors; None takes the gains of the drives into K0.

    Raises:
        WrongLength: q does not fit the robot.
        InvalidValue: q or the direction is not finite, or the order is below 1.
        LoopCannotClose: a loop is open at q.
        SingularDirection: the contact point cannot move along the direction.
    """
    angles = model.robot.vector("q", q)
    if not np.isfinite(angles).all():
        raise InvalidValue("q", "needs finite numbers")
    if order < 1:
        raise InvalidValue("order", f"must be at least 1, but is {order}")
    require_closed_at(model.robot, angles)
    n = unit_direction(direction)
    J = model.jacobian(angles)
    still = IMMOBILE * stretched_length(model)
    if np.linalg.norm(np.array(J).T @ n) <= still:
        raise SingularDirection(n.tolist(), "choose another direction, frame or configuration")
    if not model.moving(law):
        raise InvalidValue("motors", "leave nothing to give way: all joints are rigid and driven")
    linear = model.linear(angles, n, law)
    k_r, m_a = _spring_and_far_mass(linear)
    free, real = model.free_mobility(angles), model.mobility(angles)
    moves_everywhere = bool(np.linalg.matrix_rank(np.array(J), tol=still) == 3)
    return Analysis(
        m_c=float(contact_mode(linear).m_c),
        k_r=k_r,
        m_a=m_a,
        chain=_chain(linear, min(order, len(model.moving(law)))),
        static_stiffness=_held_stiffness(linear),
        giaf=float(giaf(free, real)) if moves_everywhere else None,
        giif=float(giif(free, real)) if moves_everywhere else None,
        directional_giaf=float(directional_giaf(free, real, n)) if moves_everywhere else None,
        osim=np.array(real.inertia) if moves_everywhere else None,
        osim_free=np.array(free.inertia) if moves_everywhere else None,
        reflected_mass_rigid=1 / float(n @ np.array(real.matrix) @ n),
        mass_matrix=np.array(model.mass_matrix(angles)),
        jacobian=np.array(J),
    )


def stretched_length(model: ImpactModel) -> float:
    """Return the length of the stretched arm from its first joint [m]: the size of J's entries."""
    robot, frame = model.robot, model.robot.frame(model.tip)
    path = [robot.joints[i] for i in robot.ancestors(frame.joint)]
    lengths = [np.linalg.norm(joint.placement.translation) for joint in path[:-1]]
    slides = any(joint.kind is JointKind.SLIDE for joint in path)
    return float(sum(lengths) + np.linalg.norm(frame.placement.translation) + slides)


def _spring_and_far_mass(linear: LinearModel) -> tuple[float | None, float | None]:
    """k_r and m_a; Eq. 38 has no answer where nothing but the contact mode loads a spring."""
    K0, J_c = np.array(linear.stiffness), np.array(linear.jacobian)
    mode = np.array(contact_mode(linear).direction)
    size = abs(K0).max()
    reduced = reduce_to_two_masses(linear)
    k_r = float(reduced.k_r)
    if abs(k_r) <= UNLOADED * size * float((mode.T @ mode).item()):
        return None, None
    S = np.eye(len(K0)) - mode @ J_c
    if abs(S.T @ K0 @ S).max() <= UNLOADED * size:
        return k_r, None
    return k_r, float(reduced.m_a)


def _chain(linear: LinearModel, order: int) -> ChainNumbers:
    found = chain(linear, order, reorthogonalise=True)
    return ChainNumbers(tuple(map(float, found.mass)), tuple(map(float, found.stiffness)))


def _held_stiffness(linear: LinearModel) -> float | None:
    """k_c, unless some motion loads no spring or runs away."""
    eigenvalues = np.linalg.eigvalsh(np.array(linear.stiffness))
    if eigenvalues[0] <= UNLOADED * abs(eigenvalues[-1]):
        return None
    return float(static_stiffness(linear))
