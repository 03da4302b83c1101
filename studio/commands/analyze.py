# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact analyze``: masses, springs and impact factors at one configuration."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Annotated, Any

from ..typed import options as o
from ..typed.groups import But, TypedArm, TypedDrives

if TYPE_CHECKING:
    from softimpact.symbolic import Analysis

    from ..typed.situation import Situation


NO_SPRING = 1e-9
"""Share of a chain's stiffest spring that is what rounding leaves of none."""


def analyze(
    arm: Annotated[TypedArm, But(tip=None)],
    drives: Annotated[
        TypedDrives,
        But(reaction_time=None, stopping_time=None, damping_gain=None, torque_limit=None),
    ],
    q: o.ConfigurationOption,
    direction: o.DirectionsOption,
    tip: o.TipsOption = None,
    gravity: o.GravityOption = None,
    motor_angles: o.MotorAnglesOption = False,
    order: o.OrderOption = 3,
    json: o.JsonOption = False,
) -> None:
    """Print what an impact meets: m_c, k_r, m_a, the chain and the impact factors.

    Points and directions may be repeated: all combinations are analysed then.
    """
    from softimpact.symbolic import analyse

    from ..output.printed import print_json, print_warnings
    from ..typed.motors import motors_meant
    from ..typed.situation import Typed, situation, unknown_rotors_line

    known, _ = motors_meant(drives)
    law = None if known is None else known.kind
    points: list[str | None] = [*tip] if tip else [None]
    found, warnings = [], []
    for point, along in product(points, direction):
        typed = Typed(replace(arm, tip=point), q, along, drives, gravity, motor_angles)
        scene = situation(typed)
        found.append((scene, analyse(scene.model, scene.q, scene.direction, order, law)))
        warnings += [*scene.warnings, *unknown_rotors_line(scene.model)]
    warnings = list(dict.fromkeys(warnings))
    print_warnings(warnings)
    records = [_record(scene, result) for scene, result in found]
    if json and len(found) > 1:
        print_json({"analyses": records, "warnings": warnings})
    elif json:
        print_json({**records[0], "warnings": warnings})
    elif len(found) > 1:
        _print_rows(found)
    else:
        _print_tables(found[0][1])


def _record(scene: Situation, result: Analysis) -> dict[str, Any]:
    robot = scene.model.robot
    about = {"robot": robot.name, "joints": robot.joint_names, "tip": scene.model.tip}
    return {**about, "q": scene.q, "direction": scene.direction, **vars(result)}


def _print_rows(found: list[tuple[Situation, Analysis]]) -> None:
    """Print a line for each point and direction."""
    from ..output.dashes import explain, reasons
    from ..output.printed import print_table

    print_table(
        "What the impacts meet",
        ("point", "direction", "m_c kg", "k_r N/m", "m_a kg", "rigid kg", "GIAF", "along n"),
        [
            (
                scene.model.tip,
                ", ".join(f"{x:.3g}" for x in scene.direction),
                result.m_c,
                result.k_r,
                result.m_a,
                result.reflected_mass_rigid,
                result.giaf,
                result.directional_giaf,
            )
            for scene, result in found
        ],
    )
    explain(reasons(result for _, result in found))


def _print_tables(result: Analysis) -> None:
    from ..output.dashes import NO_PUSH, explain, reasons
    from ..output.printed import print_table

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
    no_push = [NO_PUSH] if result.static_stiffness is None else []
    explain([*no_push, *reasons([result])])
    masses, springs = result.chain.mass, result.chain.stiffness
    print_table(
        "Chain, from the contact point to ground",
        ("", "mass [kg]", "spring behind it [N/m]"),
        [
            (str(i + 1), m, k if abs(k) > NO_SPRING * max(springs) else 0.0)
            for i, (m, k) in enumerate(zip(masses, springs, strict=True))
        ],
    )
    for title, matrix in (
        ("Operational space inertia Λ, with rotors [kg]", result.osim),
        ("Operational space inertia Λ_F, without [kg]", result.osim_free),
    ):
        if matrix is not None:
            print_table(title, ("x", "y", "z"), matrix.tolist())
