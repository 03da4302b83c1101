# SPDX-License-Identifier: BSD-3-Clause
"""The springs: each joint its own, all the same, or shared by groups of joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Literal

import numpy as np

from softimpact.symbolic import ImpactModel, InvalidValue, Matrix, Robot, UnknownName

from ..hardware import Hardware
from .variable import Range, Variable

Grouping = Literal["each", "equal"] | Sequence[Sequence[str]]
"""Each joint its own stiffness, all the same, or groups of joints by name."""


@dataclass(frozen=True)
class JointStiffness(Variable):
    """k_s of each group of joints.

    Attributes:
        groups: of each joint, length n; joints of the same group share their spring.
        lower, upper: ends of the range of each joint, length n [N·m/rad].
        nominal: stiffness as it is, length n [N·m/rad].
    """

    kind: ClassVar[str] = "joint_stiffness"
    unit: ClassVar[str] = "N·m/rad"
    moves: ClassVar[tuple[str, ...]] = ("springs",)

    groups: tuple[int, ...]
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    nominal: tuple[float, ...]

    def range(self, model: ImpactModel) -> Range:
        """Return the range that all joints of a group keep."""
        names, ends = [], []
        for group in range(max(self.groups) + 1):
            joints = [i for i, g in enumerate(self.groups) if g == group]
            names.append(", ".join(model.robot.joint_names[i] for i in joints))
            low, high = max(self.lower[i] for i in joints), min(self.upper[i] for i in joints)
            ends.append((low, high, self.nominal[joints[0]]))
        lower, upper, start = np.array(ends).T
        return Range(tuple(names), lower, upper, np.clip(start, lower, upper))

    def apply(self, hardware: Hardware, values: Matrix) -> Hardware:
        """Return the hardware with these springs, one for each group."""
        return replace(hardware, springs=values[list(self.groups), 0])


def joint_groups(robot: Robot, grouping: Grouping) -> tuple[int, ...]:
    """Return the group of each joint, length n; groups are numbered as they first occur.

    Raises:
        InvalidValue: a joint in two groups, or in none.
        UnknownName: there is no such joint.
    """
    if grouping == "each":
        return tuple(range(robot.n))
    if grouping == "equal":
        return (0,) * robot.n
    group_of: dict[str, int] = {}
    for i, names in enumerate(grouping):
        for name in names:
            if name not in robot.joint_names:
                raise UnknownName("joint", name, robot.joint_names)
            if name in group_of:
                raise InvalidValue("joint_stiffness", f"joint '{name}' is in two groups")
            group_of[name] = i
    missing = [name for name in robot.joint_names if name not in group_of]
    if missing:
        raise InvalidValue("joint_stiffness", f"joint '{missing[0]}' is in no group")
    order = list(dict.fromkeys(group_of[name] for name in robot.joint_names))
    return tuple(order.index(group_of[name]) for name in robot.joint_names)
