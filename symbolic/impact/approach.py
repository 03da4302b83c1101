# SPDX-License-Identifier: BSD-3-Clause
"""Joint velocities with which a robot arrives at a contact."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from ..errors import InvalidValue, SingularDirection
from ..matrices import Factorisation, Matrix
from ..robot.rigid import Array, Indices, three_numbers
from .impact_model import ImpactModel

REACHED = 1e-6
"""Share of the wanted velocity that may be missing before the direction counts as singular."""


def least_velocity(jacobian: Matrix, direction: Matrix) -> Matrix:
    """Return the joint velocities of least norm with J q̇ = n, for J of full row rank.

    Args:
        jacobian: translational J, 3×n.
        direction: unit vector n, length 3.
    """
    return ca.mtimes(jacobian.T, Factorisation(ca.mtimes(jacobian, jacobian.T)).solve(direction))


def approach_velocity(model: ImpactModel, q: ArrayLike, direction: ArrayLike) -> Array:
    """Return the link velocities of least norm that move the contact point by 1 m/s along n.

    Springs do not move: only joints with a motor do. Of a closed chain they are the velocities of
    the independent joints.

    Args:
        model: whose contact point moves.
        q: link angles, length n.
        direction: unit vector n, length 3.

    Raises:
        SingularDirection: the point cannot move along n alone.
    """
    n = np.asarray(direction, dtype=float)
    velocity, missed = _least_motion(model, np.array(model.jacobian(np.asarray(q, dtype=float))), n)
    if missed > REACHED:
        raise SingularDirection(n.tolist(), "choose another direction, frame or configuration")
    return velocity


def singular_postures(model: ImpactModel, postures: Array, direction: Array) -> Indices:
    """Return the numbers of postures in which ``approach_velocity`` raises, all looked at at once.

    Args:
        model: whose contact point moves.
        postures: m×n.
        direction: unit vector, length 3.
    """
    q = ca.SX.sym("q", model.robot.n)
    jacobians = np.array(ca.Function("J", [q], [model.jacobian(q)])(postures.T))
    J = jacobians.reshape(3, len(postures), -1).transpose(1, 0, 2)
    return np.flatnonzero(_least_motion(model, J, direction)[1] > REACHED)


def _least_motion(model: ImpactModel, jacobians: Array, n: Array) -> tuple[Array, Array]:
    """Return the motors' velocities of least norm along n, …×n, and by how much they miss it."""
    J = jacobians * np.array(model.actuated, dtype=float)
    velocity = np.linalg.pinv(J, rcond=1e-9) @ n
    return velocity, np.linalg.norm((J @ velocity[..., None])[..., 0] - n, axis=-1)


def generalised_velocity(model: ImpactModel, link_velocity: ArrayLike) -> Array:
    """Return q̇ over motors and deflections: springs do not move before the impact."""
    velocity = model.vector("joint_velocity", link_velocity)
    return np.concatenate([velocity, np.zeros(sum(model.elastic))])


def unit_direction(direction: ArrayLike) -> Array:
    """Return a direction of length 1; raises InvalidValue if it has none."""
    n = three_numbers("direction", direction)
    largest = float(abs(n).max())
    if largest == 0:
        raise InvalidValue("direction", "must not be zero")
    scaled = n / largest  # squares of very long and very short vectors leave the range of floats
    return np.asarray(scaled / np.linalg.norm(scaled))
