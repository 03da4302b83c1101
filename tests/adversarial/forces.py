# SPDX-License-Identifier: BSD-3-Clause
"""Right forces of many impacts: the linear robot as matrices, and the tests' integrator."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np
from compiled_impacts import FREE, SERVO
from numpy.typing import NDArray

from softimpact.symbolic.robot.rigid import Array

from .cases import Cases
from .impacts import Robot
from .laws import laws

LOOSE_ALONE, LED_FIRST = 1, 2
"""What the integrator integrates; see ``oracle.h``."""

TOLERANCE = 5e-4
"""Bend of the force over a step of the integrator, over the largest force."""

LATE, UNTIL = 0.5, 0.6
"""From when on a body is pressed, and until when that is looked for at least [s]."""

NOWHERE = 2e-3
"""Share of 1 m/s that is missing along n where motors cannot move the contact point that way."""

IMPACT = np.dtype(
    [
        *(("led", np.int64, 4), ("led_size", np.int64, 2)),
        *(("loose", np.int64, 4), ("loose_size", np.int64, 2)),
        ("runs", np.int64),
        *((name, float) for name in (
            "release", "horizon", "counts", "late", "stiffness", "damping", "mass", "skin")),
        *((name, np.int64) for name in ("depths", "law", "points")),
        *((name, float) for name in ("scale", "tolerance", "longest", "shortest")),
        ("flies", np.int64),
    ]
)  # fmt: skip
"""An impact as ``oracle.h`` has it."""


@dataclass(frozen=True, eq=False)
class Linear:
    """Robots in coordinates of unit mass, those first that driven motors do not hold.

    Attributes:
        led: stiffness while motors drive or servo.
        led_damping: of the same, by the joints themselves and by the servo.
        led_size: coordinates that move then.
        loose: stiffness once motors are free.
        loose_damping: by the joints themselves.
        row: what the contact point moves with each coordinate.
        pull: of potentials on each as the motion before goes on, over v t.
        reached: 1 where motors move the contact point along n at 1 m/s.
        pulled: whether potentials pull, as gravity does.
    """

    led: Array
    led_damping: Array
    led_size: NDArray[np.int64]
    loose: Array
    loose_damping: Array
    row: Array
    pull: Array
    reached: Array
    pulled: NDArray[np.bool_]


def linear(robot: Robot, cases: Cases) -> Linear:
    """Return the linear robot of each case, over links and, where joints are elastic, motors."""
    count, n = len(cases), robot.n
    size = 2 * n if robot.elastic else n
    M, P, J = robot.links(cases)
    along = cases.n / np.linalg.norm(cases.n, axis=1, keepdims=True)
    row = np.einsum("ki,kij->kj", along, J)
    rates = np.einsum("kij,kj->ki", np.linalg.pinv(J * robot.actuated, rcond=1e-9), along)
    given = cases.dq[:, robot.independent]
    goes = np.einsum("kj,kj->k", row, given)
    moves = goes > 0
    rates[moves] = given[moves] / goes[moves, None]
    pull = np.einsum("kij,kj->ki", P, rates)
    reached = (row * rates).sum(axis=1)
    order = np.arange(n) if robot.elastic else np.argsort(robot.actuated, kind="stable")
    gains, damping = (
        (x[:, robot.independent] * robot.actuated)[:, order]
        for x in (cases.gains, cases.damping_gains)
    )
    stiff, servo, own, damp, to_units = (np.zeros((count, size, size)) for _ in range(5))
    links = np.arange(n)
    motors = links + size - n
    to_units[:, :n, :n] = np.linalg.inv(np.linalg.cholesky(M[:, order][:, :, order]))
    stiff[:, :n, :n] = P[:, order][:, :, order]
    if robot.elastic:
        to_units[:, motors, motors] = cases.rotors**-0.5
        for i, j, sign in ((0, 0, 1), (0, n, -1), (n, 0, -1), (n, n, 1)):
            stiff[:, links + i, links + j] += sign * cases.springs
    servo[:, motors, motors] = gains
    own[:, links, links] = robot.damping[order]
    damp[:, motors, motors] = damping
    K, K_servo, D, D_servo = (
        to_units @ x @ to_units.swapaxes(1, 2) for x in (stiff, stiff + servo, own, own + damp)
    )
    held = n if robot.elastic else int(robot.actuated.sum())
    is_servo = cases.motors == SERVO
    row, pull = (
        np.einsum("kij,kj->ki", to_units, np.pad(x[:, order], ((0, 0), (0, size - n))))
        for x in (row, pull)
    )
    return Linear(
        led=np.where(is_servo[:, None, None], K_servo, K),
        led_damping=np.where(is_servo[:, None, None], D_servo, D),
        led_size=np.where(is_servo, size, size - held),
        loose=K,
        loose_damping=D,
        row=row,
        pull=pull,
        reached=reached,
        pulled=np.asarray(P.any(axis=(1, 2))),
    )


def forces(robot: Robot, cases: Cases, speeds: Array, finer: float = 1.0) -> Array:
    """Return the largest force [N] of each case at each of its speeds; see ``both_forces``."""
    return both_forces(robot, cases, speeds, finer, late=False)[0]


def both_forces(
    robot: Robot, cases: Cases, speeds: Array, finer: float = 1.0, *, late: bool = True
) -> tuple[Array, Array]:
    """Return the largest forces [N] of each case at each of its speeds, and those that press.

    They are infinite where motors cannot move the contact point along n: such poses are singular,
    and have no safe speed. What presses on a body that moves is 0.

    Args:
        robot: that hits.
        cases: impacts.
        speeds: some for each case [m/s].
        finer: by what steps are shorter; at 1 errors are below 2e-4.
        late: whether impacts are followed until what presses later is known, too.
    """
    of, count = linear(robot, cases), len(cases)
    size = of.row.shape[1]
    impacts = np.zeros(count, IMPACT)
    arrays = [
        np.ascontiguousarray(x)
        for x in (of.led, of.led_damping, of.loose, of.loose_damping, of.row, of.pull)
    ]
    led, led_damping, loose, loose_damping, row, pull = (_rows(x) for x in arrays)
    impacts["led"] = np.stack([led, led_damping, row, pull], axis=1)
    impacts["loose"] = np.stack([loose, loose_damping, row, pull], axis=1)
    impacts["led_size"] = np.stack([of.led_size, np.full(count, size)], axis=1)
    impacts["loose_size"], impacts["flies"] = size, ~of.pulled
    runs = np.array([LOOSE_ALONE | LED_FIRST, LOOSE_ALONE, LED_FIRST, LED_FIRST])[cases.motors]
    at_once = (cases.reaction == 0) & (cases.motors != FREE)
    impacts["runs"] = np.where(at_once, LOOSE_ALONE, runs)
    held = late & (cases.mass == 0)
    impacts["release"], impacts["counts"] = cases.reaction, cases.horizon
    impacts["horizon"] = np.where(held, np.maximum(cases.horizon, UNTIL), cases.horizon)
    impacts["late"] = np.where(held, LATE, np.inf)
    for name in ("stiffness", "damping", "mass", "skin"):
        impacts[name] = getattr(cases, name)
    laid = [(np.ascontiguousarray(law.depths), np.ascontiguousarray(law.forces)) for law in laws()]
    addresses = np.array([(0, 0, 0), *((d.ctypes.data, f.ctypes.data, len(d)) for d, f in laid)])
    for name, column in zip(("depths", "law", "points"), addresses.T, strict=True):
        impacts[name] = column[cases.law]
    impacts["scale"], impacts["tolerance"] = 0.1 * cases.limit, TOLERANCE / finer**2
    light = np.divide(1, cases.mass, out=np.zeros(count), where=cases.mass > 0)
    mobility = np.maximum((of.row**2).sum(axis=1) + light, 1e-12)
    skin = 1.5 * (cases.skin**2 * 3 * cases.limit) ** (1 / 3)
    for k in np.flatnonzero(cases.law):
        skin[k] = laws()[cases.law[k] - 1].stiffness(3 * cases.limit[k])
    impacts["longest"] = np.minimum(1e-4 / finer, cases.horizon / 100)
    shortest = np.minimum(5e-7, 0.01 / np.sqrt(mobility * skin))
    impacts["shortest"] = np.minimum(shortest, impacts["longest"])
    speeds = np.ascontiguousarray(speeds, float)
    out, pressed = np.zeros_like(speeds), np.zeros_like(speeds)
    robot.oracle.largest_forces(
        ctypes.c_long(count), ctypes.c_void_p(impacts.ctypes.data),
        ctypes.c_long(speeds.shape[1]), ctypes.c_void_p(speeds.ctypes.data),
        *(ctypes.c_void_p(x.ctypes.data) for x in (out, pressed)),
    )  # fmt: skip
    out[abs(of.reached - 1) > NOWHERE] = np.inf
    return out, pressed


def _rows(x: Array) -> Any:
    """Return the addresses of an array's rows."""
    return x.ctypes.data + np.arange(len(x)) * x.strides[0]
