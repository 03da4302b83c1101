# SPDX-License-Identifier: BSD-3-Clause
"""The springs: each joint its own, all the same, or shared by groups of joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Literal

import numpy as np

from softimpact.symbolic import ImpactModel, InvalidValue, Matrix, UnknownName
from softimpact.symbolic.robot.rigid import Array

from ..machine.hardware import Hardware
from ..machine.springs import spring_names
from .variable import Range, Variable

Grouping = Literal["each", "equal"] | Sequence[Sequence[str]]
"""Each joint its own stiffness, all the same, or groups of joints by name."""


@dataclass(frozen=True)
class JointStiffness(Variable):
    """k_s of each group of joints.

    Attributes:
        groups: of each spring; those of the same group have the same stiffness.
        lower, upper: ends of the range of each spring [N·m/rad].
        nominal: stiffness as it is, of each spring [N·m/rad].
    """

    kind: ClassVar[str] = "joint_stiffness"
    unit: ClassVar[str] = "N·m/rad"
    moves: ClassVar[tuple[str, ...]] = ("springs",)

    groups: tuple[int, ...]
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    nominal: tuple[float, ...]

    def range(self, model: ImpactModel) -> Range:
        """Return the range that all springs of a group keep."""
        names, ends = [], []
        joint_names = spring_names(model)
        for group in range(max(self.groups) + 1):
            joints = [i for i, g in enumerate(self.groups) if g == group]
            names.append(", ".join(joint_names[i] for i in joints))
            low, high = max(self.lower[i] for i in joints), min(self.upper[i] for i in joints)
            ends.append((low, high, self.nominal[joints[0]]))
        lower, upper, start = np.array(ends).T
        return Range(tuple(names), lower, upper, np.clip(start, lower, upper))

    def apply(self, hardware: Hardware, values: Matrix) -> Hardware:
        """Return the hardware with these springs, one for each group."""
        return replace(hardware, springs=values[list(self.groups), 0])


def require_common_stiffness(
    model: ImpactModel, groups: Sequence[int], lower: Array, upper: Array
) -> None:
    """Raise InvalidValue for joints that share a spring but no stiffness within their bounds."""
    names = spring_names(model)
    for group in range(max(groups) + 1):
        joints = [i for i, g in enumerate(groups) if g == group]
        low, high = max(joints, key=lambda i: lower[i]), min(joints, key=lambda i: upper[i])
        if lower[low] > upper[high]:
            raise InvalidValue(
                "joint_stiffness",
                f"joints '{names[low]}' and '{names[high]}' share a spring, but '{names[low]}' "
                f"needs {lower[low]:g} at least and '{names[high]}' {upper[high]:g} at most; part "
                "them, or change stiffness.lower or upper",
            )


def joint_groups(model: ImpactModel, grouping: Grouping) -> tuple[int, ...]:
    """Return the group of each spring; groups are numbered as they first occur.

    Raises:
        InvalidValue: a joint in two groups, or in none.
        UnknownName: there is no such joint.
    """
    known = spring_names(model)
    if grouping == "each":
        return tuple(range(len(known)))
    if grouping == "equal":
        return (0,) * len(known)
    group_of: dict[str, int] = {}
    for i, names in enumerate(grouping):
        if not names:
            raise InvalidValue("joint_stiffness", f"group {i + 1} names no joint; leave it out")
        for name in names:
            if name not in known:
                raise UnknownName("joint with a spring", name, known)
            if name in group_of:
                raise InvalidValue("joint_stiffness", f"joint '{name}' is in two groups")
            group_of[name] = i
    missing = [name for name in known if name not in group_of]
    if missing:
        raise InvalidValue("joint_stiffness", f"joint '{missing[0]}' is in no group")
    order = list(dict.fromkeys(group_of[name] for name in known))
    return tuple(order.index(group_of[name]) for name in known)
