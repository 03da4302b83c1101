# SPDX-License-Identifier: BSD-3-Clause
"""The Panda on a rigid wall: how heavy it seems, and as which rigid body.

Y. Wang, N. Dehio, A. Kheddar, On Inverse Inertia Matrix and Contact-Force Model for Robotic
Manipulators at Normal Impacts, IEEE RA-L 7(2), 2022 (arXiv 2109.04756) hit a rigid wall with a
force sensor 150 times, with a stiffly controlled Panda, and found that the inverse inertia of the
composite rigid body, all joints locked, fits best.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from softimpact.simulate.sampled import SampledImpacts, Samples
from softimpact.symbolic import (
    BodyRegion,
    Contact,
    Motors,
    PowerLaw,
    Robot,
    approach_velocity,
    drives,
    frame_jacobian,
    frame_pose,
    impact_model,
    load_robot,
    mass_matrix,
)
from softimpact.symbolic.robot.rigid import Array, Placement

from .foretold import WIND_UP

FLANGE = "flange"

WALL = (1e5, 1e6)
"""Stiffness of the contact with the wall [N/m]: not stated; a metal fist and a force sensor."""

SPEED = 0.1
"""Of the impact [m/s]; the masses do not depend on it."""

BESIDE_READY = 0.5
"""By which each joint may be off the ready pose [rad]."""

READY = np.array([0, -np.pi / 4, 0, -3 * np.pi / 4, 0, np.pi / 2, np.pi / 4])


@dataclass(frozen=True, eq=False)
class ApparentMasses:
    """Masses that the flange seems to have, one for each posture and direction [kg].

    Attributes:
        composite: of the whole arm as one free rigid body.
        links: of the links alone, joints free to move: (n J M⁻¹ Jᵀ n)⁻¹.
        rotors: with rotors, joints rigid, by set of rotors.
        free: that the peak force tells, springs and rotors, motors free; a row for each pair of
            wall and wind-up, from soft to stiff.
        driven: likewise, motors that keep their speed for the usual reaction time.
    """

    composite: Array
    links: Array
    rotors: dict[str, Array]
    free: Array
    driven: Array


def apparent_masses(count: int = 100, seed: int = 0) -> ApparentMasses:
    """Return the masses for random postures beside the ready pose, hit horizontally or down."""
    robot, random = load_robot("panda"), np.random.default_rng(seed)
    q = READY + random.uniform(-BESIDE_READY, BESIDE_READY, (count, 7))
    n = np.array([_wall_normal(random) for _ in range(count)])
    sets = {name: robot.rotor_inertia_set(name) for name in robot.rotor_inertia_sets}
    free, driven = [], []
    for wall in WALL:
        for wind_up in WIND_UP[::-1]:
            free.append(_from_peaks(robot, q, n, wall, wind_up, Motors("free")))
            driven.append(_from_peaks(robot, q, n, wall, wind_up, Motors("driven")))
    return ApparentMasses(
        composite=np.array([composite_mass(robot, *at) for at in zip(q, n, strict=True)]),
        links=_rigid_masses(robot, np.zeros(7), q, n),
        rotors={name: _rigid_masses(robot, rotors, q, n) for name, rotors in sets.items()},
        free=np.array(free),
        driven=np.array(driven),
    )


def _wall_normal(random: np.random.Generator) -> Array:
    """Return a direction into a wall or a table."""
    if random.random() < 0.5:
        return np.array([0.0, 0.0, -1.0])
    angle = random.uniform(-np.pi, np.pi)
    return np.array([np.cos(angle), np.sin(angle), 0.0])


def _rigid_masses(robot: Robot, rotors: Array, q: Array, n: Array) -> Array:
    """Return (nᵀ J (M+B)⁻¹ Jᵀ n)⁻¹ at each posture [kg]."""
    masses = []
    for at, along in zip(q, n, strict=True):
        J = along @ np.array(frame_jacobian(robot, FLANGE, at))[:3]
        M = np.array(mass_matrix(robot, at)) + np.diag(rotors)
        masses.append(1 / float(J @ np.linalg.solve(M, J)))
    return np.array(masses)


def composite_mass(robot: Robot, q: Array, n: Array) -> float:
    """Return the mass at the flange along n of all moving links as one free rigid body [kg]."""
    placed: list[Placement] = []
    mass, moment, about_base = 0.0, np.zeros(3), np.zeros((3, 3))
    for joint, angle in zip(robot.joints, q, strict=True):
        pose = joint.pose(float(angle))
        placed.append(placed[joint.parent] @ pose if joint.parent >= 0 else pose)
        inertia = joint.inertia.seen_from(placed[-1])
        mass, moment = mass + inertia.mass, moment + inertia.first_moment
        about_base = about_base + inertia.about_origin
    centre = moment / mass
    inertia_about = about_base - mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    tip = np.array(ca.DM(frame_pose(robot, FLANGE, q).position)).ravel()
    arm = np.cross(tip - centre, n)
    return float(1 / (1 / mass + arm @ np.linalg.solve(inertia_about, arm)))


def _from_peaks(
    robot: Robot, q: Array, n: Array, wall: float, wind_up: float, motors: Motors
) -> Array:
    """Return (F/v)²/k of the first contact, the mass that a spring k would tell."""
    springs = robot.torque_limits / wind_up
    model = impact_model(robot, FLANGE, drives=drives(robot, joint_stiffness=springs))
    velocity = np.array([approach_velocity(model, *at) for at in zip(q, n, strict=True)])
    rigid = BodyRegion("wall", "Wall", wall, 1.0, np.inf, None, 0.0)
    contact = Contact(replace(rigid, skin=PowerLaw(1e3 * wall, 1.0)))
    impacts = SampledImpacts(model, Samples(q, n, velocity), contact, motors, horizon=0.1)
    force = impacts.peaks(np.full(len(q), SPEED)).first_contact
    return np.asarray((force / SPEED) ** 2 / wall)
