# SPDX-License-Identifier: BSD-3-Clause
"""A robot's coordinates as a design sees them: which have springs, which motors, which are held.

Impacts and bounds are over the independent joints: all of an open arm; those that loops and
couplings leave of others. Of these a joint has a spring behind its motor, a motor alone (rigid), a
spring alone (passive), or neither (the base of a floating robot).
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, Loop, Matrix, loop_gaps, loop_jacobian, loop_tangent
from softimpact.symbolic.robot.rigid import Array


def sprung(model: ImpactModel) -> tuple[int, ...]:
    """Return the joints that have a spring whose stiffness a design may seek, in their order."""
    joints = model.robot.joints
    own = [not joint.actuated and joint.stiffness > 0 for joint in joints]
    return tuple(i for i in sorted(model.independent) if model.drives.elastic[i] or own[i])


def spring_names(model: ImpactModel) -> tuple[str, ...]:
    """Return the names of the joints that have a spring."""
    return tuple(model.robot.joint_names[i] for i in sprung(model))


def rigid(model: ImpactModel) -> tuple[int, ...]:
    """Return the places, among the coordinates, of motors without a spring."""
    return tuple(
        place
        for place, i in enumerate(model.independent)
        if model.robot.actuated[i] and not model.drives.elastic[i]
    )


def loose(model: ImpactModel) -> tuple[int, ...]:
    """Return the places, among the coordinates, of what has neither motor nor spring."""
    known = sprung(model)
    return tuple(
        place
        for place, i in enumerate(model.independent)
        if not model.robot.actuated[i] and i not in known
    )


def is_plain(model: ImpactModel) -> bool:
    """Return whether every joint has a motor with a spring, and none follows from others."""
    return not model.robot.loops and all(model.drives.elastic)


def springs_of(model: ImpactModel) -> Array:
    """Return the stiffness of the springs that there are, one each [N·m/rad]."""
    drives, joints = np.array(model.drives.springs, dtype=float).ravel(), model.robot.joints
    return np.array(
        [drives[i] if joints[i].actuated else joints[i].stiffness for i in sprung(model)]
    )


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


def at_coordinates(model: ImpactModel, of_joints: Matrix) -> Matrix:
    """Return the entries of a column over all joints that belong to the coordinates."""
    return of_joints[list(model.independent)]


def along(model: ImpactModel, q: Matrix, of_coordinates: Matrix) -> Matrix:
    """Return how all joints move where the coordinates do: G times columns."""
    if not model.robot.loops:
        return of_coordinates
    return ca.mtimes(loop_tangent(model.robot, q), of_coordinates)


def onto(model: ImpactModel, q: Matrix, of_joints: Matrix) -> Matrix:
    """Return what columns of torques on all joints are to the coordinates: Gᵀ times them."""
    if not model.robot.loops:
        return of_joints
    return ca.mtimes(loop_tangent(model.robot, q).T, of_joints)


def closure(model: ImpactModel, q: Matrix) -> Matrix:
    """Return how far loops and couplings are from being kept; nothing of an open arm."""
    return loop_gaps(model.robot, q) if model.robot.loops else ca.DM(0, 1)


def side_function(model: ImpactModel) -> ca.Function | None:
    """Return q -> a number that is zero at dead points of loops, None without any.

    Two ways to assemble a chain differ in its sign: a robot cannot get from the one to the other.
    """
    if not any(isinstance(loop, Loop) for loop in model.robot.loops):
        return None
    q = ca.SX.sym("q", model.robot.n)
    follow = [i for i in range(model.robot.n) if i not in model.independent]
    return ca.Function("side", [q], [ca.det(loop_jacobian(model.robot, q)[:, follow])])


def equations(model: ImpactModel) -> int:
    """Return how many numbers ``closure`` has."""
    return model.robot.n - len(model.independent)


def held(model: ImpactModel) -> tuple[int, ...]:
    """Return the joints that no posture moves: free ones without a motor."""
    return tuple(i for i in model.independent if not model.robot.actuated[i])


def posture_limits(model: ImpactModel) -> tuple[Array, Array]:
    """Return lower and upper limits of a posture; passive joints stay where springs are unbent."""
    lower, upper = (np.array(end) for end in model.robot.limits)
    for i in held(model):
        lower[i] = upper[i] = model.robot.joints[i].spring_reference
    return lower, upper


def freedom(model: ImpactModel) -> int:
    """Return how many joints a posture can choose for itself: those with motors."""
    return len(model.independent) - len(held(model))


def moved_by_motors(model: ImpactModel, jacobian: Matrix) -> Matrix:
    """Return a Jacobian over the coordinates without what motors do not move."""
    if all(model.actuated):
        return jacobian
    return ca.mtimes(jacobian, ca.sparsify(ca.diag(ca.DM(np.array(model.actuated, dtype=float)))))


def turns_with_first(model: ImpactModel) -> bool:
    """Return whether all of a robot turns with its first joint, which no loop ties."""
    robot = model.robot
    tied = set().union(*(robot.moved_by(loop) for loop in robot.loops))
    whole = all(0 in robot.ancestors(i) for i in range(robot.n))
    return whole and 0 not in tied and robot.actuated[0]
