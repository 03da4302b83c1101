# SPDX-License-Identifier: BSD-3-Clause
"""Options that belong together, as commands take them and as they were typed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import MISSING, dataclass, fields, is_dataclass
from inspect import Parameter
from typing import TYPE_CHECKING, Annotated, Any, get_args, get_origin, get_type_hints

from . import options as o

if TYPE_CHECKING:
    from softimpact.optimize import Study


@dataclass(frozen=True)
class TypedArm:
    """The options that make up an arm."""

    model: o.ModelArgument
    tip: o.TipOption = None
    end: o.EndOption = None
    lock: o.LockOption = None
    payload: o.PayloadOption = None
    tool: o.ToolOption = None
    hold_base: o.HoldBaseOption = False


@dataclass(frozen=True)
class TypedDrives:
    """The options that make up drives, and say what motors do and how they react."""

    motors: o.MotorsOption = None
    reaction_time: o.ReactionTimeOption = None
    stopping_time: o.StoppingTimeOption = None
    joint_stiffness: o.JointStiffnessOption = None
    rotor_inertia: o.RotorInertiaOption = None
    position_gain: o.PositionGainOption = None
    damping_gain: o.DampingGainOption = None
    computed_torque_gain: o.ComputedTorqueGainOption = None
    torque_limit: o.TorqueLimitOption = None
    gear_ratio: o.GearRatioOption = None

    @property
    def gains(self) -> dict[str, object]:
        """Gains that were given, by name."""
        names = ("position_gain", "computed_torque_gain", "damping_gain")
        given = {name: getattr(self, name) for name in names}
        return {name: value for name, value in given.items() if value is not None}

    @property
    def tell_motors(self) -> bool:
        """Whether anything was said of what motors do, or of how they react."""
        said = (self.motors, self.reaction_time, self.stopping_time)
        return any(value is not None for value in said)


@dataclass(frozen=True)
class TypedStudy:
    """A study, and the options that stand in place of what it says."""

    file: o.StudyFileArgument
    region: o.RegionOption = None
    speed: o.SpeedOption = None
    motors: o.StudyMotorsOption = None
    reaction_time: o.ReactionTimeOption = None

    def read(self, **sections: Mapping[str, Any]) -> Study:
        """Return the study that is meant; raises SoftImpactError.

        Args:
            sections: by name, what stands in their place, too; None is left as it is.
        """
        from softimpact.optimize import load_study

        changed: dict[str, Mapping[str, Any]] = {
            "impact": {"region": self.region, "speed": self.speed},
            "motors": {"kind": self.motors, "reaction_time": self.reaction_time},
            **sections,
        }
        told = {
            name: {field: value for field, value in fields.items() if value is not None}
            for name, fields in changed.items()
        }
        return load_study(self.file, {name: fields for name, fields in told.items() if fields})


@dataclass(frozen=True)
class TypedExecution:
    """The options that say where a search runs."""

    workers: o.WorkersOption = None
    dask: o.DaskOption = None
    resume: o.ResumeOption = False


class But:
    """What a command has in place of some options of a group; None for those it cannot use.

    Written beside the group: ``arm: Annotated[TypedArm, But(tip=None)]``.
    """

    def __init__(self, **options: Any) -> None:
        self.options = options


@dataclass(frozen=True)
class Group:
    """A group of options as one command has it.

    Attributes:
        kind: frozen dataclass that the command takes.
        parameters: its fields as options.
    """

    kind: type[Any]
    parameters: tuple[Parameter, ...]

    def taken(self, options: dict[str, Any]) -> Any:
        """Return what was typed of the group, and take it out of a command's options."""
        return self.kind(**{each.name: options.pop(each.name) for each in self.parameters})


def groups_of(parameters: Mapping[str, Parameter]) -> dict[str, Group]:
    """Return the groups among a command's parameters, by name."""
    found = {}
    for name, parameter in parameters.items():
        marked = get_origin(parameter.annotation) is Annotated
        kind, *marks = get_args(parameter.annotation) if marked else (parameter.annotation,)
        if is_dataclass(kind):
            assert isinstance(kind, type)
            found[name] = Group(kind, tuple(_options_of(kind, marks)))
    return found


def _options_of(kind: type[Any], marks: list[Any]) -> Iterator[Parameter]:
    others = {k: v for mark in marks if isinstance(mark, But) for k, v in mark.options.items()}
    hints = get_type_hints(kind, include_extras=True)
    for field in fields(kind):
        annotation = others.get(field.name, hints[field.name])
        if annotation is not None:
            default = Parameter.empty if field.default is MISSING else field.default
            yield Parameter(
                field.name, Parameter.KEYWORD_ONLY, default=default, annotation=annotation
            )
