# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact generate``: a robot's impact model as a C package."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..typed import options as o
from ..typed.groups import But, TypedArm, TypedDrives

if TYPE_CHECKING:
    from collections.abc import Callable

    from softimpact.codegen import Manifest, Payload
    from softimpact.symbolic import Contact, Robot

RealOption = Annotated[str, typer.Option(metavar="TYPE", help="Number type: float or double.")]
NameOption = Annotated[
    str | None, typer.Option(metavar="NAME", help="Prefix of all C names; default the robot's.")
]
PAYLOAD = "What the robot carries"

DEFAULTS = But(
    motors=None,
    reaction_time=None,
    stopping_time=None,
    damping_gain=None,
    computed_torque_gain=None,
    torque_limit=None,
)
"""What a package is told with each impact, or has no default of."""

MANY_JOINTS = 14
"""From here on a package takes ten seconds and more; what it takes grows with the square: 20 and
30 joints in general position took 20 and 48 s, 370 and 650 MB, 5 and 11 MB of C."""


def generate(
    arm: Annotated[TypedArm, But(payload=None, tool=None)],
    drives: Annotated[TypedDrives, DEFAULTS],
    out: o.OutOption,
    real: RealOption = "double",
    name: NameOption = None,
    gravity: o.GravityOption = None,
    order: Annotated[
        int | None,
        typer.Option(
            min=1, help="Number of masses of the chain; default 3, or what the robot has."
        ),
    ] = None,
    floating: Annotated[
        bool,
        typer.Option(
            "--floating",
            help="Add the impact mitigation of the robot with its base set free; q holds all "
            "joints of the file.",
        ),
    ] = False,
    payload: Annotated[
        bool,
        typer.Option(
            "--payload",
            help="Add a point mass at the contact point's frame to the parameters.",
            rich_help_panel=PAYLOAD,
        ),
    ] = False,
    payload_mass: Annotated[
        float | None,
        typer.Option(metavar="X", help="Its default (kg).", rich_help_panel=PAYLOAD),
    ] = None,
    payload_com: Annotated[
        str | None,
        typer.Option(
            metavar="LIST",
            help="Its default place from the contact point, tip's axes (m).",
            rich_help_panel=PAYLOAD,
        ),
    ] = None,
    freeze: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="Parameters to build in instead, such as joint_stiffness,rotor_inertia, or all.",
        ),
    ] = None,
    poses: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Build in the candidate poses of a study, or of a JSON file.",
        ),
    ] = None,
    point: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=FRAME",
            help="Further contact point that speed_factor watches: a frame, or FRAME@x,y,z (m); "
            "may be repeated.",
        ),
    ] = None,
    contact: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=BODY[+COVER]",
            help="Body to build in beside the standard's regions: a region, area, device or body "
            "file, behind a pad or cover file; may be repeated.",
        ),
    ] = None,
    json: o.JsonOption = False,
) -> None:
    """Write a C99 package; the drives given are the defaults of its parameters."""
    from softimpact.codegen import generate_package
    from softimpact.codegen.record.manifest import Real
    from softimpact.symbolic import InvalidValue

    from ..output.printed import print_json, print_warnings, say_beside
    from ..output.progress import progress_bar
    from ..typed.pose_table import pose_table
    from ..typed.situation import drives_of, gravity_of
    from ..typed.values import one_of

    number: Real = one_of("number type", real, Real)
    if floating and arm.hold_base:
        raise InvalidValue("hold_base", "excludes floating; give one of them")
    warnings: list[str] = []

    def warn(*lines: str) -> None:
        warnings.extend(lines)
        print_warnings(lines)

    robot, ignored = _robot(arm, floating=floating)
    warn(*ignored, *_left_out(robot))
    known = drives_of(robot, drives)
    write = partial(
        generate_package,
        robot,
        out,
        real=number,
        name=name,
        drives=known,
        gravity=None if gravity is None else gravity_of(gravity),
        chain_order=order,
        floating=floating,
        payload=_payload(payload, payload_mass, payload_com),
        freeze=[] if freeze is None else [name.strip() for name in freeze.split(",")],
        poses=pose_table(poses, robot) if poses else None,
        points=_points(point or []),
        contacts=_contacts(contact or []),
        compiler=_compiler(warn),
    )
    if robot.n >= MANY_JOINTS:
        say_beside(early_word(robot.n))
    with progress_bar() as progress:
        task = progress.add_task("", total=None)

        def show(what: str, done: int, of: int) -> None:
            progress.update(task, description=what, completed=done, total=of)

        manifest = write(on_step=show)
    if drives.joint_stiffness is not None and not all(known.elastic):
        warn("rigid joints have no default stiffness: joint_stiffness must be set")
    if manifest.impact is None:
        warn(NO_IMPACTS)
    if name is not None and name != manifest.name:
        warn(f"'{name}' cannot begin C names; they begin with '{manifest.name}'")
    if json:
        print_json({"out": out, **vars(manifest), "warnings": warnings})
    else:
        _print_table(manifest, out)


