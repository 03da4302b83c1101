# SPDX-License-Identifier: BSD-3-Clause
"""Which joints MJCF's tendons and motors through space act on."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import mujoco

BALL = int(mujoco.mjtJoint.mjJNT_BALL)

SITE, *SHAPES = (
    int(getattr(mujoco.mjtWrap, f"mjWRAP_{kind}")) for kind in ("SITE", "SPHERE", "CYLINDER")
)

EACH_AXIS = (("x", (1.0, 0.0, 0.0)), ("y", (0.0, 1.0, 0.0)), ("z", (0.0, 0.0, 1.0)))
"""Names and axes of the three hinges that stand for a ball joint."""


def joints_under_tendon(model: mujoco.MjModel, tendon: int) -> tuple[int, ...]:
    """Return the joints that a tendon through space crosses; it may pull on each."""
    first, count = int(model.tendon_adr[tendon]), int(model.tendon_num[tendon])
    bodies = [_body_of_wrap(model, w) for w in range(first, first + count)]
    crossed: set[int] = set()
    for one, other in pairwise(bodies):
        if one is not None and other is not None:
            crossed |= _joints_between(model, one, other)
    return tuple(sorted(crossed))


def joints_under_motor(model: mujoco.MjModel, actuator: int) -> tuple[int, ...]:
    """Return the joints that a motor on no joint and no fixed tendon may move."""
    kind = int(model.actuator_trntype[actuator])
    first, second = (int(x) for x in model.actuator_trnid[actuator, :2])
    if kind == int(mujoco.mjtTrn.mjTRN_TENDON):
        return joints_under_tendon(model, first)
    if kind in (int(mujoco.mjtTrn.mjTRN_SITE), int(mujoco.mjtTrn.mjTRN_SLIDERCRANK)):
        one = int(model.site_bodyid[first])
        other = int(model.site_bodyid[second]) if second >= 0 else 0
        return tuple(sorted(_joints_between(model, one, other)))
    return ()


def names_of(model: mujoco.MjModel, joint: int) -> tuple[str, ...]:
    """Return the names that a joint's hinges or slide go by here."""
    name = str(model.joint(joint).name) or f"joint{joint + 1}"
    if int(model.jnt_type[joint]) == BALL:
        return tuple(f"{name}_{axis}" for axis, _ in EACH_AXIS)
    return (name,)


def _body_of_wrap(model: mujoco.MjModel, wrap: int) -> int | None:
    kind, index = int(model.wrap_type[wrap]), int(model.wrap_objid[wrap])
    if kind == SITE:
        return int(model.site_bodyid[index])
    return int(model.geom_bodyid[index]) if kind in SHAPES else None


def _joints_between(model: mujoco.MjModel, one: int, other: int) -> set[int]:
    return set(_joints_to(model, one)) ^ set(_joints_to(model, other))


def _joints_to(model: mujoco.MjModel, body: int) -> Iterator[int]:
    while body > 0:
        first = int(model.body_jntadr[body])
        for joint in range(first, first + int(model.body_jntnum[body])):
            if int(model.jnt_type[joint]) != int(mujoco.mjtJoint.mjJNT_FREE):
                yield joint
        body = int(model.body_parentid[body])
