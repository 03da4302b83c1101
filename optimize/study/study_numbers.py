# SPDX-License-Identifier: BSD-3-Clause
"""Numbers of a study file that must fit the robot or each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from softimpact.symbolic import ImpactModel, InvalidValue
from softimpact.symbolic.robot.rigid import Array
from softimpact.symbolic.robot.robot import vector_of

from ..machine.coordinates import loose
from .study_file import AccuracySection, StiffnessSection


def moments_of(section: AccuracySection, model: ImpactModel) -> Array | None:
    """Return the moments on the tip, one for each force; raises InvalidValue."""
    if section.sag and loose(model):
        raise InvalidValue(
            "sag",
            "of a floating robot depends on what it stands on; hold the base, or leave it out",
        )
    given = section.moments
    if given is None:
        return None
    if len(given) != len(section.forces):
        raise InvalidValue("moments", f"needs {len(section.forces)}, one for each force")
    return np.array(given)


def catalogue_of(
    given: list[float] | None,
    names: Sequence[str],
    groups: tuple[int, ...],
    lower: Array,
    upper: Array,
) -> tuple[float, ...]:
    """Return the stiffnesses that can be bought, rising; each group must have one in its range.

    Raises InvalidValue.
    """
    entries = tuple(sorted(set(given or ())))
    for group in range(max(groups) + 1) if entries else ():
        joints = [i for i, g in enumerate(groups) if g == group]
        low, high = lower[joints].max(), upper[joints].min()
        if not any(low <= entry <= high for entry in entries):
            of = ", ".join(names[i] for i in joints)
            raise InvalidValue(
                "catalogue", f"has no entry from {low:g} to {high:g} N·m/rad, the range of {of}"
            )
    return entries


def stiffness_of(names: Sequence[str], section: StiffnessSection) -> tuple[Array, Array, Array]:
    """Return lower and upper bounds and the nominal stiffness, one for each spring.

    Args:
        names: of the joints that have one.
        section: as written: one number for all, or one for each.
    """
    lower, upper, nominal = (
        vector_of(names, field, [value] * len(names) if isinstance(value, float | int) else value)
        for field, value in vars(section).items()
        if field != "rigid"
    )
    for joint, low, high, value in zip(names, lower, upper, nominal, strict=True):
        if low > high:
            raise InvalidValue(
                "lower", f"lower bound {low:g} is above the upper {high:g} at joint '{joint}'"
            )
        if not low <= value <= high:
            raise InvalidValue(
                "nominal", f"{value:g} at joint '{joint}' is outside its bounds [{low:g}, {high:g}]"
            )
    return lower, upper, nominal
