# SPDX-License-Identifier: BSD-3-Clause
"""Study files as written: TOML, checked field by field."""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from softimpact.robots import built_in_robots, built_in_studies
from softimpact.symbolic import InvalidValue
from softimpact.symbolic.body.verdict import QUASI_STATIC_FROM
from softimpact.symbolic.errors import did_you_mean
from softimpact.symbolic.file_section import (
    FileSection,
    Finite,
    NotNegative,
    Positive,
    Vector3,
    why_unreadable,
    why_wrong,
)
from softimpact.symbolic.impact.motors import REACTION_TIME, STOPPING_TIME, MotorKind, Reaction


class RobotSection(FileSection):
    """Which robot, and its drives."""

    model: str
    tip: str | None = None
    hold_base: bool = False
    floating: bool = False
    lock: dict[str, Finite] = Field(default_factory=dict)
    rotor_inertia: str | Finite | list[Finite] | None = None
    position_gain: Finite | list[Finite] | None = None
    computed_torque_gain: Finite | None = None


class ImpactSection(FileSection):
    """What is hit, how fast and from where."""

    region: str
    clamped: bool = True
    direction: Vector3
    speed: Positive


class MotorsSection(FileSection):
    """What the motors do during an impact; without a kind the worse end of {free, driven}."""

    kind: MotorKind | None = None
    position_gain: Finite | list[Finite] | None = None
    damping_gain: Finite | list[Finite] | None = None
    reaction_time: Annotated[float, Field(ge=0)] = REACTION_TIME
    reaction: Reaction = "release"
    stopping_time: Positive = STOPPING_TIME
    horizon: Positive = QUASI_STATIC_FROM


class HardwareSection(FileSection):
    """Which variables of the hardware are sought: joint stiffness, each, equal or in groups.

    Other fields are tables of the variables in ``optimize/variables``.
    """

    model_config = ConfigDict(extra="allow", frozen=True, strict=True)

    joint_stiffness: Literal["each", "equal"] | list[list[str]] = "each"
    catalogue: Annotated[list[Positive], Field(min_length=1)] | None = None


class ScenariosSection(FileSection):
    """The product of what may happen; what is left out is the study's own."""

    poses: Literal["all"] | Annotated[list[str], Field(min_length=1)] = "all"
    posture: Literal["given", "free"] = "given"
    directions: Annotated[list[Vector3], Field(min_length=1)] | None = None
    points: Annotated[list[str], Field(min_length=1)] | None = None
    regions: Annotated[list[str], Field(min_length=1)] | None = None
    payloads: Annotated[list[NotNegative], Field(min_length=1)] | None = None
    speeds: Annotated[list[Positive], Field(min_length=1)] | None = None
    motors: Annotated[list[MotorKind], Field(min_length=1)] | None = None


class ScenarioSection(FileSection):
    """One of a list of scenarios; what is left out is the study's own."""

    pose: str | None = None
    direction: Vector3 | None = None
    point: str | None = None
    region: str | None = None
    payload: NotNegative = 0.0
    speed: Positive | None = None


class StiffnessSection(FileSection):
    """Bounds on the joint stiffness and the design to improve on [N·m/rad]."""

    rigid: list[str] = Field(default_factory=list)
    lower: Positive | list[Positive]
    upper: Positive | list[Positive]
    nominal: Positive | list[Positive]


class AccuracySection(FileSection):
    """Loads on the tip [N, N·m, kg] and how far [m] the springs may give way under each."""

    forces: Annotated[list[Vector3], Field(min_length=1)]
    max_deflection: Positive
    moments: Annotated[list[Vector3], Field(min_length=1)] | None = None
    payload: NotNegative = 0.0
    sag: bool = False
    margin: Annotated[float, Field(ge=0, lt=1)] = 0.0


class ParetoSection(FileSection):
    """What a Pareto front trades, at how many levels of each, and between which ends.

    ``lower`` and ``upper`` are those of the deflection [m].
    """

    points: Annotated[int, Field(ge=2, le=100)] = 11
    lower: Positive | None = None
    upper: Positive | None = None
    objectives: list[str] | None = None
    ends: dict[str, Annotated[list[Positive], Field(min_length=2, max_length=2)]] = Field(
        default_factory=dict
    )

    @model_validator(mode="after")
    def _lower_is_below(self) -> ParetoSection:
        if self.lower is not None and self.upper is not None and self.lower >= self.upper:
            raise ValueError(f"lower {self.lower:g} must be below upper {self.upper:g}")
        return self


class TaskSection(FileSection):
    """Where the tip is held: where one of the poses has it."""

    pose_of: str
    exact: bool = True


class PoseSection(FileSection):
    """A candidate configuration."""

    name: str
    q: list[Finite]
    recovered: bool = False


