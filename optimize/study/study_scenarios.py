# SPDX-License-Identifier: BSD-3-Clause
"""The scenarios that a study asks for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic import (
    Contact,
    InvalidValue,
    SoftImpactError,
    UnknownName,
    approach_velocity,
    body_region,
    unit_direction,
)
from softimpact.symbolic.impact.impact_model import ImpactModel
from softimpact.symbolic.robot.rigid import Array

from .poses import Candidate, candidates
from .scenarios import Scenarios
from .study import Study
from .study_file import ScenarioSection, ScenariosSection


def scenarios_of(study: Study) -> Scenarios:
    """Return the scenarios of a study; without a table of them, its own impact in every pose.

    Raises:
        InvalidValue: an unknown pose, point or region, or a direction in which a pose cannot move.
    """
    asked = study.scenarios
    section = "scenarios"
    try:
        found = _listed(study, asked) if isinstance(asked, tuple) else _product(study, asked)
        _require_motion(study, found)
    except InvalidValue as error:
        raise InvalidValue(f"{study.source}: {section}.{error.field}", error.reason) from None
    except SoftImpactError as error:
        raise InvalidValue(f"{study.source}: {section}", str(error)) from None
    return found


def contacts_of(study: Study) -> tuple[Contact, ...]:
    """Return what a study's robot may hit; raises UnknownName for a region."""
    asked, own = study.scenarios, study.contact.region.name
    if isinstance(asked, tuple):
        names = [one.region or own for one in asked]
    else:
        names = (asked.regions if asked else None) or [own]
    return tuple(_contact(study, name) for name in dict.fromkeys(names))


def _product(study: Study, asked: ScenariosSection | None) -> Scenarios:
    asked = asked or ScenariosSection()
    names = None if asked.poses == "all" else asked.poses
    return Scenarios(
        poses=_poses(study, names),
        points=tuple(_point(study, name) for name in asked.points or [study.model.tip]),
        directions=_directions(asked.directions or [study.direction.tolist()]),
        contacts=contacts_of(replace(study, scenarios=asked)),
        payloads=tuple(asked.payloads or [0.0]),
        speeds=tuple(asked.speeds or [study.speed]),
        motors=study.motors,
    )


def _listed(study: Study, asked: tuple[ScenarioSection, ...]) -> Scenarios:
    own = study.task_pose.name, study.model.tip, tuple(study.direction.tolist())
    filled = [
        (
            one.pose or own[0],
            one.point or own[1],
            tuple(one.direction or own[2]),
            one.region or study.contact.region.name,
            one.payload,
            one.speed or study.speed,
        )
        for one in asked
    ]
    poses, points, directions, regions, payloads, speeds = (
        list(dict.fromkeys(axis)) for axis in zip(*filled, strict=True)
    )
    axes: Sequence[list[object]] = [poses, points, directions, regions, payloads, speeds]
    rows: NDArray[np.int64] = np.array(
        [[axis.index(v) for axis, v in zip(axes, one, strict=True)] for one in filled]
    )
    return Scenarios(
        poses=_poses(study, poses),
        points=tuple(_point(study, name) for name in points),
        directions=_directions([list(direction) for direction in directions]),
        contacts=tuple(_contact(study, name) for name in regions),
        payloads=tuple(payloads),
        speeds=tuple(speeds),
        motors=study.motors,
        rows=rows,
    )


def _poses(study: Study, names: Sequence[str] | None) -> tuple[Candidate, ...]:
    known = {pose.pose.name: pose for pose in candidates(study)}
    for name in names or ():
        if name not in known:
            raise UnknownName("pose", name, list(known))
    return tuple(known[name] for name in (names or known))


def _point(study: Study, name: str) -> str:
    return study.robot.frame(name).name


def _directions(given: Sequence[Sequence[float]]) -> Array:
    return np.array([unit_direction(direction) for direction in given])


def _contact(study: Study, name: str) -> Contact:
    return Contact(body_region(name), study.contact.clamped)


def _require_motion(study: Study, scenarios: Scenarios) -> None:
    """Refuse a direction in which a point of a pose cannot move."""
    models = [ImpactModel(study.robot, point, study.model.drives) for point in scenarios.points]
    for one in scenarios.groups():
        pose, direction = scenarios.poses[one.pose], scenarios.directions[one.direction]
        try:
            approach_velocity(models[one.point], pose.q, direction)
        except SoftImpactError as error:
            where = f"pose '{pose.pose.name}', point '{scenarios.points[one.point]}'"
            raise InvalidValue("directions", f"{where}: {error}") from None
