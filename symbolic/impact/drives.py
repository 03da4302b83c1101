# SPDX-License-Identifier: BSD-3-Clause
"""What sits between a robot's motors and its links: rotors, springs and controller gains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..content import ByContent
from ..errors import InvalidValue
from ..matrices import Matrix
from ..robot.rigid import Array
from ..robot.robot import Robot

PerJoint = float | Sequence[float] | Array
"""One number for all joints, or one for each."""


@dataclass(frozen=True, eq=False)
class Drives(ByContent):
    """Rotors, springs and gains of all joints; numbers or symbols.

    Attributes:
        rotors: reflected rotor inertias B, length n [kg m²].
        springs: joint stiffnesses k_s, length n [N·m/rad]; not read at rigid joints.
        elastic: whether each joint is elastic.
        gains: K_p on the diagonal, length n [N·m/rad].
        computed_torque_gain: k_p [rad/s²]; adds k_p M_θθ to K_p.
        damping_gains: K_d on the diagonal, length n [N·m·s/rad]; None is zero.
        torque_limits: of what a servo adds, length n [N·m]; infinite, or None, where unknown.
        rotors_known: whether someone has stated each rotor's inertia; None everywhere. One that
            nobody stated counts as zero, and makes a free motor look safer than it is.
    """

    rotors: Matrix
    springs: Matrix
    elastic: tuple[bool, ...]
    gains: Matrix
    computed_torque_gain: Matrix | None = None
    damping_gains: Matrix | None = None
    torque_limits: Array | None = None
    rotors_known: tuple[bool, ...] | None = None

    @property
    def has_gains(self) -> bool:
        """Whether a servo would do anything, as far as numbers tell; symbols count as gains."""
        parts = [self.gains, self.damping_gains, self.computed_torque_gain]
        given = [ca.DM(0) if part is None else part for part in parts]
        return any(
            not isinstance(part, ca.DM | float | int) or bool(np.any(np.array(part)))
            for part in given
        )

    def without_gains(self) -> Drives:
        """Return the drives with motors that no servo drives."""
        return replace(self, gains=0 * self.gains, computed_torque_gain=None, damping_gains=None)


RIGID_FROM = 1e9
"""Stiffness [N·m/rad] from which on a joint counts as rigid: three decades above any drive.
Forces then differ by less than 1e-4, but a simulation would follow vibrations of a megahertz."""


def drives(
    robot: Robot,
    joint_stiffness: PerJoint | None = None,
    rotor_inertia: PerJoint | None = None,
    position_gain: PerJoint | None = None,
    computed_torque_gain: float | None = None,
    gear_ratio: PerJoint | None = None,
    damping_gain: PerJoint | None = None,
    torque_limit: PerJoint | None = None,
) -> Drives:
    """Return checked drives of a robot.

    Args:
        robot: whose joints they are.
        joint_stiffness: k_s [N·m/rad], infinite for a rigid joint, as which it counts from
            ``RIGID_FROM`` on; None makes all joints rigid.
        rotor_inertia: reflected inertias [kg m²]; None takes the file's armature.
        position_gain: diagonal of K_p [N·m/rad]; None is zero.
        computed_torque_gain: k_p [rad/s²], K_p = k_p M_θθ (MSM §3.1.3) instead.
        gear_ratio: N; the rotor inertia is then the motor's own and counts N² times.
        damping_gain: diagonal of K_d [N·m·s/rad]; None is zero.
        torque_limit: largest torque that a servo adds [N·m]; None takes the file's.

    Raises:
        InvalidValue: a number that is not finite or has the wrong sign, or both kinds of gain.
        WrongLength: a vector that does not fit the robot.
    """
    springs = np.full(robot.n, np.inf)
    if joint_stiffness is not None:
        springs = per_joint(robot, "joint_stiffness", joint_stiffness, np.inf)
        _require(springs > 0, "joint_stiffness", "must be greater than 0 N·m/rad", springs)
    rotors = _rotors(robot, rotor_inertia, gear_ratio)
    if position_gain is not None and computed_torque_gain is not None:
        raise InvalidValue("computed_torque_gain", "excludes position_gain; give one of them")
    gains = per_joint(robot, "position_gain", 0.0 if position_gain is None else position_gain)
    _require(np.isfinite(gains) & (gains >= 0), "position_gain", "must be finite and ≥ 0", gains)
    if computed_torque_gain is not None and not 0 <= computed_torque_gain < np.inf:
        raise InvalidValue("computed_torque_gain", "must be finite and ≥ 0")
    damping = per_joint(robot, "damping_gain", 0.0 if damping_gain is None else damping_gain)
    _require(
        np.isfinite(damping) & (damping >= 0), "damping_gain", "must be finite and ≥ 0", damping
    )
    limits = per_joint(
        robot,
        "torque_limit",
        robot.torque_limits if torque_limit is None else torque_limit,
        robot.torque_limits,
    )
    _require(limits > 0, "torque_limit", "must be greater than 0 N·m", limits)
    elastic = springs < RIGID_FROM
    return Drives(
        ca.DM(rotors),
        ca.DM(np.where(elastic, springs, 0.0)),
        tuple(bool(e) for e in elastic),
        ca.DM(np.where(robot.actuated, gains, 0.0)),
        computed_torque_gain,
        ca.DM(np.where(robot.actuated, damping, 0.0)),
        limits,
        _known(robot, rotors, rotor_inertia is not None),
    )


def _known(robot: Robot, rotors: Array, given: bool) -> tuple[bool, ...]:
    """Return whether each joint's rotor inertia is known: stated, or there is no motor."""
    known = (rotors > 0) | given | robot.rotors_stated | ~np.array(robot.actuated)
    return tuple(bool(is_known) for is_known in known)