class StudyFile(FileSection):
    """A study file, as written."""

    title: str = ""
    robot: RobotSection
    impact: ImpactSection
    motors: MotorsSection = MotorsSection()
    hardware: HardwareSection = HardwareSection()
    scenarios: ScenariosSection | Annotated[list[ScenarioSection], Field(min_length=1)] | None = (
        None
    )
    stiffness: StiffnessSection
    accuracy: AccuracySection
    bounds: dict[str, Any] = Field(default_factory=dict)
    objective: dict[str, Any] = Field(default_factory=dict)
    pareto: ParetoSection = ParetoSection()
    task: TaskSection
    poses: Annotated[list[PoseSection], Field(min_length=1)]

    @model_validator(mode="after")
    def _poses_are_named_once(self) -> StudyFile:
        names = [pose.name for pose in self.poses]
        repeated = {name for name, count in Counter(names).items() if count > 1}
        if repeated:
            raise ValueError(f"poses: named more than once: {', '.join(sorted(repeated))}")
        if self.task.pose_of not in names:
            raise ValueError(f"task.pose_of: no pose is named '{self.task.pose_of}'")
        return self


def read_study_file(source: Path, overrides: dict[str, dict[str, Any]]) -> StudyFile:
    """Read a study file and check the form of every field.

    Args:
        source: a TOML file.
        overrides: values that replace the file's, by section and field.

    Raises:
        InvalidValue: names file and field.
    """
    content = read_toml(source)
    for section, fields in overrides.items():
        given = content.get(section, {})
        content[section] = {**given, **fields} if isinstance(given, dict) else given
    try:
        return StudyFile.model_validate(content)
    except ValidationError as error:
        raise _first_problem(source, error) from None


def read_toml(source: Path) -> dict[str, Any]:
    """Read a TOML file; raises InvalidValue."""
    try:
        return tomllib.loads(source.read_text(encoding="utf-8-sig"))
    except FileNotFoundError:
        name, known = str(source), built_in_studies()
        reason = f"no such study file; built in: {', '.join(known)}{did_you_mean(name, known)}"
        if name in built_in_robots():
            reason = f"is a robot, not a study; softimpact init {name} > study.toml begins one"
        raise InvalidValue(str(source), reason) from None
    except (OSError, ValueError) as error:
        raise InvalidValue(str(source), why_unreadable(error)) from None


def _first_problem(source: Path, error: ValidationError) -> InvalidValue:
    """Return the fault that tells most: a name that is not known, before one that is missing."""
    faults = faults_of(error)
    place, reason = faults[0]
    field = ".".join(str(part) for part in place)
    where = f"{source}: {field}" if field else str(source)
    more = f" (and {len(faults) - 1} more; softimpact check lists all)" if faults[1:] else ""
    return InvalidValue(where, f"{reason}{more}")


Fault = tuple[tuple[str | int, ...], str]
"""Where in a study something is wrong, and what."""


OTHER_FORM = re.compile(r"_type$|literal_error")
"""Kinds of faults of a field that has not the form that was tried, which may be one of several."""


def faults_of(error: ValidationError) -> list[Fault]:
    """Return what is wrong, names that are not known first.

    Of a field that may have several forms only what is wrong with the nearest is told.
    """
    found = sorted(error.errors(), key=lambda fault: fault["type"] != "extra_forbidden")
    placed = [(_place_of(fault["loc"]), fault) for fault in found]
    told: dict[tuple[str | int, ...], str] = {}
    for place, fault in placed:
        reason = fault_in_words(dict(fault))
        nearer = any(
            other[: len(place)] == place
            and (len(other) > len(place) or not OTHER_FORM.search(each["type"]))
            for other, each in placed
        )
        if not (OTHER_FORM.search(fault["type"]) and nearer):
            told.setdefault(*reason)
    return list(told.items())


def _place_of(parts: Sequence[str | int]) -> tuple[str | int, ...]:
    """Return a place without the forms that pydantic names on the way."""
    return tuple(part for part in parts if not re.search(r"Section|\[", str(part)))


def fault_in_words(fault: Mapping[str, Any]) -> Fault:
    """Words for a field of the wrong form, with the name that may have been meant."""
    place = _place_of(fault["loc"])
    reason = why_wrong(fault)
    if not place:  # a check of the whole, which names its field itself
        field, _, words = reason.partition(": ")
        return tuple(field.split(".")), words
    if fault["type"] == "extra_forbidden":
        reason = f"unknown{did_you_mean(str(place[-1]), _fields_of(place[:-1]))}"
    elif fault["type"] == "too_short" and not fault["ctx"]["actual_length"]:
        reason = "is empty; name one at least, or leave the field out"
    return place, reason


def _fields_of(place: Sequence[str | int]) -> list[str]:
    """Names of the fields that a section may have."""
    kind: Any = StudyFile
    for part in place:
        if isinstance(part, int):
            continue
        field = kind.model_fields.get(part)
        parts = (field.annotation, *getattr(field.annotation, "__args__", ())) if field else ()
        kind = next((p for p in parts if isinstance(p, type) and issubclass(p, BaseModel)), None)
        if kind is None:
            return []
    return list(kind.model_fields)
