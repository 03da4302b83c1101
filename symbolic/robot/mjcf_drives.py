# SPDX-License-Identifier: BSD-3-Clause
"""What an MJCF file says of motors and tendons, as numbers at its joints."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import mujoco
import numpy as np

from .constraints import Tendon, Through
from .mjcf_paths import joints_under_motor, joints_under_tendon, names_of
from .rigid import Array

ON_JOINT = {int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT)}
ON_TENDON = int(mujoco.mjtTrn.mjTRN_TENDON)

FIXED, AFFINE, PLAIN_BIAS = (
    int(mujoco.mjtGain.mjGAIN_FIXED),
    int(mujoco.mjtBias.mjBIAS_AFFINE),
    int(mujoco.mjtBias.mjBIAS_NONE),
)


@dataclass(frozen=True)
class Drive:
    """What motors and tendons add at one joint; units as in ``Joint``."""

    actuated: bool = False
    armature: float = 0.0
    damping: float = 0.0
    friction: float = 0.0
    spring: float = 0.0
    spring_reference: float = 0.0
    position_gain: float = 0.0
    velocity_gain: float = 0.0
    torque_limit: float = np.inf


@dataclass
class Actuation:
    """Drives by joint, and tendons that act on several joints at once.

    Attributes:
        through: what acts on joints through space.
        named: whether the file names motors at all; one that does not has them everywhere.
    """

    drives: dict[int, Drive] = field(default_factory=dict)
    tendons: tuple[Tendon, ...] = ()
    through: list[Through] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    named: bool = False

    def of_joint(self, joint: int) -> Drive:
        """Return what acts on a joint."""
        drive = self.drives.get(joint, Drive())
        return drive if self.named else replace(drive, actuated=True)


def actuation_of(model: mujoco.MjModel) -> Actuation:
    """Read actuators and fixed tendons of a compiled model."""
    motors = Actuation()
    fixed = {i: terms for i in range(model.ntendon) if (terms := fixed_terms(model, i))}
    shared: dict[int, float] = {}  # inertia of motors on tendons of several joints
    limits: dict[int, list[float]] = {}
    for i in range(model.nu):
        name = str(model.actuator(i).name) or f"actuator{i + 1}"
        kind, target = int(model.actuator_trntype[i]), int(model.actuator_trnid[i, 0])
        if kind in ON_JOINT:
            terms = [(target, 1.0)]
        elif kind == ON_TENDON and target in fixed:
            terms = fixed[target]
        else:
            _add_motor_through_space(motors, model, i, name, limits)
            continue
        motors.named = True
        _add_motor(motors, model, i, name, terms, limits)
        if len(terms) > 1:
            shared[target] = shared.get(target, 0.0) + _armature(model, i)
    for joint, values in limits.items():
        motors.drives[joint] = replace(motors.drives[joint], torque_limit=sum(values) or np.inf)
    _limit_joints(motors, model)
    motors.tendons = tuple(_tendons(motors, model, fixed, shared))
    return motors


def fixed_terms(model: mujoco.MjModel, tendon: int) -> list[tuple[int, float]]:
    """Return joints and coefficients of a fixed tendon; nothing for a spatial one."""
    first, count = int(model.tendon_adr[tendon]), int(model.tendon_num[tendon])
    wraps = range(first, first + count)
    if any(int(model.wrap_type[w]) != int(mujoco.mjtWrap.mjWRAP_JOINT) for w in wraps):
        return []
    terms: dict[int, float] = {}
    for w in wraps:
        joint = int(model.wrap_objid[w])
        terms[joint] = terms.get(joint, 0.0) + float(model.wrap_prm[w])
    return [(joint, weight) for joint, weight in terms.items() if weight]


def _gear(model: mujoco.MjModel, actuator: int) -> float:
    return float(model.actuator_gear[actuator, 0])


def _armature(model: mujoco.MjModel, actuator: int) -> float:
    """Inertia of a motor seen from what it acts on: armature × gear²."""
    own = getattr(model, "actuator_armature", np.zeros(model.nu))
    return float(np.ravel(own)[actuator]) * _gear(model, actuator) * _gear(model, actuator)


def _damping(model: mujoco.MjModel, actuator: int) -> float:
    own = getattr(model, "actuator_damping", np.zeros(model.nu))
    return float(np.ravel(own)[actuator]) * _gear(model, actuator) * _gear(model, actuator)


def _add_motor(
    motors: Actuation,
    model: mujoco.MjModel,
    i: int,
    name: str,
    terms: list[tuple[int, float]],
    limits: dict[int, list[float]],
) -> None:
    gear = _gear(model, i)
    position, velocity = _servo(motors, model, i, name)
    if len(terms) > 1:
        joints = ", ".join(f"'{model.joint(j).name or f'joint{j + 1}'}'" for j, _ in terms)
        motors.warnings.append(
            f"motor '{name}' drives {joints} together through a tendon: "
            "each counts as having a motor of its own"
        )
    force = _force_limit(model, i)
    for joint, weight in terms:
        ratio = gear * weight
        before = motors.drives.get(joint, Drive())
        alone = len(terms) == 1
        motors.drives[joint] = replace(
            before,
            actuated=True,
            armature=before.armature + (_armature(model, i) * (weight * weight) if alone else 0.0),
            damping=before.damping + _damping(model, i) * (weight * weight),
            position_gain=before.position_gain + position * (ratio * ratio),
            velocity_gain=before.velocity_gain + velocity * (ratio * ratio),
        )
        limits.setdefault(joint, []).append(force * abs(ratio) if ratio else 0.0)


def _add_motor_through_space(
    motors: Actuation,
    model: mujoco.MjModel,
    i: int,
    name: str,
    limits: dict[int, list[float]],
) -> None:
    """Give each joint that it may move a motor of which nothing else is known."""
    moved = joints_under_motor(model, i)
    if not moved:
        motors.warnings.append(f"motor '{name}' moves no joint: ignored")
        return
    motors.named = True
    names = tuple(n for joint in moved for n in names_of(model, joint))
    motors.warnings.append(
        f"motor '{name}' acts through space on {', '.join(f'{n!r}' for n in names)}: each counts "
        "as having a motor, of unknown rotor, gains and torque"
    )
    if _armature(model, i):
        motors.through.append(Through(name, names, f"the rotor of motor '{name}'"))
    for joint in moved:
        motors.drives[joint] = replace(motors.drives.get(joint, Drive()), actuated=True)
        limits.setdefault(joint, []).append(np.inf)


def _servo(motors: Actuation, model: mujoco.MjModel, i: int, name: str) -> tuple[float, float]:
    """K_p and K_d of a motor whose force is −K_p length − K_d velocity and what is commanded."""
    kind, gain = int(model.actuator_biastype[i]), int(model.actuator_gaintype[i])
    if kind == PLAIN_BIAS and gain == FIXED:
        return 0.0, 0.0
    if kind != AFFINE or gain != FIXED:
        motors.warnings.append(f"the law of motor '{name}' is not that of a servo: not read")
        return 0.0, 0.0
    bias = model.actuator_biasprm[i]
    position, velocity = max(0.0, -float(bias[1])), -float(bias[2])
    if velocity < 0:  # before MuJoCo turns it into a damping, it is a ratio
        motors.warnings.append(f"the damping ratio of motor '{name}' is not read")
        velocity = 0.0
    return position, velocity


def _force_limit(model: mujoco.MjModel, i: int) -> float:
    limit = np.inf
    if model.actuator_forcelimited[i]:
        limit = float(abs(model.actuator_forcerange[i]).max())
    plain = int(model.actuator_gaintype[i]) == FIXED
    plain = plain and int(model.actuator_biastype[i]) == PLAIN_BIAS
    direct = int(model.actuator_dyntype[i]) == int(mujoco.mjtDyn.mjDYN_NONE)
    if plain and direct and model.actuator_ctrllimited[i]:
        command = float(abs(np.ravel(model.actuator_ctrlrange[i])).max())
        limit = min(limit, command * abs(float(model.actuator_gainprm[i, 0])))
    return limit


def _limit_joints(motors: Actuation, model: mujoco.MjModel) -> None:
    for joint in range(model.njnt):
        if model.jnt_actfrclimited[joint]:
            limit = float(abs(model.jnt_actfrcrange[joint]).max())
            drive = motors.drives.get(joint, Drive())
            limit = min(limit or np.inf, drive.torque_limit)  # a limit of 0 is none
            motors.drives[joint] = replace(drive, torque_limit=limit)


def _tendons(
    motors: Actuation,
    model: mujoco.MjModel,
    fixed: dict[int, list[tuple[int, float]]],
    shared: dict[int, float],
) -> Iterator[Tendon]:
    """Hand what a tendon does to its joint, or yield it where there are several."""
    for i in range(model.ntendon):
        name = str(model.tendon(i).name) or f"tendon{i + 1}"
        number = _numbers(model, i)
        low, high = (float(x) for x in model.tendon_lengthspring[i])
        if number("stiffness") and low != high:
            motors.warnings.append(
                f"the spring of tendon '{name}' has a slack range: it counts as always taut"
            )
        spring = number("stiffness")
        if number("stiffnesspoly") or number("springyield"):
            motors.warnings.append(f"the spring of tendon '{name}' counts in its linear part only")
        armature = number("armature") + shared.get(i, 0.0)
        terms = fixed.get(i)
        if terms is None:
            _add_through_space(motors, model, i, name, number)
            continue
        rest = (low + high) / 2 - _length(model, terms, model.qpos0, float(model.tendon_length0[i]))
        if len(terms) > 1:
            if number("damping") or number("frictionloss"):
                motors.warnings.append(
                    f"damping and friction of tendon '{name}' over several joints do not count"
                )
            if armature or spring:
                named = tuple((str(model.joint(j).name) or f"joint{j + 1}", c) for j, c in terms)
                yield Tendon(name, named, armature, spring, rest)
            continue
        ((joint, weight),) = terms
        before = motors.drives.get(joint, Drive())
        motors.drives[joint] = replace(
            before,
            armature=before.armature + armature * (weight * weight),
            damping=before.damping + number("damping") * (weight * weight),
            friction=before.friction + number("frictionloss") * abs(weight),
            spring=before.spring + spring * (weight * weight),
            spring_reference=rest / weight,
        )


def _add_through_space(
    motors: Actuation, model: mujoco.MjModel, i: int, name: str, number: Callable[[str], float]
) -> None:
    """Note a tendon through space that would bind or load joints; motors on it are motors'."""
    if number("damping") or number("frictionloss"):
        motors.warnings.append(
            f"tendon '{name}' runs through space: its damping and friction do not count"
        )
    parts = [w for field, w in (("stiffness", "spring"), ("armature", "inertia")) if number(field)]
    crossed = joints_under_tendon(model, i)
    if parts and crossed:
        names = tuple(n for joint in crossed for n in names_of(model, joint))
        motors.through.append(Through(name, names, f"the {' and '.join(parts)} of tendon '{name}'"))


def _numbers(model: mujoco.MjModel, tendon: int) -> Callable[[str], float]:
    """Read fields of a tendon, zero where this MuJoCo does not have them."""

    def number(name: str) -> float:
        values = getattr(model, f"tendon_{name}", None)
        return 0.0 if values is None else float(abs(np.ravel(values[tendon])).max(initial=0.0))

    return number


def _length(model: mujoco.MjModel, terms: list[tuple[int, float]], q: Array, known: float) -> float:
    """How much longer MuJoCo takes a tendon to be than Σ cᵢ qᵢ."""
    ours = sum(weight * float(q[model.jnt_qposadr[joint]]) for joint, weight in terms)
    return known - ours
