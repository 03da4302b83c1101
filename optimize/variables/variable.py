# SPDX-License-Identifier: BSD-3-Clause
"""What a variable is: numbers of the hardware that a design may choose, and their range."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from softimpact.symbolic import ImpactModel, InvalidValue, Matrix
from softimpact.symbolic.impact.drives import PerJoint, per_joint
from softimpact.symbolic.robot.rigid import Array

from ..machine.hardware import Hardware

OneOrEach = float | tuple[float, ...]
"""One number for all, or one for each."""


@dataclass(frozen=True, eq=False)
class Range:
    """Which values a variable may take.

    Attributes:
        names: of its entries.
        lower, upper: ends of each, greater than zero.
        start: that the search begins with, which stands for the machine as it is.
    """

    names: tuple[str, ...]
    lower: Array
    upper: Array
    start: Array


class Variable(Protocol):
    """A variable of the hardware, as a frozen dataclass that derives from this class.

    The search moves the logarithm of its values, so that each is greater than zero.

    Attributes:
        kind: its name in the table ``[hardware]`` of a study file.
        unit: of its values.
        moves: what of ``Hardware`` it changes.
        hastens: whether larger values make an arm swing faster; else smaller ones do, or none.
    """

    kind: ClassVar[str] = ""
    unit: ClassVar[str] = ""
    moves: ClassVar[tuple[str, ...]] = ()
    hastens: ClassVar[bool] = False

    def range(self, model: ImpactModel) -> Range:
        """Return which values it may take on a robot; raises InvalidValue."""
        ...

    def apply(self, hardware: Hardware, values: Matrix) -> Hardware:
        """Return the hardware with these values, expressions or numbers, in ``unit``."""
        ...


def joint_range(model: ImpactModel, lower: OneOrEach, upper: OneOrEach, start: PerJoint) -> Range:
    """Return the range of a variable with one value a joint.

    Raises:
        InvalidValue: a lower end that is not positive, or above the upper one.
        WrongLength: numbers that do not fit the robot.
    """
    robot = model.robot
    low, high = (
        per_joint(robot, field, values if isinstance(values, float | int) else list(values))
        for field, values in (("lower", lower), ("upper", upper))
    )
    return checked_range(Range(robot.joint_names, low, high, per_joint(robot, "start", start)))


def checked_range(range_: Range) -> Range:
    """Return a range with its start within it; raises InvalidValue if there is none."""
    for name, low, high in zip(range_.names, range_.lower, range_.upper, strict=True):
        if not 0 < low < np.inf:
            raise InvalidValue("lower", f"must be finite and greater than 0, not {low:g} ({name})")
        if not low <= high < np.inf:
            raise InvalidValue(
                "upper", f"must be finite and at least {low:g}, not {high:g} ({name})"
            )
    start = np.clip(range_.start, range_.lower, range_.upper)
    return Range(range_.names, range_.lower, range_.upper, start)
