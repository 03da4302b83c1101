# SPDX-License-Identifier: BSD-3-Clause
"""Numbers of MJCF joints, before MuJoCo's compiler sees them."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np

from ..errors import ModelFileError, UnsupportedModel


def require_sound_joints(spec: mujoco.MjSpec, source: str) -> None:
    """Refuse numbers that MuJoCo takes in silence.

    Raises:
        ModelFileError: a number has the wrong sign, or limits are reversed.
        UnsupportedModel: a spring that is not linear.
    """
    for joint in spec.joints:
        name = f"joint '{joint.name}'"
        stiffness, damping = np.ravel(joint.stiffness), np.ravel(joint.damping)
        for field, value in (
            ("armature", joint.armature),
            ("stiffness", stiffness[0]),
            ("damping", damping[0]),
            ("frictionloss", joint.frictionloss),
        ):
            if value < 0:
                raise ModelFileError(source, f"{name}: {field} is negative")
        if joint.range[0] > joint.range[1]:
            raise ModelFileError(
                source,
                f"{name}: its lower limit {joint.range[0]:g} is above its upper {joint.range[1]:g}",
            )
        if np.any(stiffness[1:]):
            reason = f"{name} has springs whose stiffness depends on the deflection"
            raise UnsupportedModel(source, reason)


def set_spring_dampers(
    spec: mujoco.MjSpec, parse: Callable[[], mujoco.MjSpec], source: str
) -> None:
    """Write springs and dampers that are given by time constant and damping ratio as numbers.

    MuJoCo finds them from the inertia that a joint moves in the model's reference configuration
    (XML reference, ``joint/springdamper``), so it must see the file as it is.

    Args:
        spec: gets the numbers, before its inertias are taken out.
        parse: reads the same file again.
        source: the file, for messages.

    Raises:
        UnsupportedModel: MuJoCo cannot compile the file, for example as a mesh is not there.
    """
    by_time = [joint for joint in spec.joints if np.all(np.ravel(joint.springdamper) > 0)]
    if not by_time:
        return
    try:
        untouched = parse()
        model = untouched.compile()
    except ValueError as error:
        reason = (
            f"joint '{by_time[0].name}': springdamper needs the inertias that MuJoCo finds, and it "
            f"refuses the file ({' '.join(str(error).split())}); write stiffness and damping"
        )
        raise UnsupportedModel(source, reason) from None
    for joint, same in zip(spec.joints, untouched.joints, strict=True):
        if not np.all(np.ravel(joint.springdamper) > 0):
            continue
        dof = int(model.jnt_dofadr[same.id])
        _set_first(joint, "stiffness", float(model.jnt_stiffness[same.id]))
        _set_first(joint, "damping", float(model.dof_damping[dof]))
        joint.springdamper = [0.0, 0.0]


def _set_first(joint: mujoco.MjsJoint, field: str, value: float) -> None:
    """Set a number that newer MuJoCos keep with coefficients of higher order behind it."""
    old = getattr(joint, field)
    setattr(joint, field, value if np.ndim(old) == 0 else [value, *np.ravel(old)[1:]])
