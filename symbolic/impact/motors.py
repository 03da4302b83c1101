# SPDX-License-Identifier: BSD-3-Clause
"""What the motors do during an impact, until the robot reacts and after it has."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Literal, get_args

from ..errors import InvalidValue, UnknownName

MotorKind = Literal["free", "servo", "driven", "held"]
"""From first touch until the reaction:

- ``free``: no torque changes.
- ``servo``: K_p and K_d act on the motors' deviation from a reference that moves on at the speed
  before the impact.
- ``driven``: the motors keep that speed, which is the limit of a stiff servo and of heavy rotors.
- ``held``: K_p pulls the motors back to where they were at first touch (MSM Eq. 5), as if that had
  been foreseen. Only the papers need it: it never feeds a safe speed, a design or a C package.
"""

MotorLaw = Literal["free", "servo", "driven", "held", "braking", "stopped"]
"""What a motor does at a time: one of the kinds, or how it ends."""

Reaction = Literal["release", "stop"]
"""What follows the reaction time: motors without torque, or motors that come to rest."""

REACTION_TIME = 0.02
"""From first touch until a contact is noticed [s] (MSM §3.1.3)."""

STOPPING_TIME = 0.1
"""Default time in which motors come to rest [s]: an estimate, as makers state stopping times of 50
to 300 ms for arms of this size; give the machine's own."""

KINDS = get_args(MotorKind)

PRESCRIBED: tuple[MotorLaw, ...] = ("driven", "braking", "stopped")
"""Laws under which the motors' motion is given, whatever the torque."""


@dataclass(frozen=True)
class Motors:
    """What the motors do during an impact; their numbers are in ``Drives``.

    Attributes:
        kind: until the reaction.
        reaction_time: from first touch to the reaction [s]; infinite if there is none.
        reaction: what follows.
        stopping_time: of motors that stop: their speed falls evenly to zero in it [s].
    """

    kind: MotorKind = "free"
    reaction_time: float = REACTION_TIME
    reaction: Reaction = "release"
    stopping_time: float = STOPPING_TIME

    @property
    def laws(self) -> tuple[tuple[float, MotorLaw], ...]:
        """When each law begins [s since first touch], in order; the last goes on."""
        begin: tuple[tuple[float, MotorLaw], ...] = ((0.0, self.kind),)
        at = self.reaction_time
        if at == inf or self.kind == "held":
            return begin
        if self.reaction == "stop":
            return *begin, (at, "braking"), (at + self.stopping_time, "stopped")
        return begin if self.kind == "free" else (*begin, (at, "free"))


def check_motors(motors: Motors) -> None:
    """Raise InvalidValue or UnknownName if a field of the motors cannot be."""
    if motors.kind not in KINDS:
        raise UnknownName("kind of motors", motors.kind, KINDS)
    if motors.reaction not in get_args(Reaction):
        raise UnknownName("reaction", motors.reaction, get_args(Reaction))
    if not motors.reaction_time >= 0:
        raise InvalidValue("reaction_time", f"must be ≥ 0 s, not {motors.reaction_time:g}")
    if not 0 < motors.stopping_time < inf:
        raise InvalidValue(
            "stopping_time", f"must be finite and greater than 0 s, not {motors.stopping_time:g}"
        )


def refuse_held(motors: Motors, use: str) -> None:
    """Raise InvalidValue if motors are held.

    Args:
        motors: what they do.
        use: what they would feed, such as "a safe speed".
    """
    if motors.kind == "held":
        raise InvalidValue(
            "motors",
            f"'held' cannot give {use}: it pulls the motors back from first touch on, which no "
            "controller does, and so makes robots look safer the higher its gains; choose "
            "'servo', 'driven' or 'free'",
        )
