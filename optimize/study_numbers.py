# SPDX-License-Identifier: BSD-3-Clause
"""Numbers of a study file that must fit the robot or each other."""

from __future__ import annotations

import numpy as np

from softimpact.symbolic import InvalidValue, Robot
from softimpact.symbolic.impact.drives import per_joint
from softimpact.symbolic.robot.rigid import Array

from .study_file import AccuracySection, StiffnessSection


def moments_of(section: AccuracySection) -> Array | None:
    """Return the moments on the tip, one for each force; raises InvalidValue."""
    given = section.moments
    if given is None:
        return None
    if len(given) != len(section.forces):
        raise InvalidValue("moments", f"needs {len(section.forces)}, one for each force")
    return np.array(given)


def catalogue_of(
    given: list[float] | None, robot: Robot, groups: tuple[int, ...], lower: Array, upper: Array
) -> tuple[float, ...]:
    """Return the stiffnesses that can be bought, rising; each group must have one in its range.

    Raises InvalidValue.
    """
    entries = tuple(sorted(set(given or ())))
    for group in range(max(groups) + 1) if entries else ():
        joints = [i for i, g in enumerate(groups) if g == group]
        low, high = lower[joints].max(), upper[joints].min()
        if not any(low <= entry <= high for entry in entries):
            names = ", ".join(robot.joint_names[i] for i in joints)
            raise InvalidValue(
                "catalogue", f"has no entry from {low:g} to {high:g} N·m/rad, the range of {names}"
            )
    return entries


def stiffness_of(robot: Robot, section: StiffnessSection) -> tuple[Array, Array, Array]:
    """Return lower and upper bounds and the nominal stiffness, length n each."""
    lower = per_joint(robot, "lower", section.lower)
    upper = per_joint(robot, "upper", section.upper)
    nominal = per_joint(robot, "nominal", section.nominal)
    for joint, low, high, value in zip(robot.joint_names, lower, upper, nominal, strict=True):
        if low > high:
            raise InvalidValue(
                "lower", f"lower bound {low:g} is above the upper {high:g} at joint '{joint}'"
            )
        if not low <= value <= high:
            raise InvalidValue(
                "nominal", f"{value:g} at joint '{joint}' is outside its bounds [{low:g}, {high:g}]"
            )
    return lower, upper, nominal
