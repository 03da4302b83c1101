# SPDX-License-Identifier: BSD-3-Clause
"""Many impacts of a package at once: what it answers, and what is right by the tests' integrator."""

from __future__ import annotations

import ctypes
import math
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from compiled_packages import KINDS, Generated, run, tool
from numpy.typing import NDArray
from sharing import once

from softimpact.codegen.inputs import is_elastic
from softimpact.symbolic import Drives, closed_chain, impact_model
from softimpact.symbolic.robot.rigid import Array

OK, OUT_OF_RANGE, SINGULAR, UNRESOLVED, BOUNDED = 0, 4, 5, 8, 9
BRACKET, FREE, DRIVEN, SERVO = range(4)
LOOSE_ALONE, LED_FIRST = 1, 2
"""What the integrator integrates; see ``oracle.c``."""

SOURCE = Path(__file__).with_name("oracle.c")
TOLERANCE = 5e-4
"""Bend of the force over a step of the integrator, over the largest force."""

NOWHERE = 2e-3
"""Share of 1 m/s that is missing along n where motors cannot move the contact point that way."""


@dataclass(frozen=True, eq=False)
class Cases:
    """Inputs of safe speeds, one a row; ``mass`` is 0 where the body is held."""

    q: Array
    n: Array
    springs: Array
    rotors: Array
    gains: Array
    damping_gains: Array
    motors: NDArray[np.int32]
    steps: NDArray[np.int32]
    reaction: Array
    horizon: Array
    stiffness: Array
    damping: Array
    mass: Array
    skin: Array
    limit: Array

    def __len__(self) -> int:
        """Return the number of inputs."""
        return len(self.limit)

    def take(self, rows: Any) -> Cases:
        """Return some of them: by numbers, a mask or a slice."""
        return Cases(**{f.name: getattr(self, f.name)[rows] for f in fields(self)})

    def rounded(self) -> Cases:
        """Return them exact in float, so that both builds and the integrator read the same."""
        return Cases(
            **{
                name: x.astype(np.float32).astype(float) if x.dtype == float else x
                for name, x in vars(self).items()
            }
        )

    def row(self, k: int) -> dict[str, Any]:
        """Return one input, as it is printed."""
        return {name: x[k].tolist() for name, x in vars(self).items()}


def joined(parts: list[Cases]) -> Cases:
    """Return all inputs of some in one."""
    return Cases(
        **{f.name: np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Cases)}
    )


