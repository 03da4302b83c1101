# SPDX-License-Identifier: BSD-3-Clause
"""Directions in which a robot can arrive at an impact, also where its tip moves in a plane."""

from __future__ import annotations

import random

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, Robot
from softimpact.symbolic.robot.rigid import Array

from .closed_samples import closed_configurations

CONFIGURATIONS = 8
"""Configurations at which a robot's motions are looked at."""

LEAST_MOTION = 1e-9
"""Share of the largest motion that counts as none."""


def directions_of_motion(model: ImpactModel) -> Array | None:
    """Return orthonormal directions, as rows, in which motors move the contact point anywhere.

    None if there are none, or if they depend on the configuration without being all three.
    """
    columns = [motor_jacobian(model, q) for q in some_configurations(model.robot, seed=2)]
    rank = min(int(np.linalg.matrix_rank(J, 1e-6)) for J in columns)
    directions, sizes, _ = np.linalg.svd(np.hstack(columns))
    if rank == 0 or (rank < 3 and sizes[rank] > LEAST_MOTION * sizes[0]):
        return None
    return _along_axes(directions[:, :rank] @ directions[:, :rank].T)


def some_configurations(robot: Robot, seed: int) -> list[Array]:
    """Return ``CONFIGURATIONS`` configurations to look at a robot at; loops are closed there."""
    if robot.loops:
        return closed_configurations(robot, random.Random(seed), CONFIGURATIONS)
    return list(np.random.default_rng(seed).uniform(-1, 1, (CONFIGURATIONS, robot.n)))


def motor_jacobian(model: ImpactModel, q: Array) -> Array:
    """Return J over the independent joints, with zero for those without a motor."""
    return np.asarray(np.array(model.jacobian(ca.DM(q))) * np.array(model.actuated, dtype=float))


def _along_axes(projector: Array) -> Array:
    """Return a basis of what a projector leaves, along the base's axes as far as it can be."""
    basis: list[Array] = []
    for column in projector.T:
        rest = column - sum((row * (row @ column) for row in basis), np.zeros(3))
        if np.linalg.norm(rest) > LEAST_MOTION:
            basis.append(np.round(rest / np.linalg.norm(rest), 12) + 0.0)
    return np.array(basis)
