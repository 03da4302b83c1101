# SPDX-License-Identifier: BSD-3-Clause
"""What of a machine a design may change, and the robot that it gives; numbers or symbols."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, Matrix, Robot
from softimpact.symbolic.robot.rigid import Array, Inertia

from .springs import springs_of


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