class Robot:
    """A package, compiled, and what its impacts should be."""

    def __init__(self, package: Generated, folder: Path) -> None:
        self.package, self.folder = package, folder
        robot = package.robot
        self.elastic = is_elastic(robot)
        self.joints = robot.n
        q, rotors = ca.SX.sym("q", robot.n), ca.SX.sym("B", robot.n)
        beside = ca.SX.zeros(robot.n) if self.elastic else rotors
        zero = ca.DM.zeros(robot.n)
        known = Drives(beside, zero, (False,) * robot.n, zero)
        model = impact_model(robot, package.tip, drives=known, gravity=package.manifest.gravity)
        self.independent = list(closed_chain(robot).independent)
        self.actuated = np.array(model.actuated, dtype=bool)
        self.n = len(self.actuated)
        M, K = model.generalised_mass(q).matrix, ca.SX(model.potential_stiffness(q))
        parts = [ca.densify(ca.SX(x)) for x in (M, K, model.jacobian(q))]
        self.model = ca.Function("model", [q, rotors], parts)
        self.lower, self.upper = (np.clip(x, -math.pi, math.pi) for x in robot.limits)

    @cached_property
    def oracle(self) -> ctypes.CDLL:
        """The tests' integrator."""
        flags = ("-std=c99", "-O3", "-march=native", "-Wall", "-Wextra", "-Wconversion", "-Werror")
        out = self.folder / "oracle.so"
        once(out, lambda path: run(tool("gcc"), *flags, "-shared", "-fPIC", SOURCE, "-o", path,
                                   "-lm"))  # fmt: skip
        library = ctypes.CDLL(str(out))
        library.largest_forces.restype = ctypes.c_long
        return library

    def links_at(self, q: Array, rotors: Array) -> tuple[Array, Array, Array]:
        """Return masses, potentials' curvatures and Jacobians over the independent joints."""
        count, n = len(q), self.n
        found = self.model.map(count)(q.T, rotors.T)
        M, K, J = (np.array(x).reshape(-1, count, n).swapaxes(0, 1) for x in found)
        return M, K, J

    def answers(self, function: str, cases: Cases, numbers: Array, real: str) -> tuple[Any, Array]:
        """Return statuses and results of ``peak_force`` at speeds or ``safe_speed`` for limits."""
        kind = KINDS[real][1]
        count, interface = len(cases), self.package.interface
        p = np.zeros(count, interface.dtype("params", real))
        p["layout"] = interface.layout_in(real)
        names = {"joint_stiffness": "springs", "rotor_inertia": "rotors", "position_gain": "gains"}
        for field in p.dtype.names or ():
            name = names.get(field, {"damping_gain": "damping_gains"}.get(field, field))
            name = {"reaction_time": "reaction"}.get(name, name)
            if hasattr(cases, name):
                p[field] = getattr(cases, name)
        region = np.zeros(count, interface.dtype("region", real))
        region["stiffness"], region["damping"] = cases.stiffness, cases.damping
        region["effective_mass"] = np.where(cases.mass > 0, cases.mass, 1)
        region["hertz_stiffness"] = cases.skin
        region["clamped"] = cases.mass == 0
        out = np.full(count, np.nan, interface.dtype(f"{function}_t", real))
        arrays = [np.ascontiguousarray(x, kind) for x in (cases.q, cases.n, numbers)]
        status = np.full(count, -1, np.int32)
        sizes = [self.joints, *(x.dtype.itemsize for x in (region, p, out))]
        addresses = [x.ctypes.data for x in (*arrays, region, p, out, status)]
        table = np.array([*addresses, *sizes], np.int64)
        library = self.package.load(real).library
        entry = getattr(library, f"{self.package.manifest.name}_{function}")
        call = getattr(self.oracle, f"call_{real}")
        call(entry, ctypes.c_long(count), ctypes.c_void_p(table.ctypes.data))
        return status, np.array(out[out.dtype.names[0]], float)  # type: ignore[index]

    def forces(self, cases: Cases, speeds: Array, finer: float = 1.0) -> Array:
        """Return the largest force [N] of each case at each of its speeds.

        It is infinite where motors cannot move the contact point along n: such poses are singular,
        and have no safe speed.

        Args:
            cases: impacts.
            speeds: some for each case [m/s].
            finer: by what steps are shorter; at 1 errors are below 2e-4.
        """
        count, n = len(cases), self.n
        size = 2 * n if self.elastic else n
        M, P, J = self.links_at(cases.q, cases.rotors)
        along = cases.n / np.linalg.norm(cases.n, axis=1, keepdims=True)
        row = np.einsum("ki,kij->kj", along, J)
        rates = np.einsum("kij,kj->ki", np.linalg.pinv(J * self.actuated, rcond=1e-9), along)
        pull = np.einsum("kij,kj->ki", P, rates)
        nowhere = abs((row * rates).sum(axis=1) - 1) > NOWHERE
        # those that driven motors do not hold come first
        order = np.arange(n) if self.elastic else np.argsort(self.actuated, kind="stable")
        held = n if self.elastic else int(self.actuated.sum())
        M, P = (x[:, order][:, :, order] for x in (M, P))
        row, pull = row[:, order], pull[:, order]
        gains, damping = (
            (x[:, self.independent] * self.actuated)[:, order]
            for x in (cases.gains, cases.damping_gains)
        )
        to_units = np.zeros((count, size, size))
        to_units[:, :n, :n] = np.linalg.inv(np.linalg.cholesky(M))
        stiff, servo, damp = (np.zeros((count, size, size)) for _ in range(3))
        stiff[:, :n, :n] = P
        first = np.arange(n)
        motors = first + size - n
        if self.elastic:
            to_units[:, motors, motors] = cases.rotors**-0.5
            for i, j, sign in ((0, 0, 1), (0, n, -1), (n, 0, -1), (n, n, 1)):
                stiff[:, first + i, first + j] += sign * cases.springs
        servo[:, motors, motors] = gains
        damp[:, motors, motors] = damping

        def units(x: Array) -> Array:
            return np.asarray(to_units @ x @ to_units.swapaxes(1, 2))

        full = [np.pad(x, ((0, 0), (0, size - n))) for x in (row, pull)]
        row, pull = (np.einsum("kij,kj->ki", to_units, x) for x in full)
        K, K_servo, D = units(stiff), units(stiff + servo), units(damp)
        is_servo = (cases.motors == SERVO)[:, None, None]
        led = np.where(is_servo, K_servo, K)
        led_damping, none = np.where(is_servo, D, 0.0), np.zeros((size, size))
        led_size = np.where(cases.motors == SERVO, size, size - held)
        light = np.where(cases.mass > 0, 1 / np.where(cases.mass > 0, cases.mass, 1), 0)
        mobility = (row**2).sum(axis=1) + light
        runs = np.array([LOOSE_ALONE | LED_FIRST, LOOSE_ALONE, LED_FIRST, LED_FIRST])
        skin = 1.5 * (cases.skin**2 * 3 * cases.limit) ** (1 / 3)
        contact = np.sqrt(np.maximum(mobility, 1e-12) * skin)
        impacts = np.zeros(count, IMPACT)

        def rows(x: Array) -> Any:
            return x.ctypes.data + np.arange(count) * x.strides[0]

        kept = [np.ascontiguousarray(x) for x in (led, led_damping, K, row, pull)]
        places = [rows(x) for x in kept]
        impacts["led"] = np.stack([places[0], places[1], places[3], places[4]], axis=1)
        impacts["loose"] = np.stack(
            [places[2], np.full(count, none.ctypes.data), places[3], places[4]], axis=1
        )
        impacts["led_size"] = np.stack([led_size, np.full(count, size)], axis=1)
        impacts["loose_size"] = size
        impacts["runs"] = runs[cases.motors]
        at_once = (cases.reaction == 0) & (cases.motors != FREE)
        impacts["runs"] = np.where(at_once, LOOSE_ALONE, impacts["runs"])
        impacts["release"], impacts["horizon"] = cases.reaction, cases.horizon
        for name in ("stiffness", "damping", "mass", "skin"):
            impacts[name] = getattr(cases, name)
        impacts["scale"], impacts["tolerance"] = 0.1 * cases.limit, TOLERANCE / finer**2
        impacts["longest"] = np.minimum(1e-4 / finer, cases.horizon / 100)
        impacts["shortest"] = np.minimum(np.minimum(5e-7, 0.01 / contact), impacts["longest"])
        speeds = np.ascontiguousarray(speeds, float)
        out = np.zeros_like(speeds)
        self.integrated = self.oracle.largest_forces(
            ctypes.c_long(count), ctypes.c_void_p(impacts.ctypes.data),
            ctypes.c_long(speeds.shape[1]), ctypes.c_void_p(speeds.ctypes.data),
            ctypes.c_void_p(out.ctypes.data),
        )  # fmt: skip
        out[nowhere] = np.inf
        return out


IMPACT = np.dtype(
    [
        *(("led", np.int64, 4), ("led_size", np.int64, 2)),
        *(("loose", np.int64, 4), ("loose_size", np.int64, 2)),
        ("runs", np.int64),
        *((name, float) for name in (
            "release", "horizon", "stiffness", "damping", "mass", "skin", "scale", "tolerance",
            "longest", "shortest")),
    ]
)  # fmt: skip
"""An impact as ``oracle.c`` reads it."""
