# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact map``: how fast a robot may go, all over a plane or along its self-motion."""

from __future__ import annotations

from typing import Annotated

import typer

from ..typed import options as o
from ..typed.groups import But, TypedArm, TypedDrives
from .simulate import BODY, ClampedOption, CoverOption, HorizonOption

WHERE = "Where"

PostureOption = Annotated[
    str | None,
    typer.Option(
        "--q",
        metavar="LIST",
        help="Posture that the map goes through, in the file's joint order (rad, m); default one "
        "in which the robot moves well.",
        rich_help_panel=WHERE,
    ),
]
OverOption = Annotated[
    str,
    typer.Option(
        metavar="GROUND",
        help="plane (of the tip's places) or self-motion (postures that hold the tip).",
        rich_help_panel=WHERE,
    ),
]
PlaneNameOption = Annotated[
    str,
    typer.Option(
        "--plane",
        metavar="AXES",
        help="xy, xz or yz (base axes), through the tip's place.",
        rich_help_panel=WHERE,
    ),
]
StepOption = Annotated[
    float,
    typer.Option(
        metavar="X",
        help="Between places (m), or between postures of the self-motion (rad).",
        rich_help_panel=WHERE,
    ),
]
HoldOption = Annotated[
    str | None,
    typer.Option(
        "--hold",
        metavar="WHAT",
        help="pose: the tip keeps its turn (default from six joints on); position: it may turn.",
        rich_help_panel=WHERE,
    ),
]
DirectionOption = Annotated[
    str | None,
    typer.Option(
        metavar="LIST",
        help="Direction of the impacts in the base's axes; default the worst at each posture.",
    ),
]
RegionOption = Annotated[
    str,
    typer.Option(
        metavar="NAME", help="Region or area of the body: chest, hand, ...", rich_help_panel=BODY
    ),
]
SpeedOption = Annotated[float, typer.Option(metavar="V", help="Speed of the peaks (m/s).")]


def safety_map(
    arm: TypedArm,
    drives: Annotated[TypedDrives, But(computed_torque_gain=None, torque_limit=None)],
    out: o.OutOption,
    q: PostureOption = None,
    over: OverOption = "plane",
    plane: PlaneNameOption = "xz",
    step: StepOption = 0.05,
    hold: HoldOption = None,
    direction: DirectionOption = None,
    region: RegionOption = "chest",
    cover: CoverOption = None,
    clamped: ClampedOption = True,
    speed: SpeedOption = 0.5,
    horizon: HorizonOption = None,
    gravity: o.GravityOption = None,
    json: o.JsonOption = False,
) -> None:
    """Map safe speed, peak force and worst direction over a plane or the self-motion."""
    from ..map.safety_map import TypedMap
    from ..map.safety_map import safety_map as mapped
    from ..output.printed import print_json, print_warnings
    from ..output.progress import progress_bar
    from ..output.results_folder import replaced_folder, require_replaceable_results
    from ..report.map_files import GENERATOR, map_record, print_map, write_map

    require_replaceable_results(out, GENERATOR)
    how = TypedMap(
        arm=arm,
        drives=drives,
        q=q,
        over=over,
        plane=plane,
        step=step,
        hold=hold,
        direction=direction,
        region=region,
        cover=cover,
        clamped=clamped,
        speed=speed,
        horizon=horizon,
        gravity=gravity,
    )
    with progress_bar() as progress:
        task = progress.add_task("impacts", total=None)
        found = mapped(how, lambda count: progress.advance(task, count))
    print_warnings(found.warnings)
    record = map_record(found)
    with replaced_folder(out, GENERATOR) as fresh:
        write_map(found, record, fresh)
    if json:
        print_json({"out": out, **record})
    else:
        print_map(found, out)
