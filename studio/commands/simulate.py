# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact simulate``: the contact force of one impact over time, and the verdict on it."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import typer

from ..typed import options as o
from ..typed.groups import But, TypedArm, TypedDrives

BODY = "What is hit"

RegionsOption = Annotated[
    list[str] | None,
    typer.Option(
        "--region",
        metavar="NAME",
        help="Region or area of the body: chest, hand, ...; may be repeated.",
        rich_help_panel=BODY,
    ),
]
BodyOption = Annotated[
    str | None,
    typer.Option(
        metavar="FILE", help="A body of your own (TOML) instead of --region.", rich_help_panel=BODY
    ),
]
CoverOption = Annotated[
    str | None,
    typer.Option(
        metavar="FILE", help="What the robot wears at the contact (TOML).", rich_help_panel=BODY
    ),
]
ShapeOption = Annotated[
    str | None,
    typer.Option(
        metavar="SHAPE",
        help="What of the robot touches, so that pressure is judged, too: sphere:RADIUS, "
        "edge:RADIUS,LENGTH or flat:AREA,RIM_RADIUS (m, m²).",
        rich_help_panel=BODY,
    ),
]
ClampedOption = Annotated[
    bool,
    typer.Option(
        "--clamped/--free",
        help="Whether the region is held or can give way.",
        rich_help_panel=BODY,
    ),
]
SpeedOption = Annotated[
    float | None,
    typer.Option(
        metavar="V",
        help="Speed of the contact point along the direction (m/s); default that of "
        "--joint-velocity, or of --safe-speed.",
    ),
]
JointVelocityOption = Annotated[
    str | None,
    typer.Option(
        metavar="LIST",
        help="Joint velocities before the impact (rad/s, m/s), scaled to --speed if both are "
        "given; default those of least norm.",
    ),
]
PeakOption = Annotated[
    str,
    typer.Option(
        help="Which force peak_force of --json is: peak (largest of all contacts), "
        "first_contact or first_peak; verdict and safe speed are by peak."
    ),
]
PidOption = Annotated[
    str | None,
    typer.Option(
        metavar="LIST",
        help="k_p, k_d, k_i of MSM's computed-torque controller (rad/s², rad/s, rad/s³); for "
        "chain, linearised and full.",
        rich_help_panel=o.MOTORS,
    ),
]
ReferenceOption = Annotated[
    str | None,
    typer.Option(
        help="Where that controller leads the motors after first touch: moving (on, the default) "
        "or held.",
        rich_help_panel=o.MOTORS,
    ),
]
HorizonOption = Annotated[
    float | None,
    typer.Option(metavar="S", help="How long contacts count (s); default 0.5."),
]
BandOption = Annotated[
    bool,
    typer.Option(
        "--band", help="Show where 95 of 100 cases lie, for what is not known exactly (tolerances)."
    ),
]
SafeSpeedOption = Annotated[
    bool,
    typer.Option("--safe-speed", help="Find the largest speed up to which every limit is kept."),
]


def simulate(
    arm: Annotated[TypedArm, But(tip=None)],
    drives: TypedDrives,
    q: o.ConfigurationOption,
    direction: o.DirectionsOption,
    region: RegionsOption = None,
    speed: SpeedOption = None,
    tip: o.TipsOption = None,
    fidelity: o.FidelityOption = "linearised",
    body: BodyOption = None,
    cover: CoverOption = None,
    shape: ShapeOption = None,
    clamped: ClampedOption = True,
    joint_velocity: JointVelocityOption = None,
    peak: PeakOption = "peak",
    horizon: HorizonOption = None,
    pid: PidOption = None,
    reference: ReferenceOption = None,
    safe_speed: SafeSpeedOption = False,
    band: BandOption = False,
    report: o.ReportOption = None,
    gravity: o.GravityOption = None,
    motor_angles: o.MotorAnglesOption = False,
    order: o.OrderOption = 3,
    json: o.JsonOption = False,
) -> None:
    """Simulate an impact and hold it against what the body may bear.

    Points, directions and regions may be repeated: all combinations are simulated then.
    """
    from ..impact.impact import TypedBody, TypedImpact, impact
    from ..impact.impacts import combinations, impacts, print_impacts
    from ..impact.record import print_impact, record_of
    from ..output.printed import print_json, print_warnings
    from ..typed.situation import Typed

    points: list[str | None] = [*tip] if tip else [None]
    regions: list[str | None] = [*region] if region else [None]
    where = Typed(replace(arm, tip=points[0]), q, direction[0], drives, gravity, motor_angles)
    how = TypedImpact(
        body=TypedBody(regions[0], body, cover, clamped, shape),
        speed=speed,
        fidelity=fidelity,
        joint_velocity=joint_velocity,
        peak=peak,
        horizon=horizon,
        safe_speed=safe_speed,
        band=band,
        order=order,
        pid=pid,
        reference=reference,
    )
    asked = combinations(where, how, points, direction, regions)
    if len(asked) > 1:
        several = impacts(asked, report)
        print_warnings(several["warnings"])
        (print_json if json else print_impacts)(several)
        return
    answer = impact(where, how)
    result = record_of(answer)
    print_warnings(result["warnings"])
    if report is not None:
        from ..report.impact_report import write_impact_report

        write_impact_report(answer, result, report)
    if json:
        print_json(result)
    else:
        print_impact(result)
