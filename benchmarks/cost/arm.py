# SPDX-License-Identifier: BSD-3-Clause
"""The robot as other contenders take it: numbers for Pinocchio, a URDF for the rest."""

from __future__ import annotations

import math

import numpy as np
from samples import Array, text

from softimpact.symbolic import Robot
from softimpact.symbolic.robot.rigid import Inertia


def numbers(robot: Robot) -> str:
    """Return what ``pinocchio_arm.hpp`` reads."""
    lines = []
    for joint in robot.joints:
        com, inertia = _about_com(joint.inertia)
        place = joint.placement
        parts = [place.rotation.ravel(), place.translation, [joint.inertia.mass], com]
        lines.append(text(np.concatenate([*parts, inertia.ravel()])))
    return "\n".join([*lines, text(_tip(robot))])


def urdf(robot: Robot) -> str:
    """Return the same robot as a URDF, with all that moves with a joint in one link."""
    parts = [f'<robot name="{robot.name}"><link name="base"/>']
    for i, joint in enumerate(robot.joints):
        com, inertia = _about_com(joint.inertia)
        entries = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2)}
        matrix = "".join(f' {k}="{float(inertia[at])!r}"' for k, at in entries.items())
        place, parent = joint.placement, f"link{i - 1}" if i else "base"
        parts += [
            f'<link name="link{i}"><inertial><origin xyz="{text(com)}" rpy="0 0 0"/>',
            f'<mass value="{float(joint.inertia.mass)!r}"/>',
            f'<inertia{matrix} izz="{float(inertia[2, 2])!r}"/></inertial></link>',
            f'<joint name="joint{i}" type="revolute"><parent link="{parent}"/>',
            f'<child link="link{i}"/><axis xyz="0 0 1"/>',
            f'<origin xyz="{text(place.translation)}" rpy="{text(_rpy(place.rotation))}"/>',
            f'<limit lower="{joint.lower}" upper="{joint.upper}" effort="1" velocity="1"/></joint>',
        ]
    parts += [
        '<link name="tip"/><joint name="tip_joint" type="fixed">',
        f'<parent link="link{robot.n - 1}"/><child link="tip"/>',
        f'<origin xyz="{text(_tip(robot))}" rpy="0 0 0"/></joint></robot>',
    ]
    return "\n".join(parts)


def _about_com(body: Inertia) -> tuple[Array, Array]:
    com = body.first_moment / body.mass
    steiner = body.mass * (com @ com * np.eye(3) - np.outer(com, com))
    return com, body.about_origin - steiner


def _tip(robot: Robot) -> Array:
    return robot.frame(str(robot.tip)).placement.translation


def _rpy(R: Array) -> Array:
    return np.array([
        math.atan2(R[2, 1], R[2, 2]), math.asin(-R[2, 0]), math.atan2(R[1, 0], R[0, 0]),
    ])  # fmt: skip
