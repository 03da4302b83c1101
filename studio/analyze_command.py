# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact analyze``: masses, springs and impact factors at one configuration."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import options as o

if TYPE_CHECKING:
    from softimpact.symbolic import Analysis


def analyze(
    model: o.Model,
    q: o.Configuration,
    direction: o.Direction,
    tip: o.Tip = None,
    joint_stiffness: o.JointStiffness = None,
    rotor_inertia: o.RotorInertia = None,
    position_gain: o.PositionGain = None,
    computed_torque_gain: o.ComputedTorqueGain = None,
    gear_ratio: o.GearRatio = None,
    gravity: o.Gravity = None,
    motor_angles: o.MotorAngles = False,
    order: o.Order = 3,
    json: o.Json = False,
) -> None:
    """Print what an impact meets: m_c, k_r, m_a, the chain and the impact factors."""
    from softimpact.symbolic import analyse

    from .output import print_json
    from .situation import Typed, TypedDrives, situation

    given = TypedDrives(
        joint_stiffness, rotor_inertia, position_gain, computed_torque_gain, gear_ratio
    )
    scene = situation(Typed(model, tip, q, direction, given, gravity, motor_angles))
    result = analyse(scene.model, scene.q, scene.direction, order)
    if json:
        robot = scene.model.robot
        about = {"robot": robot.name, "joints": robot.joint_names, "tip": scene.model.tip}
        print_json({**about, "q": scene.q, "direction": scene.direction, **vars(result)})
        return
    _print_tables(result)


def _print_tables(result: Analysis) -> None:
    from .output import print_table

    print_table(
        "What the impact meets",
        ("quantity", "value", "unit"),
        [
            ("mass felt at the contact point, m_c", result.m_c, "kg"),
            ("reflected stiffness, k_r", result.k_r, "N/m"),
            ("mass on the actuators' side, m_a", result.m_a, "kg"),
            ("stiffness met by a slow push, k_c", result.static_stiffness, "N/m"),
            ("reflected mass with rigid joints", result.reflected_mass_rigid, "kg"),
            ("impact absorption factor, GIAF", result.giaf, ""),
            ("impact increment factor, GIIF", result.giif, ""),
            ("GIAF along the direction", result.directional_giaf, ""),
        ],
    )
    masses, springs = result.chain.mass, result.chain.stiffness
    print_table(
        "Chain, from the contact point to ground",
        ("", "mass [kg]", "spring behind it [N/m]"),
        [(str(i + 1), *pair) for i, pair in enumerate(zip(masses, springs, strict=True))],
    )
    for title, matrix in (
        ("Operational space inertia Λ, with rotors [kg]", result.osim),
        ("Operational space inertia Λ_F, without [kg]", result.osim_free),
    ):
        if matrix is not None:
            print_table(title, ("x", "y", "z"), matrix.tolist())
