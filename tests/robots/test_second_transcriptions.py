# SPDX-License-Identifier: BSD-3-Clause
"""Arms against what others print of them, in other frames, forms or files.

Universal Robots' arms have a test file of their own.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from oracles import Pinocchio, assert_near, column, configurations, example_urdf

from softimpact.symbolic import Robot, frame_pose, load_robot, mass_matrix
from softimpact.symbolic.robot.rigid import Array

SIX_DIGITS = 2e-5
"""Relative error from quaternions and angles that are printed with six digits."""

PI = np.pi


class Principal(NamedTuple):
    """A link's inertia as mujoco_menagerie prints it: principal moments and their axes."""

    mass: float
    pos: tuple[float, float, float]
    quat: tuple[float, float, float, float]
    moments: tuple[float, float, float]


MENAGERIE: dict[str, tuple[Principal, ...]] = {
    "fr3": (  # franka_fr3/fr3.xml, commit 0059d43
        Principal(
            2.92747,
            (4.128e-07, -0.0181251, -0.0386036),
            (0.998098, -0.0605364, 0.00380499, 0.0110109),
            (0.0239286, 0.0227246, 0.00610634),
        ),
        Principal(
            2.93554,
            (0.00318289, -0.0743222, 0.00881461),
            (0.502599, 0.584437, -0.465998, 0.434366),
            (0.0629567, 0.0411924, 0.0246371),
        ),
        Principal(
            2.2449,
            (0.0407016, -0.00482006, -0.0289731),
            (0.921025, -0.244161, 0.155272, 0.260745),
            (0.0267409, 0.0189869, 0.0171587),
        ),
        Principal(
            2.6156,
            (-0.0459101, 0.0630493, -0.00851879),
            (0.438018, 0.803311, 0.00937812, 0.403414),
            (0.05139, 0.0372717, 0.0160047),
        ),
        Principal(
            2.32712,
            (-0.00160396, 0.0292536, -0.0972966),
            (0.919031, 0.125604, 0.0751531, -0.366003),
            (0.0579335, 0.0449144, 0.0130634),
        ),
        Principal(
            1.81704,
            (0.0597131, -0.0410295, -0.0101693),
            (0.621301, 0.552665, 0.510011, 0.220081),
            (0.0175039, 0.0161123, 0.00193529),
        ),
        Principal(
            0.627143,
            (0.00452258, 0.00862619, -0.0161633),
            (0.727579, 0.0978688, -0.24906, 0.63168),
            (0.000223836, 0.000223642, 5.64132e-07),
        ),
    ),
    "gen3": (  # kinova_gen3/gen3.xml, commit 3966424
        Principal(
            1.3773,
            (-2.3e-05, -0.010364, -0.07336),
            (0.707051, 0.0451246, -0.0453544, 0.704263),
            (0.00488868, 0.00457, 0.00135132),
        ),
        Principal(
            1.1636,
            (-4.4e-05, -0.09958, -0.013278),
            (0.482348, 0.516286, -0.516862, 0.483366),
            (0.0113017, 0.011088, 0.00102532),
        ),
        Principal(
            1.1636,
            (-4.4e-05, -0.006641, -0.117892),
            (0.706144, 0.0213722, -0.0209128, 0.707437),
            (0.0111633, 0.010932, 0.00100671),
        ),
        Principal(
            0.9302,
            (-1.8e-05, -0.075478, -0.015006),
            (0.483678, 0.515961, -0.515859, 0.483455),
            (0.00834839, 0.008147, 0.000598606),
        ),
        Principal(
            0.6781,
            (1e-06, -0.009432, -0.063883),
            (0.703558, 0.0707492, -0.0707492, 0.703558),
            (0.00165901, 0.001596, 0.000346988),
        ),
        Principal(
            0.6781,
            (1e-06, -0.045483, -0.00965),
            (0.44426, 0.550121, -0.550121, 0.44426),
            (0.00170087, 0.001641, 0.00035013),
        ),
        Principal(
            0.5,
            (0.000281, 0.011402, -0.029798),
            (0.394358, 0.596779, -0.577293, 0.393789),
            (0.000657336, 0.000587019, 0.000320645),
        ),
    ),
}


def link(robot: Robot, joint: int) -> tuple[float, Array, Array]:
    """Return mass, centre of mass and inertia about it, in the frame of the joint's body."""
    inertia = robot.joints[joint].inertia
    centre = inertia.first_moment / inertia.mass
    steiner = inertia.mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    return inertia.mass, centre, inertia.about_origin - steiner


