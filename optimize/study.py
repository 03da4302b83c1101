# SPDX-License-Identifier: BSD-3-Clause
"""Studies: a robot, an impact, bounds and candidate configurations, checked."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

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
    load_robot,
    lock_joints,
    unit_direction,
)
from softimpact.symbolic.impact.drives import PerJoint, per_joint, require_rotors
from softimpact.symbolic.robot.rigid import Array

from .hardware import joint_groups
from .study_file import (
    ParetoSection,
    PoseSection,
    RobotSection,
    ScenarioSection,
    ScenariosSection,
    StiffnessSection,
    StudyFile,
    read_study_file,
)
from .study_motors import motors_of


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

    @property
    def robot(self) -> Robot:
        """The robot, a chain to its tip."""
        return self.model.robot


def load_study(path: str | Path, overrides: dict[str, dict[str, Any]] | None = None) -> Study:
    """Read and check a study file.

    Args:
        path: a TOML file.
        overrides: values that replace the file's, by section and field, as a command line gives.

    Raises:
        InvalidValue: a field is missing, unknown, of the wrong type or out of range; names file
            and field.
    """
    source = Path(path)
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
        lower, upper, nominal = _stiffness(robot, file.stiffness)
    with _naming(source, "robot", "rotor_inertia"):
        model = _model(robot, file, nominal)
        if file.motors.kind != "driven":
            require_rotors(model.drives, robot.joint_names)
    with _naming(source, "motors", "kind"):
        motors = motors_of(file.motors, model)
    with _naming(source, "hardware", "joint_stiffness"):
        groups = joint_groups(robot, file.hardware.joint_stiffness)
    with _naming(source, "impact", "direction"):
        direction = unit_direction(file.impact.direction)
    with _naming(source, "impact", "region"):
        region = body_region(file.impact.region)
    with _naming(source, "poses", "q"):
        poses = tuple(_pose(robot, pose) for pose in file.poses)
    for pose in poses:
        with _naming(source, "impact", f"direction at pose '{pose.name}'"):
            approach_velocity(model, pose.q, direction)
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
    return impact_model(robot, drives_=built)


def _stiffness(robot: Robot, section: StiffnessSection) -> tuple[Array, Array, Array]:
    """Return lower and upper bounds and the nominal stiffness, length n each."""
    lower = per_joint(robot, "lower", section.lower)
    upper = per_joint(robot, "upper", section.upper)
    nominal = per_joint(robot, "nominal", section.nominal)
    for joint, low, high, value in zip(robot.joint_names, lower, upper, nominal, strict=True):
        if low > high:
            raise InvalidValue(
                "lower", f"lower bound {low:g} is above the upper {high:g} at joint '{joint}'"
            )
        if not low <= value <= high:
            raise InvalidValue(
                "nominal", f"{value:g} at joint '{joint}' is outside its bounds [{low:g}, {high:g}]"
            )
    return lower, upper, nominal


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
