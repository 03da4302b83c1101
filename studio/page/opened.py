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
from softimpact.robots import built_in_robots
from softimpact.simulate.trajectory import Trajectory
from softimpact.symbolic import Drives, InvalidValue, Robot, arm_of, drives, load_robot
from softimpact.symbolic.impact.motors import REACTION_TIME
from softimpact.symbolic.robot.rigid import Array

from .. import design_report, pareto_record, program_record
from ..first_study import NOMINAL, first_posture
from ..motion_file import read_motion
from ..results_folder import RESULTS
from ..waypoints import read_waypoints

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
class Opened:
    """What a page shows first, and what it can go to.

    Attributes:
        title: of the page.
        robot: its tip is the end of the arm.
        drives: with numbers; joint stiffness everywhere.
        q: posture, length n.
        direction: unit vector.
        speed: [m/s].
        region: name.
        clamped: whether it is held.
        kind: of the motors; None for both ends of the bracket.
        reaction_time: [s].
        horizon: [s].
        postures: by name.
        designs: from results.
        motion: of a program.
        limit: that the designs were held against [N]; None without designs.
    """

    title: str
    robot: Robot
    drives: Drives
    q: Array
    direction: Array
    speed: float = SPEED
    region: str = REGION
    clamped: bool = True
    kind: str | None = None
    reaction_time: float = REACTION_TIME
    horizon: float = 0.5
    postures: Mapping[str, Array] = field(default_factory=dict)
    designs: Sequence[DesignPoint] = ()
    motion: Trajectory | None = None
    limit: float | None = None


def opened(what: str) -> Opened:
    """Return what a robot's name, a model file, a study or a folder of results opens.

    Raises:
        InvalidValue: a folder without results, or with some that have no page.
        SoftImpactError: a model or a study that cannot be read.
    """
    path = Path(what)
    if what not in built_in_robots() and path.is_dir():
        return _of_results(path)
    return of_study(load_study(path)) if path.suffix == ".toml" else of_model(what)


def of_model(model: str) -> Opened:
    """Return a robot in a posture in which it moves well."""
    whole = load_robot(model)
    if whole.tip is None:
        known = ", ".join(list(whole.frames)[:8])
        raise InvalidValue(
            "model",
            f"'{whole.name}' names no end of its arm; write a study with robot.tip, one of {known}",
        )
    robot = arm_of(whole).robot
    q, direction = first_posture(robot)
    stiff = drives(robot, joint_stiffness=NOMINAL)
    return Opened(robot.name, robot, stiff, q, np.array(direction), postures={"first": q})


def of_study(study: Study) -> Opened:
    """Return a study in the posture of its task."""
    kinds = {motors.kind for motors in study.motors}
    return Opened(
        title=study.title,
        robot=replace(study.robot, tip=study.model.tip),
        drives=study.model.drives,
        q=study.task_pose.q,
        direction=study.direction,
        speed=study.speed,
        region=study.contact.region.name,
        clamped=study.contact.clamped,
        kind=kinds.pop() if len(kinds) == 1 else None,
        reaction_time=study.motors[0].reaction_time,
        horizon=study.horizon,
        postures={pose.name: pose.q for pose in study.poses},
    )


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
    points = {pareto_record.GENERATOR: _fronts, design_report.GENERATOR: _winners}.get(generator)
    if points is None:
        raise InvalidValue("results", f"{folder} holds no results of design, pareto or program")
    source = Path(record["study"]["source"])
    if not source.is_file():
        raise InvalidValue(
            "results",
            f"{folder} came from the study {source}, which is not there; run the command where "
            "it is",
        )
    shown, designs = of_study(load_study(source)), tuple(points(record))
    first = designs[0]
    at_first = replace(shown.drives, springs=type(shown.drives.springs)(list(first.springs)))
    return replace(
        shown, designs=designs, drives=at_first, q=np.array(first.q), limit=record.get("limit")
    )


def _fronts(record: Mapping[str, Any]) -> list[DesignPoint]:
    return [
        DesignPoint(front, p["start"], p["deflection"], p["force"], p["springs"], p["q"])
        for front, points in record["fronts"].items()
        for p in points
    ]


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
        region=worst.get("region", REGION),
        clamped=record["clamped"],
        kind=kinds[0] if len(kinds) == 1 else None,
        horizon=record["horizon"],
        motion=motion,
    )
