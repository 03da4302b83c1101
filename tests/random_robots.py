# SPDX-License-Identifier: BSD-3-Clause
"""Random trees of hinges and slides for hypothesis, with the geometry that breaks things."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from softimpact.symbolic import Frame, Joint, JointKind, Robot
from softimpact.symbolic.robot.rigid import Inertia, Placement, rotation_about_z, rotation_from_axis
from softimpact.symbolic.robot.robot import BASE

TILTS = (0.0, np.pi, np.pi / 2, -np.pi / 2, 1e-15, 1e-9, 1e-5, 1e-3, 0.019, 0.021, 0.05, 0.3, 3.14)
"""Angles between a joint's axis and its parent's: parallel, perpendicular and nearly so [rad]."""

seeds = st.integers(0, 2**32 - 1)


@st.composite
def placements(draw: st.DrawFn) -> Placement:
    """Poses of one joint's frame in the one before it."""
    random = np.random.default_rng(draw(seeds))
    tilt = draw(st.sampled_from((*TILTS, float(random.uniform(-3, 3)))))
    heading = draw(st.sampled_from((0.0, np.pi / 2, np.pi, float(random.uniform(-3, 3)))))
    about = np.array([np.cos(heading), np.sin(heading), 0.0])
    turn = draw(st.sampled_from((0.0, np.pi / 2, -np.pi, float(random.uniform(-3, 3)))))
    shift = random.uniform(-0.5, 0.5, 3) * draw(st.sampled_from(((0, 0, 0), (0, 0, 1), (1, 1, 1))))
    return Placement(rotation_from_axis(about, tilt) @ rotation_about_z(turn), shift)


@st.composite
def inertias(draw: st.DrawFn) -> Inertia:
    """Bodies of a few point masses and a small ball."""
    random = np.random.default_rng(draw(seeds))
    body = Inertia.from_center_of_mass(0.2, np.zeros(3), 1e-3 * np.eye(3))
    for point in random.uniform(-0.3, 0.3, (3, 3)):
        body += Inertia.from_center_of_mass(random.uniform(0.1, 2), point, np.zeros((3, 3)))
    return body


@st.composite
def robots(
    draw: st.DrawFn,
    min_joints: int = 1,
    max_joints: int = 5,
    kinds: tuple[JointKind, ...] = tuple(JointKind),
    branched: bool = True,
) -> Robot:
    """Robots with rotors and a frame ``tip`` off the last joint."""
    n = draw(st.integers(min_joints, max_joints))
    joints = []
    for i in range(n):
        random = np.random.default_rng(draw(seeds))
        joints.append(
            Joint(
                name=f"j{i}",
                kind=draw(st.sampled_from(kinds)),
                parent=draw(st.integers(BASE, i - 1)) if branched else i - 1,
                placement=draw(placements()),
                inertia=draw(inertias()),
                armature=float(random.uniform(0.05, 1.0)),
            )
        )
    tip = Placement(np.eye(3), np.array([0.11, -0.23, 0.31]))
    return Robot("random", tuple(joints), {"tip": Frame("tip", n - 1, tip)}, "tip")


@st.composite
def arms(draw: st.DrawFn, min_joints: int = 3, max_joints: int = 5) -> Robot:
    """Unbranched robots in general position, whose tip can move in every direction."""
    n = draw(st.integers(min_joints, max_joints))
    random = np.random.default_rng(draw(seeds))
    joints = []
    for i in range(n):
        axis = random.normal(size=3)
        turn = rotation_from_axis(axis / np.linalg.norm(axis), random.uniform(0.5, 2.5))
        place = Placement(turn, random.uniform(0.1, 0.5, 3))
        rotor = float(random.uniform(0.05, 1.0))
        joints.append(
            Joint(f"j{i}", JointKind.HINGE, i - 1, place, draw(inertias()), 0.0, armature=rotor)
        )
    tip = Placement(np.eye(3), random.uniform(0.1, 0.4, 3))
    return Robot("arm", tuple(joints), {"tip": Frame("tip", n - 1, tip)}, "tip")


@st.composite
def vectors(draw: st.DrawFn, size: int, low: float = -2.0, high: float = 2.0) -> np.ndarray:
    """Random vectors."""
    return np.random.default_rng(draw(seeds)).uniform(low, high, size)


def unit_vector(seed: int) -> np.ndarray:
    """Return a random direction."""
    v = np.random.default_rng(seed).normal(size=3)
    return v / np.linalg.norm(v)
