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
    gravity_torques,
    least_velocity,
    mass_matrix,
)
from softimpact.symbolic.matrices import Factorisation
from softimpact.symbolic.robot.rigid import Array, Inertia

from .coordinates import (
    along,
    beside_motors,
    is_plain,
    moved_by_motors,
    of_springs,
    onto,
    springs_of,
    sprung,
    without_beside,
)


@dataclass(frozen=True, eq=False)
class Hardware:
    """What variables of a design move.

    Attributes:
        springs: stiffness k_s of each spring that there is [N·m/rad].
        rotors: reflected rotor inertias B with the present gears, length n [kg m²].
        gears: ratio of each gear over the present one, length n.
        masses: factor on mass and inertia of each joint's body, length n; None: as they are.
        cover: Hertz stiffness of what the contact point wears [N/m^1.5]; None: nothing.
        beside: stiffness of springs from body to body beside the motors, length n [N·m/rad]; None:
            those that the robot's file has.
    """

    springs: Matrix
    rotors: Matrix
    gears: Matrix
    masses: Matrix | None = None
    cover: Matrix | None = None
    beside: Matrix | None = None

    @staticmethod
    def of(model: ImpactModel) -> Hardware:
        """Return a robot as it is."""
        drives = model.drives
        return Hardware(ca.DM(springs_of(model)), drives.rotors, ca.DM.ones(model.robot.n))

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


def built(model: ImpactModel, hardware: Hardware) -> ImpactModel:
    """Return a robot with other links, rotors and springs beside motors than its own, in numbers.

    Springs behind motors stay.
    """
    robot = model.robot
    if hardware.beside is not None:
        stiffness = np.array(ca.DM(hardware.beside)).ravel().tolist()
        pairs = zip(robot.joints, stiffness, strict=True)
        robot = replace(robot, joints=tuple(replace(j, stiffness=k) for j, k in pairs))
    if hardware.masses is not None:
        joints = zip(robot.joints, np.array(ca.DM(hardware.masses)).ravel(), strict=True)
        robot = replace(
            robot,
            joints=tuple(replace(j, inertia=_times(j.inertia, factor)) for j, factor in joints),
        )
    drives = replace(model.drives, rotors=ca.DM(hardware.reflected_rotors))
    return replace(model, robot=robot, drives=drives)


def _times(inertia: Inertia, factor: float) -> Inertia:
    return Inertia(
        factor * inertia.mass, factor * inertia.first_moment, factor * inertia.about_origin
    )


IN_PLANE = 1e-12
"""Share of JJᵀ's trace that is added to its diagonal, for points that cannot leave a plane."""


def least_motion(model: ImpactModel, jacobian: Matrix, velocity: Matrix) -> Matrix:
    """Return the coordinates' velocities of least norm that move a point; only motors move it.

    Args:
        model: of the robot.
        jacobian: translational J over its coordinates, 3×m.
        velocity: of the point, length 3, one that it can have.
    """
    if is_plain(model):
        return least_velocity(jacobian, velocity)
    J = moved_by_motors(model, jacobian)
    square = ca.mtimes(J, J.T)
    square = square + IN_PLANE * ca.trace(square) * ca.DM.eye(3)
    return ca.mtimes(J.T, Factorisation(square).solve(velocity))


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
