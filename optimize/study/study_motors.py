# SPDX-License-Identifier: BSD-3-Clause
"""What a study's motors do during its impacts."""

from __future__ import annotations

from math import inf

import numpy as np

from softimpact.symbolic import ImpactModel, InvalidValue, Motors
from softimpact.symbolic.impact.motors import MotorKind, check_motors, refuse_held

from .study_file import MotorsSection, ScenariosSection, StudyFile


def asked_kinds(file: StudyFile) -> tuple[MotorKind, ...]:
    """Return the kinds of motors that a study names, in its scenarios or for all of it.

    Raises:
        InvalidValue: both name some.
    """
    own, asked = file.motors.kind, file.scenarios
    several = asked.motors if isinstance(asked, ScenariosSection) else None
    if several and own:
        raise InvalidValue("kind", "and scenarios.motors say what motors do; give one of them")
    return tuple(dict.fromkeys(several or ([own] if own else [])))


def study_motors(
    section: MotorsSection, model: ImpactModel, kinds: tuple[MotorKind, ...]
) -> tuple[Motors, ...]:
    """Return what the motors may do; the worst of several counts.

    Without kinds, motors with gains are a servo. Without gains either, what they do is unknown:
    free motors and those that keep their speed are the two ends of it. Driven motors of which no
    rotor inertia is known never react: the worse case.

    Raises:
        InvalidValue: motors that are held, or a servo without gains.
    """
    has_gains = model.drives.has_gains
    if not kinds:
        kinds = ("servo",) if has_gains else ("free", "driven")
    if "servo" in kinds and not has_gains:
        raise InvalidValue("position_gain", "is needed: a servo acts by its gains")
    found = tuple(
        Motors("driven", inf)
        if each == "driven" and _unknown_rotors(model)
        else Motors(each, section.reaction_time, section.reaction, section.stopping_time)
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
