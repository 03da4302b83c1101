# SPDX-License-Identifier: BSD-3-Clause
"""What the motors do, as typed."""

from __future__ import annotations

from dataclasses import replace

from softimpact.symbolic import InvalidValue, Motors
from softimpact.symbolic.impact.motors import MotorKind, check_motors

from . import values
from .groups import TypedDrives


def motors_meant(typed: TypedDrives) -> tuple[Motors | None, Motors]:
    """Return what motors do, None if that is open, and how they react.

    Raises:
        InvalidValue, UnknownName: the options contradict each other, or one cannot be.
    """
    given, kind = list(typed.gains), typed.motors
    if given and kind in ("free", "driven"):
        raise InvalidValue(given[0], f"is a servo's; motors that are '{kind}' have no gains")
    if typed.damping_gain is not None and kind == "held":
        raise InvalidValue("damping_gain", "is a servo's; motors that are 'held' have K_p alone")
    if kind == "held" and not given:
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
