# SPDX-License-Identifier: BSD-3-Clause
"""Every problem of a study file at once, each with its line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from softimpact.robots import study_path
from softimpact.symbolic import InvalidValue

from .front.axes import asked_axes
from .impact.timing import require_time_steps
from .study.poses import candidates
from .study.study import build_study, robot_of_study
from .study.study_file import Fault, RobotSection, StudyFile, faults_of, read_toml
from .study.study_scenarios import scenarios_of

ROUNDS = 100
"""Most problems that are looked for one behind the other."""

STAND_INS: dict[tuple[str, str], Any] = {
    ("impact", "region"): "chest",
    ("impact", "clamped"): True,
    ("impact", "direction"): [0.0, 1.0, 0.0],
    ("impact", "speed"): 1.0,
    ("stiffness", "lower"): 1.0,
    ("stiffness", "upper"): 1e9,
    ("stiffness", "nominal"): 1e4,
    ("accuracy", "forces"): [[0.0, 1.0, 0.0]],
    ("accuracy", "max_deflection"): 1e-3,
}
"""What takes the place of a field that is wrong or missing, so that the others can be looked at."""

TABLE = re.compile(r"^\s*\[\[?\s*([^\]]+?)\s*\]\]?\s*(#.*)?$")


@dataclass(frozen=True)
class StudyFault:
    """What is wrong in a study file.

    Attributes:
        line: of the field, or of its table where it is missing; None where there is neither.
        field: its path, with dots.
        reason: what is wrong with it.
    """

    line: int | None
    field: str
    reason: str


def study_problems(path: str | Path) -> list[StudyFault]:
    """Return what is wrong in a study file; nothing where it can run.

    A field that is wrong is replaced, and the rest looked at again. What depends on a robot that
    cannot be read is not looked at.
    """
    source = study_path(path)
    try:
        content = read_toml(source)
    except InvalidValue as error:
        at = re.search(r"at line (\d+)", error.reason)
        line = int(at[1]) if at else None
        if "at end of document" in error.reason:
            line = len(source.read_text(encoding="utf-8-sig").splitlines()) or None
        return [StudyFault(line, "", error.reason)]
    text = source.read_text(encoding="utf-8-sig")
    found: list[StudyFault] = []
    poses = content.get("poses")
    order = list(range(len(poses))) if isinstance(poses, list) else []  # those left, in the file
    for _ in range(ROUNDS):
        faults = sorted(_faults(content, source), key=lambda fault: str(fault[0]), reverse=True)
        new = [StudyFault(*_shown(fault, order, text)) for fault in faults]
        if not new or set(new) <= set(found):
            break
        found += new
        mended = [_replaced(content, place, order) for place, _ in faults]
        if not all(mended):
            break
    if not any(problem.field.startswith("robot") for problem in found):
        found += [StudyFault(*_shown(fault, order, text)) for fault in _of_robot(content, source)]
    if not found:
        found = [StudyFault(*_shown(fault, order, text)) for fault in _of_search(content, source)]
    return sorted(dict.fromkeys(found), key=lambda problem: problem.line or 0)


def _faults(content: dict[str, Any], source: Path) -> list[Fault]:
    try:
        file = StudyFile.model_validate(deepcopy(content))
    except ValidationError as error:
        return faults_of(error)
    try:
        build_study(file, source)
    except InvalidValue as error:
        field = error.field.removeprefix(f"{source}: ")
        return [(_place(content, field), error.reason)]
    return []


def _of_search(content: dict[str, Any], source: Path) -> list[Fault]:
    """Look at what a study that can be built asks of the search.

    Its poses and time steps, its scenarios, and what its front trades.
    """
    try:
        study = build_study(StudyFile.model_validate(deepcopy(content)), source)
        require_time_steps(study, [pose.q for pose in candidates(study)])
        if study.scenarios is not None:
            scenarios_of(study)
        if study.levels.objectives is not None:
            asked_axes(study, study.levels.objectives).study(study)
    except InvalidValue as error:
        return [(_place(content, error.field.removeprefix(f"{source}: ")), error.reason)]
    return []


def _of_robot(content: dict[str, Any], source: Path) -> list[Fault]:
    """Look at the robot alone, where other sections stop the study before it."""
    try:
        section = RobotSection.model_validate(content.get("robot"))
        robot_of_study(section, source)
    except ValidationError:
        return []  # said before
    except InvalidValue as error:
        return [(tuple(error.field.removeprefix(f"{source}: ").split(".")), error.reason)]
    return []


def _place(content: dict[str, Any], field: str) -> tuple[str | int, ...]:
    """Turn a field as errors name it into a path: poses go by their names there."""
    pose = re.search(r"pose '([^']*)'", field)
    named = pose[1] if pose else None
    parts = field.split(".")
    if parts[0] == "poses" and len(parts) > 2:
        named = ".".join(parts[1:-1])
    if named is not None:
        names = [entry.get("name") for entry in content["poses"]]
        if named in names:
            return ("poses", names.index(named), "q")
    return tuple(parts)


def _replaced(content: dict[str, Any], place: Sequence[str | int], order: list[int]) -> bool:
    """Put something in the place of a field, or take it out; return whether that was possible."""
    names = tuple(str(part) for part in place if isinstance(part, str))
    if names[:1] == ("poses",):
        return _without_pose(content, place, order)
    if names[:1] == ("task",):
        poses = content.get("poses")
        first = poses[0] if isinstance(poses, list) and poses else None
        name = first.get("name") if isinstance(first, dict) else None
        content["task"] = {"pose_of": name}
        return isinstance(name, str)
    if not names or names[:2] in (("robot",), ("robot", "model"), ("robot", "tip")):
        return False
    section = content.get(names[0])
    stand_ins = {field: value for (at, field), value in STAND_INS.items() if at == names[0]}
    if isinstance(section, dict) and len(names) > 1:
        if names[1] in stand_ins:
            section[names[1]] = stand_ins[names[1]]
        else:
            section.pop(names[1], None)
    elif stand_ins:
        content[names[0]] = stand_ins
    else:
        content.pop(names[0], None)
    return True


def _without_pose(content: dict[str, Any], place: Sequence[str | int], order: list[int]) -> bool:
    """Take out a pose; the task goes to another one."""
    poses = content.get("poses")
    if not isinstance(poses, list) or len(place) < 2 or not isinstance(place[1], int):
        return False
    if len(poses) < 2 or place[1] >= len(poses):
        return False
    gone = poses.pop(place[1])
    order.pop(place[1])
    task = content.get("task")
    if (
        isinstance(task, dict)
        and isinstance(gone, dict)
        and task.get("pose_of") == gone.get("name")
    ):
        task["pose_of"] = poses[0].get("name", "")
    return True


def _shown(fault: Fault, order: list[int], text: str) -> tuple[int | None, str, str]:
    """Line, field and words of a fault, poses counted as the file has them."""
    place, reason = fault
    if place[:1] == ("poses",) and len(place) > 1 and isinstance(place[1], int):
        place = ("poses", order[place[1]], *place[2:])
    return _line_of(text, place), ".".join(str(part) for part in place), reason


def _line_of(text: str, place: Sequence[str | int]) -> int | None:
    """Line of a field in a TOML text, else that of its table."""
    names = [part for part in place if isinstance(part, str)]
    index = next((part for part in place if isinstance(part, int)), 0)
    if not names:
        return None
    table, seen, header = "", -1, None
    for number, line in enumerate(text.splitlines(), start=1):
        opened = TABLE.match(line)
        if opened:
            table = opened[1]
            seen += table == names[0]
            if table == names[0] and (seen == index or header is None):
                header = number
        elif table in ("", names[0]) and (table == "" or seen in (index, 0)):
            key = names[-1] if table else names[0]
            if re.match(rf"\s*\"?{re.escape(key)}\"?\s*=", line) and (not table or seen == index):
                return number
    return header
