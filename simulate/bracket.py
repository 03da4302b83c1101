# SPDX-License-Identifier: BSD-3-Clause
"""What the motors may do, where nobody has said what they do."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np

from softimpact.symbolic import ImpactModel, InvalidValue, Motors
from softimpact.symbolic.impact.motors import KINDS, PRESCRIBED

from .controller import Controller

LUMPED = (
    "a model of one or two masses knows nothing of motors that drive on; its force may be far too "
    "low, so let no decision rest on it"
)


def bracket(
    model: ImpactModel,
    motors: Motors | Controller | None,
    reaction: Motors | None = None,
    lumped: bool = False,
) -> tuple[dict[str, Motors | Controller | None], list[str]]:
    """Return what motors may do, by kind, and what had to be assumed.

    Args:
        model: the robot.
        motors: what they do, if that is known.
        reaction: reaction time and what follows, if it is not.
        lumped: whether the model of the robot has no motors.

    Raises:
        InvalidValue: motors are free or a servo, and a rotor's inertia is unknown.
    """
    if lumped:
        return {"free": motors}, [LUMPED]
    unknown = unknown_rotors(model)
    names = ", ".join(f"'{name}'" for name in unknown)
    if isinstance(motors, Controller):
        kind, how = None, Motors()
    else:
        kind = motors.kind if motors else ("servo" if model.drives.has_gains else None)
        how = motors or reaction or Motors()
    if unknown and (kind in ("free", "servo", "held") or isinstance(motors, Controller)):
        raise InvalidValue(
            "rotor_inertia",
            f"of joint {names} is unknown, and zero would make the robot look safer than it is; "
            f"give it (0 if there is no rotor), or choose driven motors, which need none",
        )
    if isinstance(motors, Controller):
        return {"controller": motors}, []
    if unknown:
        sets = ", ".join(model.robot.rotor_inertia_sets)
        line = (
            f"rotor inertia of joint {names} is unknown: motors are taken to keep their speed, "
            "without an end, as the worse case; give the rotor inertia"
            f"{f' (the model has the sets {sets})' if sets else ''}"
        )
        return {"driven": replace(how, kind="driven", reaction_time=inf)}, [line]
    kinds = [k for k in KINDS if k in ("free", "driven")] if kind is None else [kind]
    ends = {k: replace(how, kind=k) for k in kinds}
    for end in ends.values():
        require_rotors_behind_springs(model, end)
    return dict(ends), []


def require_rotors_behind_springs(model: ImpactModel, motors: Motors) -> None:
    """Raise InvalidValue for a rotor of nothing that moves by itself behind a spring.

    Args:
        model: the robot.
        motors: what they do; those that keep their speed, or are stopped, need no inertia.
    """
    if all(law in PRESCRIBED for _, law in motors.laws):
        return
    rotors = np.array(model.drives.rotors, dtype=float).ravel()
    none = np.array(model.drives.elastic) & np.array(model.robot.actuated) & (rotors == 0)
    if none.any():
        name = model.robot.joint_names[int(none.argmax())]
        raise InvalidValue(
            "rotor_inertia",
            f"of joint '{name}' is 0, which no motor behind a spring has; give it, or choose "
            "driven motors with a reaction time of inf",
        )


def unknown_rotors(model: ImpactModel) -> list[str]:
    """Return the names of joints with a motor whose rotor inertia nobody has stated."""
    known = model.drives.rotors_known
    if known is None:
        return []
    return [
        joint.name
        for joint, is_known in zip(model.robot.joints, known, strict=True)
        if joint.actuated and not is_known
    ]
