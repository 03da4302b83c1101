# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact program``: how fast a robot's program may run, and what limits it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer.core import TyperCommand

from ..typed import options as o
from ..typed.groups import But, TypedArm, TypedDrives
from .simulate import BODY, ClampedOption, CoverOption, HorizonOption, ShapeOption


class SeveralValues(TyperCommand):
    """Lets options that may be repeated take several values at once: ``--points A B``."""

    def parse_args(self, ctx: typer.Context, args: list[str]) -> list[str]:  # type: ignore[override]
        """Repeat such an option before each of its values."""
        several = {
            name
            for parameter in self.params
            if getattr(parameter, "multiple", False)
            for name in parameter.opts
        }
        words: list[str] = []
        option, empty = "", False
        for word in args:
            if word.startswith("--"):
                words += [option] if empty else []
                option = word if word in several else ""
                empty = bool(option)
                words += [] if option else [word]
            else:
                words += [option, word] if option else [word]
                empty = False
        words += [option] if empty else []
        return list(super().parse_args(ctx, words))


MotionArgument = Annotated[
    Path,
    typer.Argument(
        metavar="MOTION",
        help="CSV: columns t (s) and one for each joint of the arm, by name (rad, m); or JSON: "
        "waypoints, each with q and a speed (m/s) or time (s).",
        show_default=False,
    ),
]
RobotOption = Annotated[
    str,
    typer.Option(
        "--model",
        metavar="MODEL",
        help="Built-in robot, file (URDF, MJCF, xacro), or name of robot_descriptions.",
    ),
]
PointsOption = Annotated[
    list[str] | None,
    typer.Option(
        "--points",
        metavar="FRAME...",
        help="Points of the arm that may hit somebody: frames, or BODY@x,y,z; default the end and "
        "frames some 0.15 m apart along the arm.",
    ),
]
RegionsOption = Annotated[
    list[str] | None,
    typer.Option(
        "--regions",
        metavar="NAME...",
        help="Regions or areas of the body that they may hit everywhere.",
        rich_help_panel=BODY,
    ),
]
ZonesOption = Annotated[
    Path | None,
    typer.Option(
        "--zones",
        metavar="FILE",
        help="Regions that may be hit in boxes or spans of time only (TOML).",
        rich_help_panel=BODY,
    ),
]
EngineOption = Annotated[
    str,
    typer.Option(
        metavar="NAME",
        help="Who integrates impacts: c (generated and compiled, from 20,000 impacts on), python, "
        "or auto.",
    ),
]
BandOption = Annotated[
    bool,
    typer.Option(
        "--band", help="Show where 95 of 100 cases of the worst moments lie, for what is not known."
    ),
]
OutOption = Annotated[
    Path | None,
    typer.Option("--out", metavar="DIR", help="Folder for results.json, CSV tables and a figure."),
]


def program(
    motion: MotionArgument,
    arm: Annotated[TypedArm, But(model=RobotOption, tip=None)],
    drives: Annotated[TypedDrives, But(computed_torque_gain=None)],
    regions: RegionsOption = None,
    zones: ZonesOption = None,
    points: PointsOption = None,
    cover: CoverOption = None,
    shape: ShapeOption = None,
    clamped: ClampedOption = True,
    horizon: HorizonOption = None,
    gravity: o.GravityOption = None,
    band: BandOption = False,
    engine: EngineOption = "auto",
    out: OutOption = None,
    report: o.ReportOption = None,
    json: o.JsonOption = False,
) -> None:
    """Find the factor by which to slow a motion down, so that no watched point can hurt."""
    from ..output.printed import print_json, print_warnings
    from ..output.results_folder import (
        replaced_folder,
        require_folder_of,
        require_replaceable_results,
    )
    from ..program.program import TypedProgram, run_program
    from ..program.record import GENERATOR, print_program

    require_folder_of(report)
    if out is not None:
        require_replaceable_results(out, GENERATOR)
    how = TypedProgram(
        arm=arm,
        drives=drives,
        points=tuple(points or ()),
        regions=tuple(name for text in regions or () for name in text.split(",") if name),
        zones=zones,
        cover=cover,
        shape=shape,
        clamped=clamped,
        horizon=horizon,
        gravity=gravity,
        band=band,
        engine=engine,
    )
    found = run_program(motion, how)
    print_warnings(found.record["warnings"])
    if out is not None:
        from ..report.program_files import write_program

        with replaced_folder(out, GENERATOR) as fresh:
            write_program(found, fresh)
    if report is not None:
        from ..report.program_report import write_program_report

        write_program_report(found, report)
    if json:
        print_json({"out": out, **found.record})
    else:
        print_program(found, out)
