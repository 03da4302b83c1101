# SPDX-License-Identifier: BSD-3-Clause
"""What a page is opened with: a robot, a study, or the results of a command."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from softimpact.optimize import Study, load_study
from softimpact.optimize.machine.coordinates import is_plain
from softimpact.robots import built_in_robots, built_in_studies, study_path
from softimpact.simulate.trajectory import Trajectory
from softimpact.symbolic import (
    Contact,
    Drives,
    InvalidValue,
    Robot,
    UnknownName,
    body_region,
    drives,
    load_robot,
)
from softimpact.symbolic.impact.floating import BASE_COORDINATES, base_held, is_floating
from softimpact.symbolic.impact.motors import REACTION_TIME
from softimpact.symbolic.robot.rigid import Array

from ..design import report as design_report
from ..front import pareto_record, trade_off_record
from ..output.results_folder import RESULTS
from ..program import record as program_record
from ..program.motion_file import read_motion
from ..program.waypoints import read_waypoints
from ..report import map_files
from ..robot.first_study import NOMINAL, first_posture
from ..typed.groups import TypedArm
from ..typed.situation import loaded_arm

SPEED = 0.5
"""To begin with [m/s]."""

REGION = "chest"
"""To begin with."""


@dataclass(frozen=True)
class DesignPoint:
    """Springs and a posture that a search found.

    Attributes:
        front: name of the Pareto front, or of the command.
        name: of the point.
        deflection: of the tip by the springs under the study's forces [m]; None where not known.
        force: largest [N].
        springs: joint stiffness, length n [N·m/rad].
        q: posture, length n.
    """

    front: str
    name: str
    deflection: float | None
    force: float | None
    springs: Sequence[float]
    q: Sequence[float]


@dataclass(frozen=True, eq=False)
class MapShown:
    """A map over a plane; lists have an entry a posture.

    Attributes:
        axes: of the plane, ``xz`` for example.
        place: of the tip along these two [m].
        step: between places [m].
        safe_speed: [m/s]; None where the tip cannot go so.
        q: posture.
        direction: of the impact there.
    """

    axes: str
    place: Sequence[Sequence[float]]
    step: float
    safe_speed: Sequence[float | None]
    q: Sequence[Sequence[float]]
    direction: Sequence[Sequence[float]]


@dataclass(frozen=True, eq=False)
class Opened:
    """What a page shows first, and what it can go to.

    Attributes:
        title: of the page.
        robot: its tip is the end of the arm.
        drives: with numbers; joint stiffness everywhere.
        q: posture, length n.
        direction: unit vector.
        speed: [m/s].
        body: that is hit.
        kind: of the motors; None for both ends of the bracket.
        reaction_time: [s].
        horizon: [s].
        postures: by name.
        designs: from results.
        motion: of a program.
        map: over a plane.
        limit: that the designs were held against [N]; None without designs.
        warnings: what of a file was ignored, a line each.
        assumed: what the page says until somebody changes it, a line each.
    """

    title: str
    robot: Robot
    drives: Drives
    q: Array
    direction: Array
    speed: float = SPEED
    body: Contact = field(default_factory=lambda: Contact(body_region(REGION)))
    kind: str | None = None
    reaction_time: float = REACTION_TIME
    horizon: float = 0.5
    postures: Mapping[str, Array] = field(default_factory=dict)
    designs: Sequence[DesignPoint] = ()
    motion: Trajectory | None = None
    map: MapShown | None = None
    limit: float | None = None
    warnings: tuple[str, ...] = ()
    assumed: tuple[str, ...] = ()


def opened(what: str, arm: TypedArm | None = None) -> Opened:
    """Return what a robot's name, a model file, a study or a folder of results opens.

    Args:
        what: to open.
        arm: of a model, what of it is meant; None: what its file says.

    Raises:
        InvalidValue: a folder without results, or with some that have no page.
        UnknownName: none of these.
        SoftImpactError: a model or a study that cannot be read.
    """
    path = Path(what)
    is_folder = what not in built_in_robots() and path.is_dir()
    if not is_folder and study_path(what).suffix != ".toml":
        try:
            return of_model(arm or TypedArm(what))
        except UnknownName as error:
            if error.name != what:
                raise
            known = [*built_in_robots(), *built_in_studies()]
            raise UnknownName("robot, study or folder of results", what, known) from None
    if arm is not None:
        raise InvalidValue("tip", "and the like are a model's; studies and results have theirs")
    return _of_results(path) if is_folder else of_study(load_study(path))


def of_model(typed: TypedArm) -> Opened:
    """Return a robot in a posture in which it moves well."""
    arm = loaded_arm(typed)
    robot = arm.robot
    q, direction = first_posture(robot)
    return Opened(
        title=robot.name,
        robot=robot,
        drives=drives(robot, joint_stiffness=NOMINAL),
        q=q,
        direction=np.array(direction),
        postures={"first": q},
        warnings=arm.warnings,
        assumed=(
            f"The joints' stiffness is a guess, {NOMINAL:g} N·m/rad: a robot's file does not say "
            "it.",
        ),
    )


def of_study(study: Study) -> Opened:
    """Return a study in the posture of its task; the base of a floating robot is held."""
    kinds = {motors.kind for motors in study.motors}
    model, base = study.model, _base(study)
    if base:
        model = base_held(model)
    if not is_plain(model) and not model.robot.loops:  # loops are told of by what shows them
        raise InvalidValue(
            "model", "has joints without a motor and a spring behind it; the page shows none such"
        )
    return Opened(
        title=study.title,
        robot=replace(model.robot, tip=model.tip),
        drives=model.drives,
        q=study.task_pose.q[base:],
        direction=study.direction,
        speed=study.speed,
        body=study.contact,
        kind=kinds.pop() if len(kinds) == 1 else None,
        reaction_time=study.motors[0].reaction_time,
        horizon=study.horizon,
        postures={pose.name: pose.q[base:] for pose in study.poses},
        assumed=("The base is held here: heavier than in the air, and so safer to look at.",)
        if base
        else (),
    )


def _base(study: Study) -> int:
    """Return how many coordinates of a posture are those of a floating base."""
    return BASE_COORDINATES if is_floating(study.robot) else 0


def _of_results(folder: Path) -> Opened:
    try:
        record = json.loads((folder / RESULTS).read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InvalidValue("results", f"{folder} holds no {RESULTS} of a command") from None
    except ValueError:
        raise InvalidValue("results", f"{folder / RESULTS} is no JSON") from None
    generator = str(record.get("generator")) if isinstance(record, dict) else ""
    if generator == program_record.GENERATOR:
        return _of_program(record)
    if generator == map_files.GENERATOR:
        return _of_map(record)
    points = {pareto_record.GENERATOR: _fronts, design_report.GENERATOR: _winners}.get(generator)
    if points is None:
        raise InvalidValue(
            "results", f"{folder} holds no results of design, pareto, program or map"
        )
    source = Path(record["study"]["source"])
    if not source.is_file():
        raise InvalidValue(
            "results",
            f"{folder} came from the study {source}, which is not there; run the command where "
            "it is",
        )
    study = load_study(source)
    shown, base = of_study(study), _base(study)
    designs = tuple(replace(point, q=point.q[base:]) for point in points(record))
    first = designs[0]
    at_first = replace(shown.drives, springs=type(shown.drives.springs)(list(first.springs)))
    return replace(
        shown, designs=designs, drives=at_first, q=np.array(first.q), limit=record.get("limit")
    )


def _fronts(record: Mapping[str, Any]) -> list[DesignPoint]:
    if record.get("form") == trade_off_record.FORM:
        return [
            DesignPoint(f"design {i + 1}", pose, _deflection(p), None, p["springs"], q)
            for i, p in enumerate(record["points"])
            for pose, q in p["postures"].items()
        ]
    return [
        DesignPoint(front, p["start"], p["deflection"], p["force"], p["springs"], p["q"])
        for front, points in record["fronts"].items()
        for p in points
    ]


def _deflection(point: Mapping[str, Any]) -> float:
    names = (bound for bound in point["bounds"] if bound["name"] == "accuracy.max_deflection")
    return float(next(names)["figure"])


def _winners(record: Mapping[str, Any]) -> list[DesignPoint]:
    winner = record["winner"]
    postures = winner.get("postures") or {winner["name"]: winner["q"]}
    force = record["worst_force"] if "q" in winner else None
    return [
        DesignPoint("design", name, winner["deflection"], force, winner["springs"], q)
        for name, q in postures.items()
    ]


def _of_program(record: Mapping[str, Any]) -> Opened:
    """Return a robot at the worst moment of its program."""
    name, path = record["robot"], Path(record["motion"])
    if name not in built_in_robots() or not path.is_file():
        raise InvalidValue(
            "results",
            f"the program's robot '{name}' or motion {path} is not there; open the robot by its "
            "file, and the motion in the page",
        )
    robot = load_robot(name)
    motion = read_waypoints(path, robot) if path.suffix == ".json" else read_motion(path, robot)[0]
    springs = [NOMINAL if k is None else k for k in record["joint_stiffness"]]
    worst = record["worst"][0] if record["worst"] else {"q": motion.q[0], "direction": (0, 0, -1)}
    kinds = list(record["motors"])
    return Opened(
        title=f"{name}: {path.name}",
        robot=robot,
        drives=drives(robot, joint_stiffness=springs, rotor_inertia=record["rotor_inertia"]),
        q=np.array(worst["q"]),
        direction=np.array(worst.get("direction", (0.0, 0.0, -1.0))),
        speed=worst.get("speed", SPEED),
        body=Contact(body_region(worst.get("region", REGION)), record["clamped"]),
        kind=kinds[0] if len(kinds) == 1 else None,
        horizon=record["horizon"],
        motion=motion,
    )


def _of_map(record: Mapping[str, Any]) -> Opened:
    """Return a robot where its map begins."""
    arm = loaded_arm(TypedArm(**record["arm"]))
    springs = [NOMINAL if k is None else k for k in record["joint_stiffness"]]
    kinds, begun = list(record["motors"]), record["begun"]
    reaction = record["motors"][kinds[0]]["reaction_time"]
    shown = None
    if record["plane"]:
        flat = ["xyz".index(axis) for axis in record["plane"]]
        grid = next(values for values in record["grid"].values() if len(values) > 1)
        shown = MapShown(
            axes=record["plane"],
            place=[[place[k] for k in flat] for place in record["place"]],
            step=grid[1] - grid[0],
            safe_speed=record["safe_speed"],
            q=record["q"],
            direction=record["direction"],
        )
    rigid = None in record["joint_stiffness"]
    return Opened(
        title=f"{record['robot']}: map",
        robot=arm.robot,
        drives=drives(arm.robot, joint_stiffness=springs, rotor_inertia=record["rotor_inertia"]),
        q=np.array(record["q"][begun]),
        direction=np.array(record["direction"][begun]),
        speed=record["speed"],
        body=Contact(body_region(record["region"]), record["clamped"]),
        kind=kinds[0] if len(kinds) == 1 else None,
        reaction_time=np.inf if reaction is None else reaction,
        horizon=record["horizon"],
        map=shown,
        warnings=arm.warnings,
        assumed=(f"Rigid joints have springs here, {NOMINAL:g} N·m/rad.",) if rigid else (),
    )