@pytest.mark.parametrize("name", MENAGERIE)
def test_links_are_those_of_menagerie(name: str) -> None:
    robot = load_robot(name)
    for i, printed in enumerate(MENAGERIE[name]):
        mass, centre, inertia = link(robot, i)
        R = np.zeros(9)
        mujoco.mju_quat2Mat(R, np.array(printed.quat) / np.linalg.norm(printed.quat))
        axes = R.reshape(3, 3)
        assert mass == pytest.approx(printed.mass, rel=SIX_DIGITS)
        assert_near(centre, np.array(printed.pos), SIX_DIGITS)
        assert_near(inertia, axes @ np.diag(printed.moments) @ axes.T, SIX_DIGITS)


@pytest.mark.parametrize(
    ("name", "prefix", "count"),
    [("xarm7", "", 7), ("panda", "panda_", 6)],  # the Panda's last link has its hand welded on
)
def test_links_are_those_of_example_robot_data(name: str, prefix: str, count: int) -> None:
    robot = load_robot(name)
    model = pin.buildModelFromUrdf(str(example_urdf(f"{name}.urdf")))
    for i in range(count):
        theirs = model.inertias[model.getJointId(prefix + robot.joint_names[i])]
        mass, centre, inertia = link(robot, i)
        assert mass == pytest.approx(theirs.mass)
        assert_near(centre, theirs.lever)
        assert_near(inertia, theirs.inertia)


def test_xarm7_moves_like_that_of_example_robot_data() -> None:
    """Right angles are 1.5708 there, so poses differ in their last digits."""
    robot = load_robot("xarm7")
    oracle = Pinocchio.of_urdf(example_urdf("xarm7.urdf"), robot)
    for q in configurations(robot, 5):
        assert_near(mass_matrix(robot, q), oracle.mass_matrix(q), SIX_DIGITS)
        pose, flange = frame_pose(robot, "flange", q), oracle.pose("link_eef", q)
        assert_near(pose.position, flange.translation, SIX_DIGITS)
        assert_near(pose.rotation, flange.rotation, SIX_DIGITS)


# the iiwa stretched upwards: axes through the base's z, distances as KUKA's data sheet has them
IIWA_HEIGHTS = (0.0, 0.36, 0.36, 0.78, 0.78, 1.18, 1.18)
IIWA_AXES = ("z", "y", "z", "-y", "z", "y", "z")
IIWA_FLANGE = 1.306
IIWA_BASE_MASS, IIWA_MASS = 7.050378, 29.9
IIWA_LINKS = (  # mass, centre at q = 0 in the base's frame, xx yy zz xy xz yz about it
    (5.289529, (0, -0.033795, 0.279904), (0.042462, 0.042838, 0.01587, 0, 0, 0.006341)),
    (
        5.688888,
        (0.000136, 0.037548, 0.436322),
        (0.055182, 0.053983, 0.016523, -3.3e-5, 5.6e-5, 0.010034),
    ),
    (3.461245, (0, 0.034913, 0.711108), (0.02172, 0.02073, 0.007701, 0, 0, -0.003845)),
    (4.122995, (0, -0.029293, 0.866944), (0.03241, 0.030758, 0.009883, 0, 0, -0.006022)),
    (1.563756, (0, -0.029824, 1.063767), (0.008677, 0.007297, 0.003935, 0, 0, 0.002869)),
    (2.457878, (0, 0.00032, 1.18495), (0.007227, 0.006958, 0.004734, 0, 0, 0.000318)),
    (0.265331, (3e-6, -2e-6, 1.284782), (0.000175, 0.000175, 0.000306, 0, 0, 0)),
)


def _turned(axis: str, angle: float, point: Array) -> Array:
    """Return the motion that turns by an angle about an axis through a point."""
    sign = -1.0 if axis.startswith("-") else 1.0
    c, s = np.cos(sign * angle), np.sin(sign * angle)
    T = np.eye(4)
    T[:3, :3] = (
        [[c, -s, 0], [s, c, 0], [0, 0, 1]]
        if axis.endswith("z")
        else [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    )
    T[:3, 3] = point - T[:3, :3] @ point
    return T


def iiwa_motions(q: Array) -> list[Array]:
    """Return the motion of the base and of each link from the stretched arm."""
    motions = [np.eye(4)]
    for angle, axis, height in zip(q, IIWA_AXES, IIWA_HEIGHTS, strict=True):
        motions.append(motions[-1] @ _turned(axis, angle, np.array([0, 0, height])))
    return motions


def iiwa_mass_matrix(q: Array) -> Array:
    """Return Σ m J_vᵀJ_v + J_ωᵀ I J_ω over the links, by screws."""
    motions, M = iiwa_motions(q), np.zeros((7, 7))
    directions = [np.array([0, 0, 1.0]) if a == "z" else np.array([0, 1.0, 0]) for a in IIWA_AXES]
    directions[3] = -directions[3]
    for i, (mass, centre, moments) in enumerate(IIWA_LINKS):
        R, place = motions[i + 1][:3, :3], (motions[i + 1] @ [*centre, 1])[:3]
        J_v, J_w = np.zeros((3, 7)), np.zeros((3, 7))
        for j in range(i + 1):
            J_w[:, j] = motions[j][:3, :3] @ directions[j]
            pivot = (motions[j] @ [0, 0, IIWA_HEIGHTS[j], 1])[:3]
            J_v[:, j] = np.cross(J_w[:, j], place - pivot)
        xx, yy, zz, xy, xz, yz = moments
        inertia = R @ [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]] @ R.T
        M += mass * J_v.T @ J_v + J_w.T @ inertia @ J_w
    return M


