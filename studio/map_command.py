# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact map``: how fast a robot may go, all over a plane or along its self-motion."""

from __future__ import annotations

from typing import Annotated

import typer

from . import options as o
from .simulate_command import BODY, Clamped, Cover, Horizon

WHERE = "Where"

Posture = Annotated[
    str | None,
    typer.Option(
        "--q",
        metavar="LIST",
        help="Posture that the map goes through, in the file's joint order (rad, m); default one "
        "in which the robot moves well.",
        rich_help_panel=WHERE,
    ),
]
Over = Annotated[
    str,
    typer.Option(
        metavar="GROUND",
        help="plane (of the tip's places) or self-motion (postures that hold the tip).",
        rich_help_panel=WHERE,
    ),
]
PlaneName = Annotated[
    str,
    typer.Option(
        "--plane",
        metavar="AXES",
        help="xy, xz or yz (base axes), through the tip's place.",
        rich_help_panel=WHERE,
    ),
]
Step = Annotated[
    float,
    typer.Option(
        metavar="X",
        help="Between places (m), or between postures of the self-motion (rad).",
        rich_help_panel=WHERE,
    ),
]
Hold = Annotated[
    str | None,
    typer.Option(
        "--hold",
        metavar="WHAT",
        help="pose: the tip keeps its turn (default from six joints on); position: it may turn.",
        rich_help_panel=WHERE,
    ),
]
Direction = Annotated[
    str | None,
    typer.Option(
        metavar="LIST",
        help="Direction of the impacts in the base's axes; default the worst at each posture.",
    ),
]
Region = Annotated[
    str,
    typer.Option(
        metavar="NAME", help="Region or area of the body: chest, hand, ...", rich_help_panel=BODY
    ),
]
Speed = Annotated[float, typer.Option(metavar="V", help="Speed of the peaks (m/s).")]


def safety_map(
    model: o.Model,
    out: o.Out,
    q: Posture = None,
    over: Over = "plane",
    plane: PlaneName = "xz",
    step: Step = 0.05,
    hold: Hold = None,
    direction: Direction = None,
    region: Region = "chest",
    cover: Cover = None,
    clamped: Clamped = True,
    speed: Speed = 0.5,
    tip: o.Tip = None,
    end: o.End = None,
    lock: o.Lock = None,
    payload: o.Payload = None,
    tool: o.Tool = None,
    motors: o.Motors = None,
    reaction_time: o.ReactionTime = None,
    stopping_time: o.StoppingTime = None,
    horizon: Horizon = None,
    joint_stiffness: o.JointStiffness = None,
    rotor_inertia: o.RotorInertia = None,
    position_gain: o.PositionGain = None,
    damping_gain: o.DampingGain = None,
    gear_ratio: o.GearRatio = None,
    gravity: o.Gravity = None,
    json: o.Json = False,
) -> None:
    """Map safe speed, peak force and worst direction over a plane or the self-motion."""
    from .map_files import GENERATOR, map_record, print_map, write_map
    from .output import print_json, print_warnings
    from .progress import progress_bar
    from .results_folder import replaced_folder, require_replaceable
    from .safety_map import TypedMap
    from .safety_map import safety_map as mapped
    from .situation import TypedArm, TypedDrives
    from .typed_motors import TypedMotors

    require_replaceable(out, GENERATOR)
    how = TypedMap(
        arm=TypedArm(model, tip, end, lock, payload, tool),
        drives=TypedDrives(
            joint_stiffness,
            rotor_inertia,
            position_gain,
            None,
            gear_ratio,
            damping_gain,
            servo=motors == "servo",
        ),
        motors=TypedMotors(motors, reaction_time, stopping_time),
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
