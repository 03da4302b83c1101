# SPDX-License-Identifier: BSD-3-Clause
"""The arms are what Universal Robots prints: standard DH parameters, bodies in their frames.

The model files have their bodies at the joints, so this transcription shares no frame with them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from oracles import assert_near, configurations

from softimpact.symbolic import Robot, frame_pose, load_robot, mass_matrix
from softimpact.symbolic.robot.rigid import Array

ALPHA = (np.pi / 2, 0, 0, np.pi / 2, -np.pi / 2, 0)


class Printed(NamedTuple):
    """What is printed of an arm, joint by joint and link by link."""

    d: tuple[float, ...]
    a: tuple[float, ...]
    mass: tuple[float, ...]
    centre: tuple[tuple[float, float, float], ...]
    inertia: tuple[tuple[float, float, float, float, float, float], ...]  # xx yy zz xy xz yz


PRINTED = {
    "ur5e": Printed(
        d=(0.1625, 0, 0, 0.1333, 0.0997, 0.0996),
        a=(0, -0.425, -0.3922, 0, 0, 0),
        mass=(3.761, 8.058, 2.846, 1.37, 1.3, 0.365),
        centre=(
            (0, -0.02561, 0.00193),
            (0.2125, 0, 0.11336),
            (0.15, 0, 0.0265),
            (0, -0.0018, 0.01634),
            (0, 0.0018, 0.01634),
            (0, 0, -0.001159),
        ),
        inertia=(
            (0.0070021, 0.00648091, 0.00657286, 7.3e-7, -1.053e-5, 4.9994e-4),
            (0.01505885, 0.33388086, 0.33247207, -5.4e-5, 5.63e-6, -1.81e-6),
            (0.00399632, 0.07879254, 0.0784851, -1.365e-5, 1.37272e-3, -6.6e-6),
            (0.00165491, 0.00135962, 0.00126279, -2.82e-6, -4.38e-6, 1.0157e-4),
            (0.00135617, 0.00127827, 0.00096614, -2.74e-6, 4.44e-6, -5.048e-5),
            (0.00018694, 0.00018908, 0.00025756, 6e-8, -1.7e-7, -9.2e-7),
        ),
    ),
    "ur10e": Printed(
        d=(0.1807, 0, 0, 0.17415, 0.11985, 0.11655),
        a=(0, -0.6127, -0.57155, 0, 0, 0),
        mass=(7.369, 13.051, 3.989, 2.1, 1.98, 0.615),
        centre=(
            (0.021, 0, 0.027),
            (0.38, 0, 0.158),
            (0.24, 0, 0.068),
            (0, 0.007, 0.018),
            (0, 0.007, 0.018),
            (0, 0, -0.026),
        ),
        inertia=(
            (0.03408, 0.03529, 0.02156, 2e-5, -4.25e-3, 8e-5),
            (0.02814, 0.77068, 0.76943, 5e-5, -1.561e-2, 2e-5),
            (0.01014, 0.30928, 0.30646, 8e-5, 9.16e-3, 0),
            (0.00296, 0.00222, 0.00258, -1e-5, 0, -2.4e-4),
            (0.00296, 0.00222, 0.00258, -1e-5, 0, -2.4e-4),
            (0.0004, 0.00041, 0.00034, 0, 0, 0),
        ),
    ),
}


@pytest.fixture(params=PRINTED, scope="module")
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def printed(name: str) -> Printed:
    return PRINTED[name]


@pytest.fixture(scope="module")
def robot(name: str) -> Robot:
    return load_robot(name)


def dh_frames(printed: Printed, q: Array) -> list[Array]:
    """Return the base's frame and those after each joint."""
    frames = [np.eye(4)]
    for angle, d, a, alpha in zip(q, printed.d, printed.a, ALPHA, strict=True):
        c, s, ca, sa = np.cos(angle), np.sin(angle), np.cos(alpha), np.sin(alpha)
        rows = [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d]]
        frames.append(frames[-1] @ np.array([*rows, [0, 0, 0, 1]]))
    return frames


def printed_mass_matrix(printed: Printed, q: Array) -> Array:
    """Return Σ m J_vᵀJ_v + J_ωᵀ I J_ω over the bodies."""
    frames = dh_frames(printed, q)
    M = np.zeros((6, 6))
    for i in range(6):
        R, centre = frames[i + 1][:3, :3], (frames[i + 1] @ [*printed.centre[i], 1])[:3]
        xx, yy, zz, xy, xz, yz = printed.inertia[i]
        J_v, J_w = np.zeros((3, 6)), np.zeros((3, 6))
        for j in range(i + 1):
            J_w[:, j] = frames[j][:3, 2]
            J_v[:, j] = np.cross(J_w[:, j], centre - frames[j][:3, 3])
        inertia = R @ [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]] @ R.T
        M += printed.mass[i] * J_v.T @ J_v + J_w.T @ inertia @ J_w
    return M


def test_it_has_the_printed_mass_matrix(robot: Robot, printed: Printed) -> None:
    for q in configurations(robot, 5):
        assert_near(mass_matrix(robot, q), printed_mass_matrix(printed, q))


def test_its_flange_is_where_the_controller_says(robot: Robot, printed: Printed) -> None:
    for q in configurations(robot, 5):
        last = dh_frames(printed, q)[-1]
        pose = frame_pose(robot, "flange", q)
        assert_near(pose.position, last[:3, 3])
        assert_near(pose.rotation, last[:3, :3])
