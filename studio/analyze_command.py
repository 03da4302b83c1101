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
    end: o.End = None,
    lock: o.Lock = None,
    hold_base: o.HoldBase = False,
    payload: o.Payload = None,
    tool: o.Tool = None,
    motors: o.Motors = None,
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

    from .output import print_json, print_warnings
    from .situation import Typed, TypedArm, TypedDrives, situation, unknown_rotors
    from .typed_motors import TypedMotors, motors_of

    given = TypedDrives(
        joint_stiffness, rotor_inertia, position_gain, computed_torque_gain, gear_ratio
    )
    known, _ = motors_of(TypedMotors(motors), given)
    arm = TypedArm(model, tip, end, lock, payload, tool, hold_base)
    scene = situation(Typed(arm, q, direction, given, gravity, motor_angles))
    law = None if known is None else known.kind
    result = analyse(scene.model, scene.q, scene.direction, order, law)
    warnings = [*scene.warnings, *unknown_rotors(scene.model)]
    print_warnings(warnings)
    if json:
        robot = scene.model.robot
        about = {"robot": robot.name, "joints": robot.joint_names, "tip": scene.model.tip}
        numbers = {"q": scene.q, "direction": scene.direction, **vars(result)}
        print_json({**about, **numbers, "warnings": warnings})
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
