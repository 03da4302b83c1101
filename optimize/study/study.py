# SPDX-License-Identifier: BSD-3-Clause
"""Studies: a robot, an impact, bounds and candidate configurations, checked."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from softimpact.robots import study_path
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    InvalidValue,
    Motors,
    Robot,
    SoftImpactError,
    approach_velocity,
    body_region,
    floating_robot,
    limits_of,
    unit_direction,
)
from softimpact.symbolic.impact.approach import singular_postures
from softimpact.symbolic.robot.rigid import Array

from ..bounds import Bound, Deflection
from ..machine.machine import TaskMotion
from ..machine.springs import spring_names, with_springs
from ..objectives import Objective, WorstForce
from ..variables import JointStiffness, Range, Variable, joint_groups, require_common_stiffness
from .study_file import (
    ParetoSection,
    PoseSection,
    RobotSection,
    ScenarioSection,
    ScenariosSection,
    StudyFile,
    read_study_file,
)
from .study_motors import asked_kinds, study_motors
from .study_numbers import catalogue_of, moments_of, stiffness_of
from .study_parts import asked_bounds, asked_objective, asked_variables, require_fit
from .study_robot import (
    chain_of,
    loaded,
    model_of,
    posture_of,
    require_held_joints,
    require_known_rotors,
    require_within_limits,
    sprung_joints,
)


@dataclass(frozen=True, eq=False)
class Pose:
    """A candidate configuration.

    Attributes:
        name: of the pose.
        q: link angles, length n, loops closed and a floating base at zero [rad].
        recovered: whether the source does not print it.
    """

    name: str
    q: Array
    recovered: bool = False


@dataclass(frozen=True, eq=False)
class Study:
    """A design problem, checked: a robot, an impact, bounds and candidate configurations.

    Attributes:
        title: for figures and reports.
        source: the study file.
        model: the robot with the nominal stiffness of its springs.
        contact: what it hits.
        motors: what they do during the impact; of several the worst counts.
        horizon: up to which every contact counts [s].
        direction: unit vector of the tip's velocity, base axes.
        speed: of the tip [m/s].
        lower, upper: bounds on the stiffness of each spring [N·m/rad].
        nominal: the stiffness to improve on, of each spring [N·m/rad].
        groups: of each spring; those of the same group have the same stiffness.
        forces: on the tip, k×3 [N].
        max_deflection: of the springs under each force [m].
        levels: at which a Pareto front is sought, as the file has it.
        moments: on the tip beside each force, k×3 [N·m].
        payload: point mass at the tip whose weight bends the springs, too [kg].
        sag: whether the links' weight does.
        margin: share by which a spring may miss its stiffness and all bounds are still kept.
        other_bounds: beside the deflection.
        other_variables: of the hardware beside the springs.
        objective: what is made small.
        catalogue: stiffnesses that can be bought [N·m/rad]; empty for any.
        task_pose: the pose that fixes where the tip is held.
        exact: whether poses are moved to where they hold the tip exactly there.
        poses: all candidates.
        scenarios: what the hardware must bear, as the file has it; None for the study's own
            impact.
    """

    title: str
    source: Path
    model: ImpactModel
    contact: Contact
    motors: tuple[Motors, ...]
    horizon: float
    direction: Array
    speed: float
    lower: Array
    upper: Array
    nominal: Array
    groups: tuple[int, ...]
    forces: Array
    max_deflection: float
    levels: ParetoSection
    task_pose: Pose
    exact: bool
    poses: tuple[Pose, ...]
    scenarios: ScenariosSection | tuple[ScenarioSection, ...] | None = None
    moments: Array | None = None
    payload: float = 0.0
    sag: bool = False
    margin: float = 0.0
    other_bounds: tuple[Bound, ...] = ()
    other_variables: tuple[Variable, ...] = ()
    objective: Objective = field(default_factory=WorstForce)
    catalogue: tuple[float, ...] = ()

    @property
    def robot(self) -> Robot:
        """The robot, a chain to its tip."""
        return self.model.robot

    @property
    def spring_names(self) -> tuple[str, ...]:
        """Names of the joints whose spring is sought: all of an arm, unless some are rigid."""
        return spring_names(self.model)

    def with_springs(self, springs: Array) -> ImpactModel:
        """Return the robot with springs of some stiffness, one for each [N·m/rad]."""
        return with_springs(self.model, springs)

    @property
    def deflection(self) -> Deflection:
        """The bound on accuracy."""
        moments = () if self.moments is None else _rows(self.moments)
        return Deflection(self.max_deflection, _rows(self.forces), moments, self.payload, self.sag)

    @property
    def bounds(self) -> tuple[Bound, ...]:
        """All bounds, that on the deflection first."""
        return (self.deflection, *self.other_bounds)

    @property
    def variables(self) -> tuple[Variable, ...]:
        """All variables of the hardware, the springs first."""
        ends = (tuple(each.tolist()) for each in (self.lower, self.upper, self.nominal))
        return (JointStiffness(self.groups, *ends), *self.other_variables)

    @property
    def range(self) -> Range:
        """Names, limits and start of all variables' values, in their order."""
        ranges = [(variable.kind, variable.range(self.model)) for variable in self.variables]
        names = [
            name if kind in (JointStiffness.kind, name) else f"{kind} of {name}"
            for kind, each in ranges
            for name in each.names
        ]
        lower, upper, start = (
            np.concatenate([getattr(each, end) for _, each in ranges])
            for end in ("lower", "upper", "start")
        )
        return Range(tuple(names), lower, upper, start)

    @property
    def units(self) -> tuple[str, ...]:
        """Unit of each of ``range``'s values."""
        each = [(variable.unit, variable.range(self.model)) for variable in self.variables]
        return tuple(unit for unit, found in each for _ in found.names)

    @property
    def limit(self) -> float:
        """Largest force that what is hit may bear: its limits of force and energy [N]."""
        return transient_limit(self.contact)

    @property
    def motions(self) -> tuple[TaskMotion, ...]:
        """The motions that the study's impacts ask of the robot, each at its greatest speed."""
        fastest: dict[tuple[str, tuple[float, ...]], float] = {}
        for point, direction, speed in self._impacts():
            key = point, tuple(unit_direction(direction).tolist())
            fastest[key] = max(speed, fastest.get(key, 0.0))
        return tuple(
            TaskMotion(self.robot.frame(point).name, (speed * x, speed * y, speed * z))
            for (point, (x, y, z)), speed in fastest.items()
        )

    def _impacts(self) -> Iterator[tuple[str, list[float], float]]:
        """Yield point, direction and speed of all that the file asks for."""
        asked, own = self.scenarios, self.direction.tolist()
        if isinstance(asked, tuple):
            for one in asked:
                yield one.point or self.model.tip, one.direction or own, one.speed or self.speed
        elif asked is not None:
            speed = max(asked.speeds or [self.speed])
            for point in asked.points or [self.model.tip]:
                for direction in asked.directions or [own]:
                    yield point, direction, speed
        else:
            yield self.model.tip, own, self.speed


