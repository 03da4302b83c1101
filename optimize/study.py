# SPDX-License-Identifier: BSD-3-Clause
"""Studies: a robot, an impact, bounds and candidate configurations, checked."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
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
    Joint,
    Motors,
    Robot,
    SoftImpactError,
    UnknownName,
    approach_velocity,
    body_region,
    chain_to,
    drives,
    impact_model,
    limits_of,
    load_robot,
    lock_joints,
    unit_direction,
)
from softimpact.symbolic.impact.approach import singular_postures
from softimpact.symbolic.impact.drives import PerJoint, require_rotors
from softimpact.symbolic.robot.rigid import Array

from .bounds import Bound, Deflection
from .hardware import TaskMotion
from .objectives import Objective, WorstForce
from .study_file import (
    ParetoSection,
    PoseSection,
    RobotSection,
    ScenarioSection,
    ScenariosSection,
    StudyFile,
    read_study_file,
)
from .study_motors import study_motors
from .study_numbers import catalogue_of, moments_of, stiffness_of
from .study_parts import asked_bounds, asked_objective, asked_variables, require_fit
from .variables import JointStiffness, Range, Variable, joint_groups


@dataclass(frozen=True, eq=False)
class Pose:
    """A candidate configuration.

    Attributes:
        name: of the pose.
        q: link angles as given, length n [rad].
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
        model: the robot with the nominal joint stiffness, all joints elastic.
        contact: what it hits.
        motors: what they do during the impact; of several the worst counts.
        horizon: up to which every contact counts [s].
        direction: unit vector of the tip's velocity, base axes.
        speed: of the tip [m/s].
        lower, upper: bounds on the joint stiffness, length n [N·m/rad].
        nominal: the joint stiffness to improve on, length n [N·m/rad].
        groups: of each joint, length n; joints of the same group have the same stiffness.
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

    def _impacts(self) -> Iterator[tuple[str, Any, float]]:
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
    with _naming(source, "stiffness", "lower"):
        lower, upper, nominal = stiffness_of(robot, file.stiffness)
    with _naming(source, "robot", "rotor_inertia"):
        model = _model(robot, file, nominal)
        if file.motors.kind != "driven":
            require_rotors(model.drives, robot.joint_names)
    with _naming(source, "motors", "kind"):
        motors = study_motors(file.motors, model)
    with _naming(source, "hardware", "joint_stiffness"):
        groups = joint_groups(robot, file.hardware.joint_stiffness)
    with _naming(source, "impact", "direction"):
        direction = unit_direction(file.impact.direction)
    with _naming(source, "impact", "region"):
        region = body_region(file.impact.region)
    with _naming(source, "poses", "q"):
        poses = tuple(_pose(robot, pose) for pose in file.poses)
    with _naming(source, "accuracy", "moments"):
        moments = moments_of(file.accuracy)
    with _naming(source, "hardware", "variables"):
        variables = asked_variables(file.hardware, model)
    with _naming(source, "hardware", "catalogue"):
        catalogue = catalogue_of(file.hardware.catalogue, robot, groups, lower, upper)
    with _naming(source, "bounds", "bounds"):
        bounds = asked_bounds(file.bounds)
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
    beside = source.parent / section.model
    with _naming(source, "robot", "model"):
        model = beside if beside.is_file() else section.model
        robot = load_robot(model, hold_base=section.hold_base, toward=section.tip)
    with _naming(source, "robot", "tip"):
        tip = section.tip if section.tip is not None else robot.tip
        if tip is None:
            raise UnknownName("frame (none is named)", "", robot.frames)
        chain = _locked(chain_to(robot, tip), section.lock)
        if chain.n == 0:
            raise InvalidValue("tip", f"frame '{tip}' is fixed to the base; name one that moves")
    with _naming(source, "robot", "model"):
        _require_open(chain)
        for joint in chain.joints:
            _require_drive(joint)
    return chain


def _locked(chain: Robot, lock: Mapping[str, float]) -> Robot:
    for name in lock:
        if name not in chain.joint_names:
            raise UnknownName("joint (robot.lock)", name, chain.joint_names)
    return lock_joints(chain, lock)


def _require_open(chain: Robot) -> None:
    if chain.loops:
        names = ", ".join(f"'{loop.name}'" for loop in chain.loops)
        raise InvalidValue(
            "model",
            f"'{chain.name}' has joints that are tied together ({names}); a study needs an open "
            "chain to the tip: hold joints still by robot.lock, or take analyze, simulate, "
            "program and generate, which follow them",
        )


def _require_drive(joint: Joint) -> None:
    """A study puts a spring between each joint's motor and its link; the file must not."""
    if joint.actuated and not joint.stiffness:
        return
    fault = "has a spring of its own" if joint.stiffness else "has no motor"
    raise InvalidValue(
        "model",
        f"joint '{joint.name}' {fault}; give the rigid arm, in which every joint has a motor: the "
        "study adds a spring to each",
    )


def _model(robot: Robot, file: StudyFile, nominal: Array) -> ImpactModel:
    section, motors = file.robot, file.motors
    rotors: PerJoint | None
    if isinstance(section.rotor_inertia, str):
        rotors = robot.rotor_inertia_set(section.rotor_inertia)
    else:
        rotors = section.rotor_inertia
    gain = section.position_gain if motors.position_gain is None else motors.position_gain
    built = drives(
        robot,
        nominal,
        rotors,
        gain,
        section.computed_torque_gain,
        damping_gain=motors.damping_gain,
    )
    return impact_model(robot, drives=built)


def _pose(robot: Robot, section: PoseSection) -> Pose:
    q = robot.vector(f"{section.name}.q", section.q)
    lower, upper = robot.limits
    for name, value, low, high in zip(robot.joint_names, q, lower, upper, strict=True):
        if not low <= value <= high:
            raise InvalidValue(
                f"{section.name}.q",
                f"{value:g} at joint '{name}' is outside its limits [{low:g}, {high:g}]",
            )
    return Pose(section.name, q, section.recovered)
