# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact factors``: impact factors and measures of a fixed or floating robot."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any

import typer

from ..typed import options as o
from ..typed.groups import TypedArm, TypedDrives

IMPULSES = "Impulses at the joints"


def factors(
    arm: TypedArm,
    q: o.ConfigurationOption,
    direction: o.DirectionOption,
    floating: Annotated[
        bool,
        typer.Option(
            "--floating",
            help="Set the base free; --q holds all joints of the file, not just those to the tip.",
        ),
    ] = False,
    rotor_inertia: o.RotorInertiaOption = None,
    gear_ratio: o.GearRatioOption = None,
    speed: Annotated[
        float, typer.Option(metavar="X", help="Of approach (m/s).", rich_help_panel=IMPULSES)
    ] = 1.0,
    restitution: Annotated[
        float,
        typer.Option(
            metavar="X", help="e, from 0 (no rebound) to 1 (elastic).", rich_help_panel=IMPULSES
        ),
    ] = 0.0,
    other_mass: Annotated[
        float,
        typer.Option(
            metavar="X", help="Of what is hit (kg); default held.", rich_help_panel=IMPULSES
        ),
    ] = float("inf"),
    json: o.JsonOption = False,
) -> None:
    """Print impact factors: GIAF and its kin, IMF, dynamic impact measure, joint impulses."""
    from softimpact.symbolic import InvalidValue, impact_factors

    from ..output.printed import print_json, print_warnings
    from ..typed.situation import (
        Typed,
        free_situation,
        situation,
        unknown_rotors_line,
    )

    given = TypedDrives(rotor_inertia=rotor_inertia, gear_ratio=gear_ratio)
    typed = Typed(arm, q, direction, given)
    if floating and arm.hold_base:
        raise InvalidValue("hold_base", "excludes floating; give one of them")
    scene = free_situation(typed) if floating else situation(typed)
    found = impact_factors(
        scene.model,
        scene.q,
        scene.direction,
        speed=speed,
        restitution=restitution,
        other_mass=other_mass,
    )
    robot = scene.model.robot
    own = len(scene.q) - found.impulse.joints.shape[0]  # a floating base comes first
    result: dict[str, Any] = {
        "robot": robot.name,
        "joints": robot.joint_names[own:],
        "tip": scene.model.tip,
        "floating": floating,
        "q": scene.q[own:],
        "direction": scene.direction,
        "speed": speed,
        "restitution": restitution,
        "other_mass": other_mass,
        **flat(found),
        "warnings": [*scene.warnings, *unknown_rotors_line(scene.model)],
    }
    print_warnings(result["warnings"])
    if json:
        print_json(result)
    else:
        _print_tables(result)


def flat(found: Any) -> dict[str, Any]:
    """Return the factors on one level; those that do not apply are None."""
    from softimpact.symbolic.factors.impact_factors import Mitigation, SpatialFactors

    result = dict(vars(found))
    for name, kind in (("spatial", SpatialFactors), ("mitigation", Mitigation)):
        part = result.pop(name)
        result |= dict.fromkeys(kind.__annotations__) if part is None else vars(part)
    result |= vars(result.pop("measures"))
    return result


def _reasons(result: Mapping[str, Any]) -> Iterator[str]:
    """Yield why numbers are dashes."""
    from ..output.dashes import FEWER

    if result["giaf"] is None or result["force_measure"] is None:
        yield f"– GIAF and its kin, measures: {FEWER}"
    if result["imf"] is None:
        yield f"– IMF: {FEWER if result['floating'] else 'the base is held (--floating)'}"


def _print_tables(result: Mapping[str, Any]) -> None:
    from ..output.dashes import explain
    from ..output.printed import print_table

    least = result["directional_giaf_extremes"]
    print_table(
        f"Impact factors of {result['robot']} at {result['tip']}",
        ("quantity", "value", "unit"),
        [
            ("absorption factor, GIAF", result["giaf"], ""),
            ("  over the directions the point can move in", result["giaf_movable"], ""),
            ("increment factor, GIIF", result["giif"], ""),
            ("GIAF along the direction", result["directional_giaf"], ""),
            ("  least in any direction", None if least is None else least.least, ""),
            ("  greatest in any direction", None if least is None else least.greatest, ""),
            ("mass felt without rotors", result["reflected_mass_free"], "kg"),
            ("mass felt with them, all rigid", result["reflected_mass_rigid"], "kg"),
            ("impact mitigation factor, IMF", result["imf"], ""),
            ("IMF along the direction", result["directional_imf"], ""),
            ("manipulability", result["manipulability"], ""),
            ("force measure", result["force_measure"], ""),
            ("dynamic impact measure", result["dynamic_impact_measure"], "kg³ m³"),
            ("impulse of the impact", result["impulse"].contact, "N s"),
        ],
    )
    explain(_reasons(result))
    rows = len(result["joints"])
    alone, slope = (
        [None] * rows if result[name] is None else result[name]
        for name in ("single_joint_giaf", "giaf_by_gear")
    )
    impulse = result["impulse"]
    print_table(
        "Joint by joint",
        ("joint", "GIAF of it alone", "∂GIAF/∂ln N", "impulse N·m s", "of the rotor N·m s"),
        list(zip(result["joints"], alone, slope, impulse.joints, impulse.gears, strict=True)),
    )