def _rows(matrix: Array) -> tuple[tuple[float, float, float], ...]:
    return tuple((float(x), float(y), float(z)) for x, y, z in matrix)


def transient_limit(contact: Contact) -> float:
    """Return the force that reaches a body's transient limits, of force and energy [N]."""
    return limits_of(contact.region, contact.clamped).transient.force


def limit_name(study: Study, i: int, end: str) -> tuple[str, str]:
    """Return the field of a study file that limits a value of the hardware, and whose value it is.

    Args:
        study: whose hardware it is.
        i: number of the value in ``study.range``.
        end: "lower" or "upper".
    """
    name = study.range.names[i]
    if i <= max(study.groups):
        return f"stiffness.{end}", name
    kind, _, whose = name.partition(" of ")
    return f"hardware.{kind}.{end}", whose or kind


def load_study(path: str | Path, overrides: dict[str, dict[str, Any]] | None = None) -> Study:
    """Read and check a study file.

    Args:
        path: a TOML file, or the name of a built-in study.
        overrides: values that replace the file's, by section and field, as a command line gives.

    Raises:
        InvalidValue: a field is missing, unknown, of the wrong type or out of range; names file
            and field.
    """
    source = study_path(path)
    return build_study(read_study_file(source, overrides or {}), source)


@contextmanager
def _naming(source: Path, section: str, field: str) -> Iterator[None]:
    """Let errors name the file and the section; and the field, unless they name it themselves."""
    try:
        yield
    except InvalidValue as error:
        raise InvalidValue(f"{source}: {section}.{error.field}", error.reason) from None
    except SoftImpactError as error:
        raise InvalidValue(f"{source}: {section}.{field}", str(error)) from None


