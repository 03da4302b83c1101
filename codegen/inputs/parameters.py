# SPDX-License-Identifier: BSD-3-Clause
"""The numbers that C functions read beside q and n: fields of the parameter struct, and scalars."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from softimpact.symbolic import Drives, Robot


@dataclass(frozen=True)
class InputRange:
    """Which finite numbers an input may be.

    Attributes:
        check: name of the C function that checks it, without its prefix.
        words: for the header; empty if there is no bound.
        outside: numbers on either side that are refused.
    """

    check: str
    words: str
    outside: tuple[float, ...]


POSITIVE = InputRange("check_positive", "> 0", (-1.0, 0.0))
NOT_NEGATIVE = InputRange("check_not_negative", ">= 0", (-1.0,))
SHARE = InputRange("check_share", "from 0 to 1", (-1.0, 2.0))
ANY = InputRange("check_finite", "", ())


@dataclass(frozen=True)
class Parameter:
    """A named input.

    Attributes:
        name: of the struct's field, or of the argument.
        unit: of its entries.
        meaning: in words.
        range: of its entries.
        shape: as a C array; () for a scalar.
        frozen: its numbers, if they are folded into the expressions; it is then no input in C.
    """

    name: str
    unit: str
    meaning: str
    range: InputRange
    shape: tuple[int, ...] = ()
    frozen: tuple[float, ...] | None = None

    @property
    def size(self) -> int:
        """Number of entries."""
        return math.prod(self.shape)

    @property
    def brackets(self) -> str:
        """What follows the name in a declaration."""
        return "".join(f"[{size}]" for size in self.shape)

    @property
    def places(self) -> list[str]:
        """The name of each entry in C."""
        return [f"{self.name}[{i}]" for i in range(self.size)] if self.shape else [self.name]

    @property
    def comment(self) -> str:
        """Unit, range and meaning."""
        bound = f", {self.range.words}" if self.range.words else ""
        return f"{self.unit}{bound}; {self.meaning}"


SCALARS = (
    Parameter("speed", "m/s", "of approach along n", POSITIVE),
    Parameter("restitution", "dimensionless", "e: 0 no rebound, 1 elastic", SHARE),
    Parameter("other_mobility", "1/kg", "1/mass of what is hit; 0 if it is held", NOT_NEGATIVE),
    Parameter("duration", "s", "from first touch to the peak, or to the reaction", NOT_NEGATIVE),
)
"""Arguments of their own, which some functions take between n and the parameters."""


PAYLOAD = (
    Parameter("payload_mass", "kg", "point mass held at the contact point's frame", NOT_NEGATIVE),
    Parameter("payload_com", "m", "its place from the contact point, tip's axes", ANY, (3,)),
)
"""Parameters of robots that carry something."""


def parameters_of(robot: Robot, *, payload: bool = False) -> tuple[Parameter, ...]:
    """Return the parameters of a robot's package, none of them frozen.

    Args:
        robot: any robot.
        payload: whether it may carry something.
    """
    return (*_drives_of(robot), *(PAYLOAD if payload else ()))


def freeze(
    parameters: Sequence[Parameter], values: Mapping[str, Sequence[float]]
) -> tuple[Parameter, ...]:
    """Return the parameters with some of them fixed to numbers, given by name."""
    return tuple(
        replace(p, frozen=tuple(values[p.name])) if p.name in values else p for p in parameters
    )


def _drives_of(robot: Robot) -> tuple[Parameter, ...]:
    elastic, joints = is_elastic(robot), (robot.n,)
    rotors = "rotor inertia, reflected to the joint" + ("" if elastic else "; may be 0")
    inertia = POSITIVE if elastic else NOT_NEGATIVE
    drives = (
        Parameter("rotor_inertia", "kg m^2", rotors, inertia, joints),
        Parameter(
            "position_gain",
            "N m/rad",
            "proportional gain of the motor's controller",
            NOT_NEGATIVE,
            joints,
        ),
        Parameter(
            "damping_gain",
            "N m s/rad",
            "gain of the same on the motor's rate",
            NOT_NEGATIVE,
            joints,
        ),
    )
    if not elastic:
        return drives
    springs = "stiffness of the joint's spring"
    return (Parameter("joint_stiffness", "N m/rad", springs, POSITIVE, joints), *drives)


def is_elastic(robot: Robot) -> bool:
    """Whether every joint gets a spring behind its motor.

    A robot with passive joints, loops or springs of its own describes its compliance itself.
    """
    plain = not robot.loops and not robot.has_springs
    return plain and all(robot.actuated)


def lacks_springs(robot: Robot, known: Drives) -> bool:
    """Return whether a package leaves out springs behind motors that the robot has."""
    return any(known.elastic) and not is_elastic(robot)
