# SPDX-License-Identifier: BSD-3-Clause
"""Options that commands share, as the command line declares them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

DRIVES = "Drives (a number for all joints, or a JSON list)"
MOTORS = "What the motors do"

ModelArgument = Annotated[
    str,
    typer.Argument(
        metavar="MODEL",
        help="Built-in robot, file (URDF, MJCF, xacro), or name of robot_descriptions.",
        show_default=False,
    ),
]
TipOption = Annotated[
    str | None,
    typer.Option(
        "--tip",
        metavar="FRAME",
        help="Contact frame, or BODY@x,y,z for any point of a body (m); default the model's own.",
    ),
]
ConfigurationOption = Annotated[
    str,
    typer.Option(
        "--q",
        metavar="LIST",
        help="Link angles of the arm up to its end, in the file's joint order (rad, m).",
    ),
]
MotorAnglesOption = Annotated[
    bool,
    typer.Option(
        "--motor-angles", help="--q holds motor angles; gravity bends the springs from there."
    ),
]
DirectionOption = Annotated[
    str,
    typer.Option(
        "--direction",
        metavar="LIST",
        help="Direction of the impact in the base's axes, of any length.",
    ),
]
TipsOption = Annotated[
    list[str] | None,
    typer.Option(
        "--tip",
        metavar="FRAME",
        help="Contact frame, or BODY@x,y,z for any point of a body (m); default the model's own. "
        "May be repeated.",
    ),
]
DirectionsOption = Annotated[
    list[str],
    typer.Option(
        "--direction",
        metavar="LIST",
        help="Direction of the impact in the base's axes, of any length; may be repeated.",
    ),
]
JointStiffnessOption = Annotated[
    str | None,
    typer.Option(
        metavar="LIST|X",
        help="k_s (N·m/rad), inf for a rigid joint; default all rigid.",
        rich_help_panel=DRIVES,
    ),
]
RotorInertiaOption = Annotated[
    str | None,
    typer.Option(
        metavar="LIST|X|NAME",
        help="Reflected inertia (kg m²), or one of the model's named sets; default the file's.",
        rich_help_panel=DRIVES,
    ),
]
PositionGainOption = Annotated[
    str | None,
    typer.Option(
        metavar="LIST|X",
        help="Diagonal of K_p (N·m/rad); default zero.",
        rich_help_panel=DRIVES,
    ),
]
ComputedTorqueGainOption = Annotated[
    float | None,
    typer.Option(
        metavar="X",
        help="k_p (rad/s²) of computed-torque control instead: K_p = k_p M.",
        rich_help_panel=DRIVES,
    ),
]
GearRatioOption = Annotated[
    str | None,
    typer.Option(
        metavar="LIST|X",
        help="N; --rotor-inertia is then the motors' own and counts N² times.",
        rich_help_panel=DRIVES,
    ),
]
DampingGainOption = Annotated[
    str | None,
    typer.Option(
        metavar="LIST|X",
        help="Diagonal of K_d (N·m·s/rad) of a servo; default zero.",
        rich_help_panel=DRIVES,
    ),
]
TorqueLimitOption = Annotated[
    str | None,
    typer.Option(
        metavar="LIST|X",
        help="Largest torque that a servo adds (N·m); default the file's.",
        rich_help_panel=DRIVES,
    ),
]
MotorsOption = Annotated[
    str | None,
    typer.Option(
        "--motors",
        metavar="KIND",
        help="free, servo, driven, or held (the papers' only). Default: servo where gains are "
        "given, else both ends of the bracket, free and driven, of which the worse counts.",
        rich_help_panel=MOTORS,
    ),
]
ReactionTimeOption = Annotated[
    float | None,
    typer.Option(
        metavar="S",
        help="From first touch until the motors are released (s), inf: never; default 0.02.",
        rich_help_panel=MOTORS,
    ),
]
StoppingTimeOption = Annotated[
    float | None,
    typer.Option(
        metavar="S",
        help="The motors come to rest in that time (s); default: they are released.",
        rich_help_panel=MOTORS,
    ),
]
EndOption = Annotated[
    str | None,
    typer.Option(
        "--end",
        metavar="FRAME",
        help="End of the arm: all joints on the way to it stay, also beyond the contact point; "
        "default the model's own tip if they are on the way to it.",
    ),
]
LockOption = Annotated[
    str | None,
    typer.Option(
        metavar="JOINT=X,...", help="Joints to weld, and where (rad, m); others off the way at 0."
    ),
]
HoldBaseOption = Annotated[
    bool,
    typer.Option(
        "--hold-base", help="Hold the base of a robot that floats or stands, where its file has it."
    ),
]
PayloadOption = Annotated[
    str | None,
    typer.Option(
        metavar="MASS[@x,y,z]",
        help="What the end holds (kg), and its centre in the end's axes (m); default nothing.",
    ),
]
ToolOption = Annotated[
    str | None,
    typer.Option(
        metavar="FILE", help="Tool at the end: TOML with mass (kg), com (m) and inertia (kg m²)."
    ),
]
GravityOption = Annotated[
    str | None,
    typer.Option(
        metavar="LIST", help="Gravity in the base's axes (m/s²), which enters K0; default none."
    ),
]
FidelityOption = Annotated[
    str,
    typer.Option("--model", help="Of the impact: one_mass, two_mass, chain, linearised or full."),
]
OrderOption = Annotated[
    int, typer.Option(min=1, help="Masses of the chain, where that is the model.")
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]
OutOption = Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder to write into.")]
StudyFileArgument = Annotated[
    str,
    typer.Argument(
        metavar="STUDY",
        help="Study file (.toml), or the name of a built-in study.",
        show_default=False,
    ),
]
RegionOption = Annotated[
    str | None, typer.Option(metavar="NAME", help="Region of the body; default the study's.")
]
SpeedOption = Annotated[
    float | None, typer.Option(metavar="V", help="Speed (m/s); default the study's.")
]
StudyMotorsOption = Annotated[
    str | None,
    typer.Option("--motors", metavar="KIND", help="free, servo or driven; default the study's."),
]
ReportOption = Annotated[
    Path | None,
    typer.Option(
        "--report", metavar="FILE", help="Write a report: one HTML page that opens offline."
    ),
]

WorkersOption = Annotated[
    int | None,
    typer.Option(
        "--workers", metavar="N", help="Processes that search; default one for each core."
    ),
]
DaskOption = Annotated[
    str | None,
    typer.Option(
        "--dask", metavar="ADDRESS", help="Scheduler of a Dask cluster whose workers search."
    ),
]
ResumeOption = Annotated[
    bool,
    typer.Option("--resume", help="Go on where an earlier run of this study was ended."),
]
