# SPDX-License-Identifier: BSD-3-Clause
"""Which joints share a spring: the variables that stand for the joint stiffness."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from softimpact.symbolic import InvalidValue, Robot, UnknownName

Grouping = Literal["each", "equal"] | Sequence[Sequence[str]]
"""Each joint its own stiffness, all the same, or groups of joints by name."""


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
