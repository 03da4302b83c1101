# SPDX-License-Identifier: BSD-3-Clause
"""All impact factors and measures at one configuration, as plain numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from ..dynamics.kinematics import direction_jacobian
from ..errors import InvalidValue, SingularDirection
from ..impact.analysis import IMMOBILE, stretched_length
from ..impact.approach import unit_direction
from ..impact.floating import BASE_COORDINATES, is_floating
from ..impact.impact_model import ImpactModel
from ..loops.closure import require_closed_at
from ..loops.loops import loop_tangent
from ..record import Record
from ..robot.rigid import Array
from .contact_mobility import ContactMobility, directional_giaf, giaf, giif
from .ellipsoids import (
    Ellipsoid,
    dynamic_impact_ellipsoid,
    dynamic_impact_measure,
    force_measure,
    generalised_inertia_ellipsoid,
    manipulability,
    manipulability_ellipsoid,
)
from .extreme_directions import Extremes, extreme_directional_giaf, extreme_mass_ratio
from .impact_mitigation import impact_mitigation
from .joint_impulse import JointImpulse, impulse_along
from .rotor_influence import giaf_by_gear, giaf_by_rotor, rotor_mass, single_joint_giaf

Figures = TypeVar("Figures", Ellipsoid, Extremes)


@dataclass(frozen=True, eq=False)
class Mitigation:
    """What the joints of a floating robot spare it, see ``ImpactMitigation``."""

    imf: float
    directional_imf: float
    imf_matrix: Array
    osim_locked: Array


@dataclass(frozen=True, eq=False)
class SpatialFactors:
    """Factors of a contact point that can move in all three directions.

    Attributes:
        giaf: ζ (GIAF Eq. 28).
        giif: increment factor (GIAF Eq. 27).
        directional_giaf: ζ_x along the impact (GIAF Eq. 29).
        directional_giaf_extremes: ζ_x where it is least and greatest.
        mass_ratio_extremes: nᵀΛ⁻¹n / nᵀΛ_F⁻¹n likewise.
        single_joint_giaf: ζ_i with the rotor of one joint alone, length n.
        giaf_by_rotor: ∂ζ/∂b_i, length n [1/(kg m²)].
        giaf_by_gear: ∂ζ/∂(ln N_i), length n.
        osim: Λ with rotors, 3×3 [kg].
        osim_free: Λ_F without, 3×3 [kg].
        inertia_ellipsoid: generalised inertia ellipsoid, {v: vᵀΛ v ≤ 1} [kg^-½].
    """

    giaf: float
    giif: float
    directional_giaf: float
    directional_giaf_extremes: Extremes
    mass_ratio_extremes: Extremes
    single_joint_giaf: Array
    giaf_by_rotor: Array
    giaf_by_gear: Array
    osim: Array
    osim_free: Array
    inertia_ellipsoid: Ellipsoid


@dataclass(frozen=True, eq=False)
class Measures:
    """Measures of the arm alone, its base held; the first two apply everywhere.

    Attributes:
        manipulability: ω_m (GIAF Eq. 2).
        manipulability_ellipsoid: velocities of |q̇| ≤ 1 [m/s].
        force_measure: ω_f (GIAF Eq. 3); None, like the next two, where ω_m is zero.
        dynamic_impact_measure: ω_di (GIAF Eq. 15) [kg³ m³].
        dynamic_impact_ellipsoid: of the same [kg m].
    """

    manipulability: float
    manipulability_ellipsoid: Ellipsoid
    force_measure: float | None
    dynamic_impact_measure: float | None
    dynamic_impact_ellipsoid: Ellipsoid | None


@dataclass(frozen=True, eq=False)
class ImpactFactors(Record):
    """Impact factors at one configuration and direction.

    Attributes:
        rank: number of directions in which the contact point can move.
        reflected_mass_free: (nᵀΛ_F⁻¹n)⁻¹ without rotors; an elastic robot's m_c [kg].
        reflected_mass_rigid: (nᵀΛ⁻¹n)⁻¹ with them [kg].
        mass_ratio: the first over the second, from 0 to 1.
        giaf_movable: ζ over the directions in which the point can move; GIAF where it has three.
        spatial: factors that need all three directions; None where there are fewer.
        mitigation: of a floating robot; None on a fixed base.
        impulse: what the impact does to the joints (GIAF Eq. 14).
        measures: of manipulability and dynamic impact; of a closed chain over its independent
            joints.
    """

    rank: int
    reflected_mass_free: float
    reflected_mass_rigid: float
    mass_ratio: float
    giaf_movable: float
    spatial: SpatialFactors | None
    mitigation: Mitigation | None
    impulse: JointImpulse
    measures: Measures


def impact_factors(
    model: ImpactModel,
    q: ArrayLike,
    direction: ArrayLike,
    *,
    speed: float = 1.0,
    restitution: float = 0.0,
    other_mass: float = np.inf,
) -> ImpactFactors:
    """Return all impact factors at a configuration.

    Results with one entry a joint leave a floating base's six coordinates out; only the change of
    velocity has them.

    Args:
        model: robot, contact point and rotors in numbers; ``floating_model`` for a floating robot.
        q: coordinates of the model's robot.
        direction: of the approach in the base's axes, length 3, of any length but zero.
        speed: of approach [m/s], for the impulses.
        restitution: e, from 0 to 1.
        other_mass: m_2 of what is hit [kg], infinite if it is held.

    Raises:
        WrongLength: q does not fit the robot.
        InvalidValue: a number that is not finite or outside its range.
        SingularDirection: the contact point cannot move along the direction.
        LoopCannotClose: a loop is open at q.
    """
    angles = model.robot.vector("q", q)
    _check(angles, speed, restitution, other_mass)
    require_closed_at(model.robot, angles)
    n = unit_direction(direction)
    J = np.array(model.jacobian(angles))
    still = IMMOBILE * stretched_length(model)
    if np.linalg.norm(J.T @ n) <= still:
        raise SingularDirection(n.tolist(), "choose another direction, frame or configuration")
    M, rotors = ca.DM(model.mass_matrix(angles)), ca.DM(model.drives.rotors)
    G = ca.DM(loop_tangent(model.robot, angles))
    free, real = model.free_mobility(angles), model.mobility(angles)
    rank = int(np.linalg.matrix_rank(J, tol=still))
    masses = [1 / float(n @ np.array(mobility.matrix) @ n) for mobility in (free, real)]
    floating = is_floating(model.robot)
    own = slice(BASE_COORDINATES if floating else 0, None)
    row = ca.DM(direction_jacobian(model.robot, model.tip, angles, n))
    impulse = impulse_along(M, rotors, row.T, speed, restitution, 1 / other_mass, G)
    H = ca.DM(M + rotor_mass(rotors, G))
    return ImpactFactors(
        rank=rank,
        reflected_mass_free=masses[0],
        reflected_mass_rigid=masses[1],
        mass_ratio=masses[0] / masses[1],
        giaf_movable=_movable_giaf(J, rank, free, real),
        spatial=_spatial((M, rotors, ca.DM(J), G), free, real, n, own) if rank == 3 else None,
        mitigation=_mitigation(H, J, n) if floating else None,
        impulse=_of_joints(impulse, own),
        measures=_measures(H[own, own], J[:, own], still),
    )


def _check(angles: Array, speed: float, restitution: float, other_mass: float) -> None:
    if not np.isfinite(angles).all():
        raise InvalidValue("q", "needs finite numbers")
    if not 0 < speed < np.inf:
        raise InvalidValue("speed", f"must be finite and greater than 0 m/s, not {speed:g}")
    if not 0 <= restitution <= 1:
        raise InvalidValue("restitution", f"must be from 0 to 1, not {restitution:g}")
    if not other_mass > 0:
        raise InvalidValue("other_mass", f"must be greater than 0 kg, not {other_mass:g}")


def _movable_giaf(J: Array, rank: int, free: ContactMobility, real: ContactMobility) -> float:
    U = np.linalg.svd(J)[0][:, :rank]
    dets = [np.linalg.det(U.T @ np.array(mobility.matrix) @ U) for mobility in (free, real)]
    return float(dets[1] / dets[0])


def _spatial(
    robot: tuple[ca.DM, ca.DM, ca.DM, ca.DM],
    free: ContactMobility,
    real: ContactMobility,
    n: Array,
    own: slice,
) -> SpatialFactors:
    """Return them for M, the rotors, J and G of a robot."""
    return SpatialFactors(
        giaf=float(giaf(free, real)),
        giif=float(giif(free, real)),
        directional_giaf=float(directional_giaf(free, real, n)),
        directional_giaf_extremes=_numbers(extreme_directional_giaf(free, real)),
        mass_ratio_extremes=_numbers(extreme_mass_ratio(free, real)),
        single_joint_giaf=_array(single_joint_giaf(*robot))[own],
        giaf_by_rotor=_array(giaf_by_rotor(*robot))[own],
        giaf_by_gear=_array(giaf_by_gear(*robot))[own],
        osim=_array(real.inertia),
        osim_free=_array(free.inertia),
        inertia_ellipsoid=_numbers(generalised_inertia_ellipsoid(real)),
    )


def _mitigation(H: ca.DM, J: Array, n: Array) -> Mitigation:
    found = impact_mitigation(H, ca.DM(J))
    return Mitigation(
        imf=float(found.factor),
        directional_imf=float(found.directional(n)),
        imf_matrix=_array(found.matrix),
        osim_locked=_array(found.locked.inertia),
    )


def _measures(H: ca.DM, J: Array, still: float) -> Measures:
    moves = bool(np.linalg.matrix_rank(J, tol=still) == 3)
    jacobian = ca.DM(J)
    return Measures(
        manipulability=float(manipulability(jacobian)),
        manipulability_ellipsoid=_numbers(manipulability_ellipsoid(jacobian)),
        force_measure=float(force_measure(jacobian)) if moves else None,
        dynamic_impact_measure=float(dynamic_impact_measure(H, jacobian)) if moves else None,
        dynamic_impact_ellipsoid=_numbers(dynamic_impact_ellipsoid(H, jacobian)) if moves else None,
    )


def _array(matrix: ArrayLike) -> Array:
    """A CasADi number, column or matrix as NumPy has it."""
    values = np.array(matrix, dtype=float) + 0.0
    return values.ravel() if values.shape[1] == 1 else values


def _numbers(figures: Figures) -> Figures:
    """Return an ellipsoid or extremes of CasADi numbers with floats and arrays."""
    arrays = {name: _array(value) for name, value in vars(figures).items()}
    plain = {name: float(x[0]) if x.size == 1 else x for name, x in arrays.items()}
    return type(figures)(**plain)


def _of_joints(impulse: JointImpulse, own: slice) -> JointImpulse:
    return JointImpulse(
        contact=float(impulse.contact),
        joints=_array(impulse.joints)[own],
        gears=_array(impulse.gears)[own],
        velocity_change=_array(impulse.velocity_change),
    )
