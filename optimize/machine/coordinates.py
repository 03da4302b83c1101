# SPDX-License-Identifier: BSD-3-Clause
"""A robot's coordinates as a design sees them, and how all joints move along them.

Impacts and bounds are over the independent joints: all of an open arm; those that loops and
couplings leave of others. Of these a joint has a spring behind its motor, a motor alone (rigid), a
spring alone (passive), or neither (the base of a floating robot).
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, Matrix, least_velocity, loop_tangent
from softimpact.symbolic.matrices import Factorisation

from .springs import sprung


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


def moved_by_motors(model: ImpactModel, jacobian: Matrix) -> Matrix:
    """Return a Jacobian over the coordinates without what motors do not move."""
    if all(model.actuated):
        return jacobian
    return ca.mtimes(jacobian, ca.sparsify(ca.diag(ca.DM(np.array(model.actuated, dtype=float)))))


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
