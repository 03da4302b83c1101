# SPDX-License-Identifier: BSD-3-Clause
"""What a study's motors do during its impacts."""

from __future__ import annotations

from math import inf

import numpy as np

from softimpact.symbolic import ImpactModel, InvalidValue, Motors
from softimpact.symbolic.impact.motors import MotorKind, check_motors, refuse_held

from .study_file import MotorsSection


def study_motors(section: MotorsSection, model: ImpactModel) -> tuple[Motors, ...]:
    """Return what the motors may do; the worst of several counts.

    Without a kind, motors with gains are a servo. Without gains either, what they do is unknown:
    free motors and those that keep their speed are the two ends of it. Driven motors of which no
    rotor inertia is known never react: the worse case.

    Raises:
        InvalidValue: motors that are held, or a servo without gains.
    """
    kind, has_gains = section.kind, model.drives.has_gains
    if kind == "driven" and _unknown_rotors(model):
        return (Motors("driven", inf),)
    if kind is None and has_gains:
        kind = "servo"
    if kind == "servo" and not has_gains:
        raise InvalidValue("position_gain", "is needed: a servo acts by its gains")
    kinds: tuple[MotorKind, ...] = ("free", "driven") if kind is None else (kind,)
    found = tuple(
        Motors(each, section.reaction_time, section.reaction, section.stopping_time)
        for each in kinds
    )
    for motors in found:
        refuse_held(motors, "a design")
        check_motors(motors)
    return found


def _unknown_rotors(model: ImpactModel) -> bool:
    """Return whether a motor's rotor is not known: one behind a spring needs an inertia."""
    drives, actuated = model.drives, np.array(model.robot.actuated)
    without = (np.array(drives.rotors).ravel() == 0) & np.array(drives.elastic)
    known = np.array(drives.rotors_known or (True,) * model.robot.n)
    return bool((actuated & (without | ~known)).any())
