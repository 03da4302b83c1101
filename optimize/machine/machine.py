# SPDX-License-Identifier: BSD-3-Clause
"""A robot with some hardware, as the bounds of a design look at it; numbers or symbols."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca

from softimpact.symbolic import ImpactModel, Matrix, Robot, gravity_torques, mass_matrix

from .coordinates import along, least_motion, onto
from .hardware import Hardware, scaled_by_mass
from .springs import beside_motors, of_springs, sprung, without_beside


@dataclass(frozen=True, eq=False)
class TaskMotion:
    """A motion that a machine must be able to do.

    Attributes:
        point: frame that moves.
        velocity: of its origin, base axes [m/s].
    """

    point: str
    velocity: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Machine:
    """A robot with some hardware, as bounds look at it.

    Attributes:
        model: the robot with these drives.
        hardware: that it has.
        motions: that the study asks of it.
        margin: share by which each spring may be softer or stiffer than meant.
    """

    model: ImpactModel
    hardware: Hardware
    motions: tuple[TaskMotion, ...] = ()
    margin: float = 0.0

    @staticmethod
    def of(
        model: ImpactModel,
        hardware: Hardware,
        motions: tuple[TaskMotion, ...] = (),
        margin: float = 0.0,
    ) -> Machine:
        """Return a robot with other hardware than its own."""
        drives = replace(model.drives, rotors=hardware.reflected_rotors)
        return Machine(model.with_drives(drives), hardware, motions, margin)

    @property
    def robot(self) -> Robot:
        """The rigid robot."""
        return self.model.robot

    @property
    def beside(self) -> Matrix:
        """Stiffness of the springs beside the motors, length n [N·m/rad]."""
        own = self.hardware.beside
        return ca.DM(beside_motors(self.model)) if own is None else own

    def stiffness(self, share: float = 0.0) -> Matrix:
        """Return what holds each link that has a spring, its motor held: k_s and what is beside it.

        Args:
            share: by which every k_s is stiffer than meant; softer where it is negative.
        """
        return self.hardware.springs * (1 + share) + self.beside[list(sprung(self.model))]

    def compliance(self, share: float = 0.0) -> Matrix:
        """Return 1/``stiffness`` of each coordinate, zero where there is no spring, length m."""
        return ca.mtimes(of_springs(self.model), 1 / self.stiffness(share))

    def jacobian(self, q: Matrix) -> Matrix:
        """Return the tip's translational J over the coordinates, 3×m."""
        return self.model.jacobian(q)

    def velocities(self, q: Matrix) -> Matrix:
        """Return the coordinates' velocities in each motion, those of least norm, m×motions."""
        found = []
        for motion in self.motions:
            J = replace(self.model, tip=motion.point).jacobian(q)
            found.append(least_motion(self.model, J, ca.DM(motion.velocity)))
        return ca.horzcat(*found) if found else ca.DM(len(self.model.independent), 0)

    def joint_velocities(self, q: Matrix) -> Matrix:
        """Return the velocities of all joints in each motion, n×motions [rad/s]."""
        return along(self.model, q, self.velocities(q))

    def mass_matrix(self, q: Matrix) -> Matrix:
        """Return the links' M(q) over the coordinates, m×m, without rotors."""
        return scaled_by_mass(
            lambda robot: self.model.congruent(q, mass_matrix(robot, q)),
            self.robot,
            self.hardware.masses,
        )

    def rotor_matrix(self, q: Matrix) -> Matrix:
        """Return what the rotors add to M(q) where joints are rigid, m×m."""
        return self.model.congruent(q, ca.diag(self.hardware.reflected_rotors))

    def holding_torques(self, q: Matrix) -> Matrix:
        """Return what holds the links against gravity and springs beside motors, length m [N·m]."""
        weight = scaled_by_mass(
            lambda robot: onto(self.model, q, gravity_torques(robot, q)),
            without_beside(self.model).robot,
            self.hardware.masses,
        )
        if self.hardware.beside is None and not beside_motors(self.model).any():
            return weight
        unbent = ca.DM([joint.spring_reference for joint in self.robot.joints])
        return weight + onto(self.model, q, self.beside * (q - unbent))