def _rotors(robot: Robot, rotor_inertia: PerJoint | None, gear_ratio: PerJoint | None) -> Array:
    given = robot.armature if rotor_inertia is None else rotor_inertia
    rotors = per_joint(robot, "rotor_inertia", given, robot.armature)
    _require(np.isfinite(rotors) & (rotors >= 0), "rotor_inertia", "must be finite and ≥ 0", rotors)
    if gear_ratio is None:
        return rotors
    if rotor_inertia is None:
        raise InvalidValue("gear_ratio", "needs rotor_inertia, the motors' own inertias")
    ratio = per_joint(robot, "gear_ratio", gear_ratio, 1.0)
    _require(np.isfinite(ratio) & (ratio != 0), "gear_ratio", "must be finite and not 0", ratio)
    return np.asarray(rotors * ratio**2)


def require_rotors(drives: Drives, names: Sequence[str], driven: Sequence[bool] = ()) -> None:
    """Raise InvalidValue if the numbers have no rotor inertia at an elastic joint.

    Motors that keep their speed need none; all others do.

    Args:
        drives: numbers, or symbols of which nothing is known.
        names: of the joints.
        driven: whether each joint's motor keeps its speed; none does unless given.
    """
    if not isinstance(drives.rotors, ca.DM):
        return
    rotors, led = np.array(drives.rotors).ravel(), driven or [False] * len(names)
    for name, is_elastic, is_led, rotor in zip(names, drives.elastic, led, rotors, strict=True):
        if is_elastic and not is_led and rotor == 0:
            raise InvalidValue(
                "rotor_inertia",
                f"joint '{name}' is elastic, so its rotor needs an inertia greater than 0, unless "
                "it has a motor that is driven",
            )


def per_joint(
    robot: Robot, field: str, values: PerJoint | ArrayLike, of_followers: float | Array = 0.0
) -> Array:
    """Return one number a joint from one number or a vector; raises WrongLength, InvalidValue.

    Joints that follow others by a coupling have no drive of their own: one number is not theirs,
    and a vector may leave them out.

    Args:
        robot: whose joints they are.
        field: what the values are, for messages.
        values: one number, or one for each joint, with or without those that follow.
        of_followers: what joints that follow get.
    """
    array = np.asarray(values, dtype=float)
    if np.isnan(array).any():
        raise InvalidValue(field, "must not be NaN")
    own = np.array([name not in robot.followers for name in robot.joint_names], dtype=bool)
    if array.ndim == 1 and (own.all() or len(array) != own.sum()):
        return robot.vector(field, array)
    if array.ndim > 1:
        return robot.vector(field, array)
    found = np.broadcast_to(np.asarray(of_followers, dtype=float), robot.n).copy()
    found[own] = array
    return found


def _require(holds: NDArray[np.bool_], field: str, reason: str, values: Array) -> None:
    if not np.all(holds):
        index = int(np.argmin(holds))
        raise InvalidValue(field, f"{reason}, but entry {index + 1} is {values[index]:g}")
