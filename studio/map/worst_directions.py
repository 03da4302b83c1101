# SPDX-License-Identifier: BSD-3-Clause
"""Directions in which a robot may go least fast, found by its C package at many postures."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from softimpact.batch import compiled
from softimpact.codegen.inputs.directions import directions_of_motion
from softimpact.codegen.inputs.parameters import is_elastic
from softimpact.symbolic import Contact, ImpactModel, InvalidValue, Motors, limits_of
from softimpact.symbolic.robot.rigid import Array

AROUND = 80
"""Directions that are looked at, over half a ball; forces are the same both ways."""

FLAT = 36
"""The same over half a circle, for robots whose tip moves in a plane."""

ROUNDS = 4
"""Times that the neighbourhood of the worst is looked at, each half as wide as the one before."""

NEIGHBOURS = 6

RIGID = 1e7
"""Stiffness [N·m/rad] that stands for a rigid joint while directions are compared."""

ANY_ROTOR = 1.0
"""Inertia [kg m²] that stands in where none is known; driven motors do not read it."""

NOTHING = 1e-9
"""Way of the tip by a turn of a joint [m] that counts as none."""

NEVER = 1e3
"""Reaction time [s] of motors that are not released within any horizon."""


def worst_directions(
    model: ImpactModel,
    q: Array,
    body: Contact,
    ends: Mapping[str, Motors],
    seen: Callable[[int], None] = lambda count: None,
) -> tuple[Array, Array]:
    """Return for each posture the direction of the least safe speed, N×3, and that speed [m/s].

    Directions do not count in which the joints' speed limits keep the tip slower than that. The
    speeds are the C package's, which looks at the transient limit alone; infinite where the tip
    moves in no direction.

    Args:
        model: the robot.
        q: postures, N×n.
        body: that is hit.
        ends: what the motors may do.
        seen: called with the number of impacts that were looked at.

    Raises:
        NoCompiler: there is none.
        InvalidValue: the robot has no such directions of its own.
    """
    basis = directions_of_motion(model)
    if basis is None or model.robot.loops:
        raise InvalidValue("direction", "needs to be given for this robot")
    ask = _asker(model, body, ends, seen)
    J = np.array([np.array(model.jacobian(row), dtype=float) for row in q])
    most = np.array(model.robot.speed_limits)

    def least(tried: Array) -> tuple[Array, Array]:
        """Return the worst of some directions at each posture, N×k×3."""
        flat = tried.reshape(-1, 3)
        safe = ask(np.repeat(q, tried.shape[1], axis=0), flat).reshape(tried.shape[:2])
        along = abs(np.einsum("skx,sxi->ski", tried, J))
        felt = np.where(along > NOTHING, most, 0.0)  # inf where no limit is known
        reach = (along * felt).sum(axis=2)
        speeds = np.where(np.isnan(safe) | (safe > reach), np.inf, safe)
        rows, best = np.arange(len(q)), speeds.argmin(axis=1)
        return tried[rows, best], speeds[rows, best]

    directions, speeds = least(np.tile(_spread(basis), (len(q), 1, 1)))
    wide = 1.2 * math.pi / math.sqrt(2 * (AROUND if len(basis) > 2 else FLAT))
    for _ in range(ROUNDS if len(basis) > 1 else 0):
        around, found = least(_neighbours(directions, basis, wide))
        better = found < speeds
        directions[better], speeds[better] = around[better], found[better]
        wide /= 2
    return directions, speeds


def _asker(
    model: ImpactModel,
    body: Contact,
    ends: Mapping[str, Motors],
    seen: Callable[[int], None],
) -> Callable[[Array, Array], Array]:
    package = compiled(model.robot)
    region = body.region
    numbers = {
        "stiffness": region.stiffness,
        "damping": region.damping,
        "effective_mass": region.effective_mass,
        "hertz_stiffness": body.series_stiffness,
    }
    how = {**_numbers(model), **_motors(ends)}
    limit = limits_of(region, body.clamped).transient.force

    def ask(q: Array, n: Array) -> Array:
        found = package.safe_speed(q, n, limit, region=numbers, clamped=body.clamped, **how)
        seen(len(q))
        return np.asarray(found["speed"])

    return ask


def _numbers(model: ImpactModel) -> dict[str, Array]:
    """Return the drives as C takes them: finite springs, rotors that are not zero."""
    drives = model.drives
    rotors = np.array(drives.rotors, dtype=float).ravel()
    gains = np.array(drives.gains, dtype=float).ravel()
    damping = drives.damping_gains
    found = {
        "rotor_inertia": np.where(rotors > 0, rotors, ANY_ROTOR),
        "position_gain": gains,
        "damping_gain": np.zeros(model.robot.n)
        if damping is None
        else np.array(damping, dtype=float).ravel(),
    }
    if is_elastic(model.robot):
        springs = np.array(drives.springs, dtype=float).ravel()
        soft = np.array(drives.elastic) & np.isfinite(springs)
        found["joint_stiffness"] = np.where(soft, springs, RIGID)
    return found


def _motors(ends: Mapping[str, Motors]) -> dict[str, str | float]:
    (first, *_) = ends.values()
    kind = "free_or_driven" if len(ends) > 1 else first.kind
    reaction = first.reaction_time if np.isfinite(first.reaction_time) else NEVER
    return {"motors": kind, "reaction_time": reaction}


def _spread(basis: Array) -> Array:
    """Return directions all over what motors can do, half of them as the others are the same."""
    if len(basis) == 1:
        return basis
    if len(basis) == 2:
        angle = np.pi * np.arange(FLAT) / FLAT
        return np.asarray(np.column_stack([np.cos(angle), np.sin(angle)]) @ basis)
    z = (np.arange(AROUND) + 0.5) / AROUND
    turn = np.arange(AROUND) * np.pi * (3 - np.sqrt(5))  # golden angle
    flat = np.sqrt(1 - z**2)
    axes = np.eye(3)
    return np.vstack([axes, np.column_stack([flat * np.cos(turn), flat * np.sin(turn), z])]) @ basis


def _neighbours(directions: Array, basis: Array, wide: float) -> Array:
    """Return directions around each, some angle away, N×k×3."""
    if len(basis) == 2:
        across = directions @ basis.T @ np.array([[0.0, 1.0], [-1.0, 0.0]]) @ basis
        sides = [math.cos(a) * directions + math.sin(a) * across for a in (wide, -wide)]
        return np.stack(sides, axis=1)
    other = np.where(abs(directions[:, [2]]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    first = np.cross(directions, other)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(directions, first)
    sides = []
    for k in range(NEIGHBOURS):
        turn = 2 * math.pi * k / NEIGHBOURS
        aside = math.cos(turn) * first + math.sin(turn) * second
        sides.append(math.cos(wide) * directions + math.sin(wide) * aside)
    return np.stack(sides, axis=1)
