# SPDX-License-Identifier: BSD-3-Clause
"""What the motors do, as typed."""

from __future__ import annotations

from dataclasses import dataclass, replace

from softimpact.symbolic import InvalidValue, Motors
from softimpact.symbolic.impact.motors import MotorKind, check_motors

from . import values
from .situation import TypedDrives


@dataclass(frozen=True)
class TypedMotors:
    """The options that say what motors do; see ``options``."""

    kind: str | None = None
    reaction_time: float | None = None
    stopping_time: float | None = None


NOTHING_SAID = TypedMotors()
"""Motors of which nothing is known."""


def motors_meant(typed: TypedMotors, drives: TypedDrives) -> tuple[Motors | None, Motors]:
    """Return what motors do, None if that is open, and how they react.

    Raises:
        InvalidValue, UnknownName: the options contradict each other, or one cannot be.
    """
    gains = {
        "position_gain": drives.position_gain,
        "computed_torque_gain": drives.computed_torque_gain,
        "damping_gain": drives.damping_gain,
    }
    given = [name for name, value in gains.items() if value is not None]
    kind = typed.kind
    if given and kind in ("free", "driven"):
        raise InvalidValue(given[0], f"is a servo's; motors that are '{kind}' have no gains")
    if drives.damping_gain is not None and kind == "held":
        raise InvalidValue("damping_gain", "is a servo's; motors that are 'held' have K_p alone")
    if kind == "held" and len(given) == 0:
        raise InvalidValue("motors", "'held' needs position_gain or computed_torque_gain")
    how = Motors()
    if typed.reaction_time is not None:
        how = replace(how, reaction_time=typed.reaction_time)
    if typed.stopping_time is not None:
        how = replace(how, reaction="stop", stopping_time=typed.stopping_time)
    check_motors(how)
    if kind is None:
        return (replace(how, kind="servo") if given else None), how
    known: MotorKind = values.one_of("kind of motors", kind, MotorKind)
    if known == "held" and (typed.reaction_time is not None or typed.stopping_time is not None):
        raise InvalidValue("reaction_time", "motors that are 'held' do not react")
    return replace(how, kind=known), how