NO_IMPACTS = (
    "the package has no peak_force, safe_speed or speed_factor: these need motors on independent "
    "joints that move the contact point in the same one, two or three directions whatever the pose"
)


def early_word(joints: int) -> str:
    """Return what a package of many joints will take, before it takes it."""
    square = joints**2  # 20 joints took 67 s and 0.4 GB on a slow core
    return (
        f"{joints} joints: a large package. Expect some {0.15 * square:.0f} s, "
        f"{0.1 + 0.0008 * square:.1f} GB of memory and up to {0.013 * square:.0f} MB of C, which "
        f"an optimising compiler takes {0.003 * square:.0f} min for"
    )


def _compiler(warn: Callable[[str], None]) -> tuple[str, ...] | None:
    """Return the C compiler that a package's own test is run with; warn if there is none."""
    from softimpact.codegen.verification.replay import works
    from softimpact.toolchain import c_compiler

    found = c_compiler()
    if found is not None and works(found):
        return found
    what = "there is no C compiler" if found is None else f"'{' '.join(found)}' makes no programs"
    warn(f"{what}, so the package's own test was not run")
    return None


def _robot(arm: TypedArm, *, floating: bool) -> tuple[Robot, tuple[str, ...]]:
    """Return the robot that a package is of, and what there is to say about it."""
    from ..typed.situation import loaded_arm, whole_robot

    if floating:
        robot = whole_robot(arm.model, arm.tip)
        return robot, robot.warnings
    loaded = loaded_arm(arm)
    return loaded.robot, loaded.warnings


def _points(given: list[str]) -> dict[str, str]:
    """Read NAME=FRAME; a name given twice is one too many."""
    from softimpact.symbolic import InvalidValue

    points: dict[str, str] = {}
    for text in given:
        name, equals, frame = text.partition("=")
        if not equals or not frame or name in points:
            raise InvalidValue("point", f"needs NAME=FRAME, each name once, not '{text}'")
        points[name] = frame
    return points


def _contacts(given: list[str]) -> dict[str, Contact]:
    """Read NAME=BODY[+COVER]; a name given twice is one too many."""
    from softimpact.symbolic import Contact, InvalidValue, body_region
    from softimpact.symbolic.body.bodies import BODIES
    from softimpact.symbolic.body.body_file import load_body, load_cover

    contacts: dict[str, Contact] = {}
    for text in given:
        name, equals, what = text.partition("=")
        body, plus, cover = what.partition("+")
        if not equals or not body or (plus and not cover) or name in contacts:
            raise InvalidValue("contact", f"needs NAME=BODY[+COVER], each name once, not '{text}'")
        is_file = body not in BODIES and Path(body).suffix
        region = load_body(body) if is_file else body_region(body)
        contacts[name] = Contact(region, cover=load_cover(cover) if cover else None)
    return contacts


def _left_out(robot: Robot) -> list[str]:
    """Return what of the robot impacts in C leave out although it counts."""
    from softimpact.symbolic import closed_chain

    following = closed_chain(robot).dependent
    damped = [robot.joints[i].name for i in following if robot.joints[i].damping > 0]
    if not damped:
        return []
    return [
        f"impacts in C leave out the damping of {', '.join(damped)}, which follow from other "
        "joints: with 1 to 50 N·m·s/rad in the joints peaks were 3 % lower to 5 % higher, so keep "
        "5 % of the limits free"
    ]


def _payload(wanted: bool, mass: float | None, com: str | None) -> Payload | None:
    from softimpact.codegen import Payload
    from softimpact.symbolic import InvalidValue

    from ..typed.values import vector

    if not wanted:
        for field, value in (("payload_mass", mass), ("payload_com", com)):
            if value is not None:
                raise InvalidValue(field, "is read with --payload only")
        return None
    x, y, z = vector("payload_com", com or "[0, 0, 0]", 3)
    return Payload(mass or 0.0, (x, y, z))


def _print_table(manifest: Manifest, out: Path) -> None:
    from ..output.dashes import explain
    from ..output.printed import print_table

    print_table(
        f"{manifest.model}, {len(manifest.files)} files in {out}",
        ("function", "flops", "sin, cos", "error, double", "error, float"),
        [
            *(
                (
                    function.name,
                    str(function.flops),
                    str(function.sines_and_cosines),
                    f"{function.double_error:.1e}",
                    f"{function.float_error:.1e}",
                )
                for function in manifest.functions
            ),
            *_impact_rows(manifest),
        ],
    )
    if manifest.impact is not None:
        explain(["– sin, cos: not counted of steps in time"])


def _impact_rows(manifest: Manifest) -> list[tuple[str, str, str | None, str, str]]:
    """Return the functions that step through impacts in time."""
    impact = manifest.impact
    if impact is None:
        return []
    flops, error = f"{impact.flops} + steps", f"{impact.accuracy:.1e}"
    names = ["safe_speed", "speed_factor", *(["select_configuration"] if manifest.poses else [])]
    return [
        (f"{manifest.name}_peak_force", flops, None, error, error),
        *((f"{manifest.name}_{name}", flops, None, "safe side", "safe side") for name in names),
    ]
