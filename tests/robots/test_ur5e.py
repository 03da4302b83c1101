# SPDX-License-Identifier: BSD-3-Clause
"""The UR5e is what Universal Robots prints: standard DH parameters, bodies in the frames they give.

The model file has its bodies at the joints instead, so this transcription shares no frame with it.
"""

from __future__ import annotations

import numpy as np
import pytest
from oracles import assert_near, configurations

from softimpact.symbolic import Robot, frame_pose, load_robot, mass_matrix
from softimpact.symbolic.robot.rigid import Array

D = (0.1625, 0, 0, 0.1333, 0.0997, 0.0996)
A = (0, -0.425, -0.3922, 0, 0, 0)
ALPHA = (np.pi / 2, 0, 0, np.pi / 2, -np.pi / 2, 0)
MASS = (3.761, 8.058, 2.846, 1.37, 1.3, 0.365)
CENTRE = (
    (0, -0.02561, 0.00193),
    (0.2125, 0, 0.11336),
    (0.15, 0, 0.0265),
    (0, -0.0018, 0.01634),
    (0, 0.0018, 0.01634),
    (0, 0, -0.001159),
)
INERTIA = (  # xx, yy, zz, xy, xz, yz
    (0.0070021, 0.00648091, 0.00657286, 7.3e-7, -1.053e-5, 4.9994e-4),
    (0.01505885, 0.33388086, 0.33247207, -5.4e-5, 5.63e-6, -1.81e-6),
    (0.00399632, 0.07879254, 0.0784851, -1.365e-5, 1.37272e-3, -6.6e-6),
    (0.00165491, 0.00135962, 0.00126279, -2.82e-6, -4.38e-6, 1.0157e-4),
    (0.00135617, 0.00127827, 0.00096614, -2.74e-6, 4.44e-6, -5.048e-5),
    (0.00018694, 0.00018908, 0.00025756, 6e-8, -1.7e-7, -9.2e-7),
)


@pytest.fixture(scope="module")
def ur5e() -> Robot:
    return load_robot("ur5e")


def dh_frames(q: Array) -> list[Array]:
    """Return the base's frame and those after each joint."""
    frames = [np.eye(4)]
    for angle, d, a, alpha in zip(q, D, A, ALPHA, strict=True):
        c, s, ca, sa = np.cos(angle), np.sin(angle), np.cos(alpha), np.sin(alpha)
        rows = [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d]]
        frames.append(frames[-1] @ np.array([*rows, [0, 0, 0, 1]]))
    return frames


def printed_mass_matrix(q: Array) -> Array:
    """Return Σ m J_vᵀJ_v + J_ωᵀ I J_ω over the bodies."""
    frames = dh_frames(q)
    M = np.zeros((6, 6))
    for i in range(6):
        R, centre = frames[i + 1][:3, :3], (frames[i + 1] @ [*CENTRE[i], 1])[:3]
        xx, yy, zz, xy, xz, yz = INERTIA[i]
        J_v, J_w = np.zeros((3, 6)), np.zeros((3, 6))
        for j in range(i + 1):
            J_w[:, j] = frames[j][:3, 2]
            J_v[:, j] = np.cross(J_w[:, j], centre - frames[j][:3, 3])
        inertia = R @ [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]] @ R.T
        M += MASS[i] * J_v.T @ J_v + J_w.T @ inertia @ J_w
    return M


def test_it_has_the_printed_mass_matrix(ur5e: Robot) -> None:
    for q in configurations(ur5e, 5):
        assert_near(mass_matrix(ur5e, q), printed_mass_matrix(q))


def test_its_flange_is_where_the_controller_says(ur5e: Robot) -> None:
    for q in configurations(ur5e, 5):
        last = dh_frames(q)[-1]
        pose = frame_pose(ur5e, "flange", q)
        assert_near(pose.position, last[:3, 3])
        assert_near(pose.rotation, last[:3, :3])
