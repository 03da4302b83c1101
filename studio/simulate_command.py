# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact simulate``: the contact force of one impact over time."""

from __future__ import annotations

from typing import Annotated

import typer

from . import options as o

Region = Annotated[str, typer.Option(metavar="NAME", help="Region of the body: head, chest, ...")]
Speed = Annotated[
    float, typer.Option(metavar="V", help="Speed of the contact point along the direction (m/s).")
]
JointVelocity = Annotated[
    str | None,
    typer.Option(
        metavar="LIST",
        help="Joint velocities before the impact, scaled to --speed; default those of least norm.",
    ),
]
Clamped = Annotated[
    bool, typer.Option("--clamped/--free", help="Whether the region is held or can give way.")
]
Peak = Annotated[
    str, typer.Option(help="first_contact (largest force until separation) or first_peak.")
]
Pid = Annotated[
    str | None,
    typer.Option(
        metavar="LIST",
        help="k_p, k_d, k_i of MSM's computed-torque controller (rad/s², rad/s, rad/s³), which "
        "reacts after 20 ms; for chain, linearised and full.",
    ),
]
Reference = Annotated[
    str, typer.Option(help="Of the controller after first touch: moving (on) or held.")
]
SafeSpeed = Annotated[
    bool, typer.Option("--safe-speed", help="Find the largest speed within the region's limit.")
]


def simulate(
    model: o.Model,
    q: o.Configuration,
    direction: o.Direction,
    region: Region,
    speed: Speed,
    tip: o.Tip = None,
    fidelity: o.Fidelity = "linearised",
    clamped: Clamped = True,
    joint_velocity: JointVelocity = None,
    peak: Peak = "peak",
    pid: Pid = None,
    reference: Reference = "moving",
    safe_speed: SafeSpeed = False,
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
    """Simulate an impact on a body region and hold it against the region's force limit."""
    from .impact import TypedImpact, impact, print_impact
    from .output import print_json
    from .situation import Typed, TypedDrives

    given = TypedDrives(
        joint_stiffness, rotor_inertia, position_gain, computed_torque_gain, gear_ratio
    )
    where = Typed(model, tip, q, direction, given, gravity, motor_angles)
    how = TypedImpact(
        region, speed, fidelity, clamped, joint_velocity, peak, safe_speed, order, pid, reference
    )
    result = impact(where, how)
    if json:
        print_json(result)
    else:
        print_impact(result)
