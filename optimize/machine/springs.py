# SPDX-License-Identifier: BSD-3-Clause
"""The springs of a robot that a design seeks, and those that stay.

A joint has a spring behind its motor, or, passive, one from body to body. Springs beside motors are
the file's, and another variable.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel
from softimpact.symbolic.robot.rigid import Array


def sprung(model: ImpactModel) -> tuple[int, ...]:
    """Return the joints that have a spring whose stiffness a design may seek, in their order."""
    joints = model.robot.joints
    own = [not joint.actuated and joint.stiffness > 0 for joint in joints]
    return tuple(i for i in sorted(model.independent) if model.drives.elastic[i] or own[i])


def spring_names(model: ImpactModel) -> tuple[str, ...]:
    """Return the names of the joints that have a spring."""
    return tuple(model.robot.joint_names[i] for i in sprung(model))


def springs_of(model: ImpactModel) -> Array:
    """Return the stiffness of the springs that there are, one each [N·m/rad]."""
    drives, joints = np.array(model.drives.springs, dtype=float).ravel(), model.robot.joints
    return np.array(
        [drives[i] if joints[i].actuated else joints[i].stiffness for i in sprung(model)]
    )


def with_springs(model: ImpactModel, springs: Array) -> ImpactModel:
    """Return a model with springs of other stiffness, one for each that there is [N·m/rad]."""
    drives, joints = np.array(model.drives.springs, dtype=float).ravel(), list(model.robot.joints)
    for i, stiffness in zip(sprung(model), np.asarray(springs, dtype=float), strict=True):
        if joints[i].actuated:
            drives[i] = stiffness
        else:
            joints[i] = replace(joints[i], stiffness=float(stiffness))
    robot = model.robot
    if any(not joints[i].actuated for i in sprung(model)):
        robot = replace(robot, joints=tuple(joints))
    return replace(model, robot=robot, drives=replace(model.drives, springs=ca.DM(drives)))


def without_sought(model: ImpactModel) -> ImpactModel:
    """Return a model without the springs of passive joints that a design seeks, for all others."""
    robot, passive = model.robot, [i for i in sprung(model) if not model.robot.actuated[i]]
    if not passive:
        return model
    joints = [replace(j, stiffness=0.0) if i in passive else j for i, j in enumerate(robot.joints)]
    names = tuple(robot.joint_names[i] for i in model.independent) if robot.loops else ()
    return replace(model, robot=replace(robot, joints=tuple(joints), independent=names))


def of_springs(model: ImpactModel) -> ca.DM:
    """Return the matrix that puts numbers of springs at their coordinates, zeros elsewhere."""
    places = {joint: place for place, joint in enumerate(model.independent)}
    rows = [places[i] for i in sprung(model)]
    pattern = ca.Sparsity.triplet(len(places), len(rows), rows, list(range(len(rows))))
    return ca.DM(pattern, 1)


def beside_motors(model: ImpactModel) -> Array:
    """Return the stiffness of the file's springs from body to body beside motors, length n.

    Those of joints without a motor are ``springs_of``.
    """
    return np.array([j.stiffness if j.actuated else 0.0 for j in model.robot.joints])


def without_beside(model: ImpactModel) -> ImpactModel:
    """Return a model without springs beside motors."""
    if not beside_motors(model).any():
        return model
    joints = [replace(j, stiffness=0.0) if j.actuated else j for j in model.robot.joints]
    return replace(model, robot=replace(model.robot, joints=tuple(joints)))
