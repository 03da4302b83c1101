# SPDX-License-Identifier: BSD-3-Clause
"""Numbers that a package knows of its parameters: defaults at run time, or frozen into it."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from softimpact.symbolic import Drives, InvalidValue, Robot, UnknownName

from .parameters import POSITIVE, Parameter, freeze, lacks_springs

ALL = "all"
"""Stands for all parameters where some are named."""


@dataclass(frozen=True)
class Payload:
    """A point mass at the contact point's frame.

    Attributes:
        mass: in kg.
        com: its place from the contact point along the tip's axes [m], length 3.
    """

    mass: float = 0.0
    com: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Default:
    """Default values of a parameter; None where none are known."""

    parameter: Parameter
    values: tuple[float, ...] | None


def defaults_of(
    robot: Robot,
    parameters: Sequence[Parameter],
    drives: Drives | None,
    payload: Payload | None,
) -> tuple[Default, ...]:
    """Return the numbers known of each parameter; None where the caller must set them.

    Args:
        robot: any robot.
        parameters: of its package.
        drives: numbers, where they are not the robot's own.
        payload: what it carries, if anything.

    Raises:
        InvalidValue: a payload that no robot can carry, or springs that a package leaves out.
    """
    known: dict[str, Sequence[float] | None] = {
        "joint_stiffness": None,
        "rotor_inertia": robot.armature.tolist(),
        "position_gain": [0.0] * robot.n,
        "damping_gain": [0.0] * robot.n,
    }
    if drives is not None:
        if lacks_springs(robot, drives):
            raise InvalidValue(
                "joint_stiffness",
                f"the C of '{robot.name}' has no springs behind motors, as it has "
                f"{_own_compliance(robot)}; leave it out",
            )
        known = {
            "joint_stiffness": np.array(drives.springs).ravel().tolist(),
            "rotor_inertia": np.array(drives.rotors).ravel().tolist(),
            "position_gain": np.array(drives.gains).ravel().tolist(),
            "damping_gain": [0.0] * robot.n
            if drives.damping_gains is None
            else np.array(drives.damping_gains).ravel().tolist(),
        }
    if payload is not None:
        _check(robot, payload)
        known |= {"payload_mass": [payload.mass], "payload_com": payload.com}
    defaults = []
    for parameter in parameters:
        values = known[parameter.name]
        usable = values is not None and (parameter.range is not POSITIVE or min(values) > 0)
        defaults.append(Default(parameter, tuple(values) if usable and values else None))
    return tuple(defaults)


def _own_compliance(robot: Robot) -> str:
    """Return in words why joints of a package get no springs behind their motors."""
    if robot.loops:
        return "loops or coupled joints"
    return "springs of its own" if robot.has_springs else "passive joints"


def _check(robot: Robot, payload: Payload) -> None:
    if robot.loops:
        raise InvalidValue("payload", "a closed chain would rest elsewhere under it; leave it out")
    if not 0 <= payload.mass < np.inf:
        raise InvalidValue("payload_mass", f"must be finite and ≥ 0 kg, not {payload.mass:g}")
    if len(payload.com) != 3 or not np.isfinite(payload.com).all():
        raise InvalidValue("payload_com", "needs three finite numbers [x, y, z]")


def frozen_parameters(defaults: Sequence[Default], names: Collection[str]) -> tuple[Parameter, ...]:
    """Return the parameters with those named frozen at their defaults.

    Raises:
        UnknownName: there is no such parameter.
        InvalidValue: the numbers of one are not known.
    """
    known = {d.parameter.name: d.values for d in defaults}
    for name in names:
        if name not in (*known, ALL):
            raise UnknownName("parameter to freeze", name, (*known, ALL))
    values = {}
    for name in known if ALL in names else names:
        numbers = known[name]
        if numbers is None:
            raise InvalidValue(name, "is to be frozen, so it needs numbers greater than 0")
        values[name] = numbers
    return freeze([d.parameter for d in defaults], values)
