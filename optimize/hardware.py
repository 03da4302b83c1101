# SPDX-License-Identifier: BSD-3-Clause
"""What of a machine a design may change, and the machine that it gives; numbers or symbols."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from softimpact.symbolic import (
    ImpactModel,
    Matrix,
    Robot,
    contact_point_jacobian,
    gravity_torques,
    least_velocity,
    mass_matrix,
)
from softimpact.symbolic.robot.rigid import Array, Inertia


@dataclass(frozen=True, eq=False)
class Hardware:
    """What variables of a design move.

    Attributes:
        springs: joint stiffness k_s, length n [N·m/rad].
        rotors: reflected rotor inertias B with the present gears, length n [kg m²].
        gears: ratio of each gear over the present one, length n.
        masses: factor on mass and inertia of each joint's body, length n; None: as they are.
        cover: Hertz stiffness of what the contact point wears [N/m^1.5]; None: nothing.
    """

    springs: Matrix
    rotors: Matrix
    gears: Matrix
    masses: Matrix | None = None
    cover: Matrix | None = None

    @staticmethod
    def of(model: ImpactModel) -> Hardware:
        """Return a robot as it is."""
        drives = model.drives
        return Hardware(drives.springs, drives.rotors, ca.DM.ones(model.robot.n))

    @property
    def reflected_rotors(self) -> Matrix:
        """Rotor inertias as the joints feel them: the square of the gear ratio counts."""
        return self.rotors * self.gears**2


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
        drives = replace(model.drives, springs=hardware.springs, rotors=hardware.reflected_rotors)
        return Machine(model.with_drives(drives), hardware, motions, margin)

    @property
    def robot(self) -> Robot:
        """The rigid robot."""
        return self.model.robot

    @property
    def softest_springs(self) -> Matrix:
        """Joint stiffness with every spring at the soft end of its tolerance [N·m/rad]."""
        return self.hardware.springs * (1 - self.margin)

    def jacobian(self, q: Matrix) -> Matrix:
        """Return the tip's translational J, 3×n."""
        return self.model.jacobian(q)

    def joint_velocities(self, q: Matrix) -> Matrix:
        """Return the joint velocities of each motion, those of least norm, n×motions [rad/s]."""
        found = []
        for motion in self.motions:
            J = contact_point_jacobian(self.robot, motion.point, q)
            found.append(least_velocity(J, ca.DM(motion.velocity)))
        return ca.horzcat(*found) if found else ca.DM(self.robot.n, 0)

    def mass_matrix(self, q: Matrix) -> Matrix:
        """Return the links' M(q), n×n, without rotors."""
        return scaled_by_mass(lambda robot: mass_matrix(robot, q), self.robot, self.hardware.masses)

    def gravity_torques(self, q: Matrix) -> Matrix:
        """Return the torques that hold the links against gravity, length n [N·m]."""
        return scaled_by_mass(
            lambda robot: gravity_torques(robot, q), self.robot, self.hardware.masses
        )


def scaled_by_mass(of: Callable[[Robot], Matrix], robot: Robot, masses: Matrix | None) -> Matrix:
    """Return what is linear in the bodies' inertias, with each of them times a factor.

    Args:
        of: what depends on a robot's inertias and is linear in them.
        robot: the robot.
        masses: factor for each joint's body, length n; None: 1.
    """
    if masses is None:
        return of(robot)
    weightless = [replace(joint, inertia=Inertia.zero()) for joint in robot.joints]
    rest = of(replace(robot, joints=tuple(weightless)))
    found = rest
    for i, joint in enumerate(robot.joints):
        alone = (*weightless[:i], joint, *weightless[i + 1 :])
        found = found + masses[i] * (of(replace(robot, joints=alone)) - rest)
    return found


def link_masses(robot: Robot) -> Array:
    """Return the mass of each joint's body, length n [kg]."""
    return np.array([joint.inertia.mass for joint in robot.joints])
