# SPDX-License-Identifier: BSD-3-Clause
"""A robot about to hit something: everything its impact needs, as CasADi expressions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import casadi as ca
import numpy as np

from .chain import Chain, ChainEnd, chain
from .drives import Drives, drives
from .dynamics import mass_matrix, stiffness_of_potential
from .elastic import LinearModel, MassOperator, elastic_jacobian, elastic_mass, elastic_stiffness
from .factors import ContactMobility, contact_mobility
from .kinematics import contact_point_jacobian, direction_jacobian
from .matrices import Matrix
from .reduction import ReducedModel, reduce_to_two_masses, reflected_mass
from .robot import Robot

WEIGHTLESS = (0.0, 0.0, 0.0)
"""Gravity of a model that leaves gravity out of K0."""


@dataclass(frozen=True, eq=False)
class ImpactModel:
    """A robot, its contact point and its drives; methods take q and n of any matrix kind.

    Link angles q have one entry a joint. Generalised coordinates are the motor angles followed by
    the deflections of the elastic joints.

    Attributes:
        robot: the rigid robot.
        tip: frame whose origin is the contact point.
        drives: rotors, springs and gains; numbers or symbols.
        gravity: whose curvature enters K0 [m/s²]; zero leaves it out.
    """

    robot: Robot
    tip: str
    drives: Drives
    gravity: tuple[float, float, float] = WEIGHTLESS

    @property
    def size(self) -> int:
        """Number of generalised coordinates."""
        return self.robot.n + sum(self.drives.elastic)

    def mass_matrix(self, q: Matrix) -> Matrix:
        """Return the links' mass matrix M, n×n [kg m²]."""
        return mass_matrix(self.robot, q)

    def rotor_mass_matrix(self, q: Matrix) -> Matrix:
        """Return M + B, the mass matrix of the rigid robot with its rotors, n×n."""
        return self.mass_matrix(q) + ca.diag(self.drives.rotors)

    def generalised_mass(self, q: Matrix) -> MassOperator:
        """Return M0 over motors and deflections (MSM Eq. 42)."""
        return elastic_mass(self.mass_matrix(q), self.drives.rotors, self.drives.elastic)

    def generalised_stiffness(self, q: Matrix) -> Matrix:
        """Return K0 over motors and deflections (MSM Eq. 45)."""
        potential = self._potential(q)
        return elastic_stiffness(
            self.drives.springs, self.position_gains(q), potential, self.drives.elastic
        )

    def contact_jacobian(self, q: Matrix, direction: Matrix) -> Matrix:
        """Return J_c over motors and deflections, 1×N (MSM Eq. 4)."""
        row = direction_jacobian(self.robot, self.tip, q, direction)
        return elastic_jacobian(row, self.drives.elastic)

    def linear(self, q: Matrix, direction: Matrix) -> LinearModel:
        """Return M0, K0 and J_c around rest at q, hit along the unit vector ``direction``."""
        return LinearModel(
            self.generalised_mass(q),
            self.generalised_stiffness(q),
            self.contact_jacobian(q, direction),
        )

    def reflected_mass(self, q: Matrix, direction: Matrix) -> Matrix:
        """Return m_c [kg] (MSM Eq. 36); rotors behind springs do not count."""
        if all(self.drives.elastic):
            row = direction_jacobian(self.robot, self.tip, q, direction)
            return reflected_mass(self.mass_matrix(q), row)
        return reflected_mass(self.generalised_mass(q).matrix, self.contact_jacobian(q, direction))

    def reduced(self, q: Matrix, direction: Matrix) -> ReducedModel:
        """Return m_c, k_r and m_a (MSM Eq. 36-38)."""
        return reduce_to_two_masses(self.linear(q, direction))

    def chain(
        self,
        q: Matrix,
        direction: Matrix,
        order: int = 3,
        end: ChainEnd = "grounded",
        *,
        reorthogonalise: bool | Literal["once"] = False,
    ) -> Chain:
        """Return the chain of ``order`` masses, see ``softimpact.symbolic.chain``."""
        return chain(self.linear(q, direction), order, end, reorthogonalise=reorthogonalise)

    def jacobian(self, q: Matrix) -> Matrix:
        """Return the contact point's translational J in the base's axes, 3×n."""
        return contact_point_jacobian(self.robot, self.tip, q)

    def free_mobility(self, q: Matrix, axes_of: int = -1) -> ContactMobility:
        """Return J M⁻¹ Jᵀ = Λ_F⁻¹, the mobility without rotors (GIAF Eq. 24)."""
        J = contact_point_jacobian(self.robot, self.tip, q, axes_of)
        return contact_mobility(self.mass_matrix(q), J)

    def mobility(self, q: Matrix, axes_of: int = -1) -> ContactMobility:
        """Return J (M+B)⁻¹ Jᵀ = Λ⁻¹, the mobility with rotors (GIAF Eq. 23)."""
        J = contact_point_jacobian(self.robot, self.tip, q, axes_of)
        return contact_mobility(self.rotor_mass_matrix(q), J)

    def with_springs(self, springs: Matrix) -> ImpactModel:
        """Return the model with other joint stiffnesses k_s, length n, numbers or symbols."""
        return replace(self, drives=replace(self.drives, springs=springs))

    def _potential(self, q: Matrix) -> Matrix:
        has_springs = any(joint.stiffness for joint in self.robot.joints)
        if not has_springs and not any(self.gravity):
            return ca.DM(self.robot.n, self.robot.n)
        return stiffness_of_potential(self.robot, q, self.gravity)

    def position_gains(self, q: Matrix) -> Matrix:
        """Return K_p = diag(gains) + k_p M_θθ over the motors, n×n, sparse where it is zero."""
        gains = ca.diag(self.drives.gains)
        if self.drives.computed_torque_gain is None:
            return ca.sparsify(gains) if isinstance(gains, ca.DM) else gains
        motors = ca.DM(np.diag(np.array(self.robot.actuated, dtype=float)))
        motors = ca.sparsify(motors)
        block = ca.mtimes([motors, self.rotor_mass_matrix(q), motors])
        return gains + self.drives.computed_torque_gain * block


def impact_model(
    robot: Robot,
    tip: str | None = None,
    *,
    drives_: Drives | None = None,
    gravity: tuple[float, float, float] = WEIGHTLESS,
) -> ImpactModel:
    """Return the model of a robot; raises FrameNotFound if it has no such tip.

    Args:
        robot: any robot.
        tip: contact frame; default the robot's own.
        drives_: rotors, springs and gains; default rigid joints with the file's armature.
        gravity: whose curvature enters K0 [m/s²]; zero leaves it out.
    """
    name = tip if tip is not None else robot.tip
    frame = robot.frame(name if name is not None else "")
    return ImpactModel(robot, frame.name, drives_ or drives(robot), gravity)
