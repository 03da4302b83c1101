# SPDX-License-Identifier: BSD-3-Clause
"""MJCF's ``equality`` elements as loops, couplings and welds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import mujoco
import numpy as np

from .constraints import Constraint, Coupling, Loop, Terms, Through, Weld
from .mjcf_drives import fixed_terms
from .mjcf_paths import joints_under_tendon, names_of
from .rigid import Placement
from .robot import Frame

Namer = Callable[[int], str]
"""Returns the name of a compiled element."""

DEGREE = 5
"""Number of coefficients of a coupling's polynomial."""


@dataclass
class Ties:
    """Constraints, frames at their anchors (by index of body), and what else there was to say."""

    constraints: tuple[Constraint, ...] = ()
    anchors: list[Frame] = field(default_factory=list)
    followers: set[str] = field(default_factory=set)
    warnings: list[str] = field(default_factory=list)


def constraints_of(model: mujoco.MjModel, joint: Namer, site: Namer, body: Namer) -> Ties:
    """Read the active ``equality`` elements of a compiled model."""
    ties = Ties()
    found: list[Constraint] = []
    off = int(model.opt.disableflags) & int(mujoco.mjtDisableBit.mjDSBL_EQUALITY)
    if off and model.neq:
        ties.warnings.append("the file's options switch its equality constraints off")
    for i in range(0 if off else model.neq):
        if not model.eq_active0[i]:
            continue
        kind = int(model.eq_type[i])
        name = str(model.equality(i).name)
        if kind in (int(mujoco.mjtEq.mjEQ_CONNECT), int(mujoco.mjtEq.mjEQ_WELD)):
            ends = _ends(model, i, kind, ties, site, body)
            if kind == int(mujoco.mjtEq.mjEQ_CONNECT):
                found.append(Loop(name or f"loop{i + 1}", *ends))
            else:
                found.append(Weld(name or f"weld{i + 1}", *ends))
        elif kind == int(mujoco.mjtEq.mjEQ_JOINT):
            found.append(_joints(model, i, name or f"coupling{i + 1}", joint))
        elif kind == int(mujoco.mjtEq.mjEQ_TENDON):
            coupling = _tendons(model, i, name or f"coupling{i + 1}", joint)
            if coupling is None:
                found += _through(model, i, name or f"coupling{i + 1}")
            else:
                found.append(coupling)
        else:
            ties.warnings.append(f"equality '{name or i + 1}' of soft bodies: ignored")
    couplings = [c for c in found if isinstance(c, Coupling)]
    ties.followers = {c.follower for c in couplings if c.follower is not None}
    ties.constraints = tuple(found)
    return ties


def _ends(
    model: mujoco.MjModel, i: int, kind: int, ties: Ties, site: Namer, body: Namer
) -> tuple[str, str]:
    """Frames that a connect or weld ties: sites, or points of bodies."""
    ends = []
    weld = kind == int(mujoco.mjtEq.mjEQ_WELD)
    for index, anchor in (
        (int(model.eq_obj1id[i]), model.eq_data[i, 3:6] if weld else model.eq_data[i, :3]),
        (int(model.eq_obj2id[i]), model.eq_data[i, :3] if weld else model.eq_data[i, 3:6]),
    ):
        if int(model.eq_objtype[i]) == int(mujoco.mjtObj.mjOBJ_SITE):
            ends.append(site(index))
            continue
        point = ",".join(f"{round(x, 12) + 0.0:g}" for x in anchor)
        ends.append(f"{body(index)}@{point}")
        ties.anchors.append(Frame(ends[-1], index, Placement(np.eye(3), anchor)))
    return ends[0], ends[1]


def _joints(model: mujoco.MjModel, i: int, name: str, joint: Namer) -> Coupling:
    """q1 − q1_ref = p(q2 − q2_ref); without a second joint the first stands still."""
    first, second = int(model.eq_obj1id[i]), int(model.eq_obj2id[i])
    polynomial = tuple(float(x) for x in model.eq_data[i, :DEGREE])
    reference = model.qpos0[model.jnt_qposadr]
    if second < 0:
        return Coupling(name, ((joint(first), 1.0),), (), polynomial[:1], float(reference[first]))
    return Coupling(
        name,
        ((joint(first), 1.0),),
        ((joint(second), 1.0),),
        _trimmed(polynomial),
        float(reference[first]),
        float(reference[second]),
    )


def _tendons(model: mujoco.MjModel, i: int, name: str, joint: Namer) -> Coupling | None:
    """Lengths of two fixed tendons, from those at the reference on."""
    first, second = int(model.eq_obj1id[i]), int(model.eq_obj2id[i])
    left, left_reference = _terms(model, first, joint)
    right, right_reference = _terms(model, second, joint) if second >= 0 else ((), 0.0)
    if not left or (second >= 0 and not right):
        return None
    polynomial = tuple(float(x) for x in model.eq_data[i, :DEGREE])
    polynomial = _trimmed(polynomial) if second >= 0 else polynomial[:1]
    return Coupling(name, left, right, polynomial, left_reference, right_reference)


def _through(model: mujoco.MjModel, i: int, name: str) -> list[Constraint]:
    """Return an equation of tendons of which one at least runs through space."""
    joints: set[int] = set()
    for tendon in (int(model.eq_obj1id[i]), int(model.eq_obj2id[i])):
        if tendon >= 0:
            joints.update(joint for joint, _ in fixed_terms(model, tendon))
            joints.update(joints_under_tendon(model, tendon))
    names = tuple(n for joint in sorted(joints) for n in names_of(model, joint))
    return [Through(name, names, f"equality '{name}' of tendons")] if names else []


def _terms(model: mujoco.MjModel, tendon: int, joint: Namer) -> tuple[Terms, float]:
    terms = fixed_terms(model, tendon)
    length = sum(c * float(model.qpos0[model.jnt_qposadr[j]]) for j, c in terms)
    return tuple((joint(j), c) for j, c in terms), length


def _trimmed(polynomial: tuple[float, ...]) -> tuple[float, ...]:
    """Return a polynomial without zeros at its end."""
    count = len(polynomial)
    while count > 1 and polynomial[count - 1] == 0.0:
        count -= 1
    return polynomial[:count]
