# SPDX-License-Identifier: BSD-3-Clause
"""Variables of the hardware, one a file; the search stacks whatever is here."""

from .joint_stiffness import (
    Grouping,
    JointStiffness,
    joint_groups,
    require_common_stiffness,
)
from .variable import Range, Variable, joint_range

__all__ = [
    "Grouping",
    "JointStiffness",
    "Range",
    "Variable",
    "joint_groups",
    "joint_range",
    "require_common_stiffness",
]