def test_iiwa14_by_screws() -> None:
    robot = load_robot("iiwa14")
    for q in configurations(robot, 5):
        assert_near(mass_matrix(robot, q), iiwa_mass_matrix(q))
        flange = iiwa_motions(q)[-1] @ [0, 0, IIWA_FLANGE, 1]
        assert_near(frame_pose(robot, "flange", q).position, flange[:3])


def test_iiwa14_weighs_what_its_data_sheet_says() -> None:
    moving = sum(joint.inertia.mass for joint in load_robot("iiwa14").joints)
    assert IIWA_BASE_MASS + moving == pytest.approx(IIWA_MASS, abs=1e-6)


def test_rotors_of_the_iiwa14_are_motors_behind_gears() -> None:
    gears = np.array([160, 160, 160, 160, 100, 160, 160])
    motors = np.array([1.321e-4, 1.321e-4, 1.321e-4, 1.321e-4, 1.321e-4, 4.54e-5, 4.54e-5])
    assert_near(load_robot("iiwa14").rotor_inertia_set("drake_iiwa14"), gears**2 * motors)


def _modified_dh(a: float, alpha: float, d: float, angle: float) -> Array:
    ca, sa, c, s = np.cos(alpha), np.sin(alpha), np.cos(angle), np.sin(angle)
    rows = [[c, -s, 0, a], [s * ca, c * ca, -sa, -d * sa], [s * sa, c * sa, ca, d * ca]]
    return np.array([*rows, [0, 0, 0, 1]])


def _standard_dh(a: float, alpha: float, d: float, angle: float) -> Array:
    ca, sa, c, s = np.cos(alpha), np.sin(alpha), np.cos(angle), np.sin(angle)
    rows = [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d]]
    return np.array([*rows, [0, 0, 0, 1]])


def _chain(steps: list[Array]) -> Array:
    placed = np.eye(4)
    for step in steps:
        placed = placed @ step
    return placed


def fr3_flange(q: Array) -> Array:
    """Franka's documentation: modified Denavit-Hartenberg parameters, then the flange."""
    a = (0, 0, 0, 0.0825, -0.0825, 0, 0.088)
    alpha = (0, -PI / 2, PI / 2, PI / 2, -PI / 2, PI / 2, PI / 2)
    d = (0.333, 0, 0.316, 0, 0.384, 0, 0)
    steps = [_modified_dh(*row) for row in zip(a, alpha, d, q, strict=True)]
    return _chain([*steps, _modified_dh(0, 0, 0.107, 0)])


def gen3_end_effector(q: Array) -> Array:
    """Kinova's user guide: classical parameters with the base's frame turned over.

    Its lengths have four digits and leave out offsets of 0.18 mm at the wrist: within 1 mm.
    """
    alpha = (PI / 2, PI / 2, PI / 2, PI / 2, PI / 2, PI / 2, PI)
    d = (-0.2848, -0.0118, -0.4208, -0.0128, -0.3143, 0, -0.1674)
    offset = (0, PI, PI, PI, PI, PI, PI)
    steps = [_standard_dh(0, alpha[i], d[i], angle + offset[i]) for i, angle in enumerate(q)]
    return _chain([_standard_dh(0, PI, 0, 0), *steps])


@pytest.mark.parametrize(
    ("name", "place", "rounding"),
    [("fr3", fr3_flange, 1e-12), ("gen3", gen3_end_effector, 1e-3)],
)
def test_tip_is_where_the_manufacturer_says(
    name: str, place: Callable[[Array], Array], rounding: float
) -> None:
    robot = load_robot(name)
    assert robot.tip is not None
    for q in configurations(robot, 5):
        pose, theirs = frame_pose(robot, robot.tip, q), place(q)
        np.testing.assert_allclose(column(pose.position), theirs[:3, 3], atol=rounding)
        assert_near(pose.rotation, theirs[:3, :3])