def build_study(file: StudyFile, source: Path) -> Study:
    """Return the study that a file describes; raises InvalidValue, which names file and field."""
    robot = robot_of_study(file.robot, source)
    with _naming(source, "motors", "kind"):
        kinds = asked_kinds(file)
    with _naming(source, "stiffness", "rigid"):
        places = sprung_joints(robot, file.stiffness.rigid)
    with _naming(source, "stiffness", "lower"):
        names = [robot.joint_names[i] for i in places]
        lower, upper, nominal = stiffness_of(names, file.stiffness)
    with _naming(source, "robot", "rotor_inertia"):
        model = model_of(robot, file, places, nominal)
        if kinds != ("driven",):
            require_known_rotors(model)
    with _naming(source, "motors", "kind"):
        motors = study_motors(file.motors, model, kinds)
    with _naming(source, "hardware", "joint_stiffness"):
        groups = joint_groups(model, file.hardware.joint_stiffness)
        require_common_stiffness(model, groups, lower, upper)
    with _naming(source, "impact", "direction"):
        direction = unit_direction(file.impact.direction)
    with _naming(source, "impact", "region"):
        region = body_region(file.impact.region)
    with _naming(source, "poses", "q"):
        poses = tuple(_pose(model, pose) for pose in file.poses)
    with _naming(source, "accuracy", "moments"):
        moments = moments_of(file.accuracy, model)
    with _naming(source, "hardware", "variables"):
        variables = asked_variables(file.hardware, model)
    with _naming(source, "hardware", "catalogue"):
        catalogue = catalogue_of(file.hardware.catalogue, names, groups, lower, upper)
    with _naming(source, "bounds", "bounds"):
        bounds = asked_bounds(file.bounds, model)
    with _naming(source, "objective", "kind"):
        objective = asked_objective(file.objective)
        require_fit(objective, bounds)
    stuck = singular_postures(model, np.array([pose.q for pose in poses]), direction)
    for i in stuck[:1]:
        with _naming(source, "impact", f"direction at pose '{poses[i].name}'"):
            approach_velocity(model, poses[i].q, direction)
    return Study(
        title=file.title or source.stem,
        source=source,
        model=model,
        contact=Contact(region, file.impact.clamped),
        motors=motors,
        horizon=file.motors.horizon,
        direction=direction,
        speed=file.impact.speed,
        lower=lower,
        upper=upper,
        nominal=nominal,
        groups=groups,
        forces=np.array(file.accuracy.forces),
        max_deflection=file.accuracy.max_deflection,
        levels=file.pareto,
        task_pose=next(pose for pose in poses if pose.name == file.task.pose_of),
        exact=file.task.exact,
        poses=poses,
        scenarios=tuple(file.scenarios) if isinstance(file.scenarios, list) else file.scenarios,
        moments=moments,
        payload=file.accuracy.payload,
        sag=file.accuracy.sag,
        margin=file.accuracy.margin,
        other_bounds=bounds,
        other_variables=variables,
        objective=objective,
        catalogue=catalogue,
    )


def robot_of_study(section: RobotSection, source: Path) -> Robot:
    """Load the robot, a chain to its tip; a path is taken relative to the study file."""
    with _naming(source, "robot", "model"):
        robot = loaded(section, source.parent)
    with _naming(source, "robot", "tip"):
        chain = chain_of(robot, section)
    with _naming(source, "robot", "model"):
        require_held_joints(chain)
    with _naming(source, "robot", "floating"):
        if section.floating:
            floating_robot(chain)  # its base needs a mass
    return chain


def _pose(model: ImpactModel, section: PoseSection) -> Pose:
    field = f"{section.name}.q"
    q = posture_of(model, field, section.q)
    require_within_limits(model.robot, field, q)
    return Pose(section.name, q, section.recovered)
