# SPDX-License-Identifier: BSD-3-Clause
"""Many impacts of a package at once: inputs, and what the package answers."""

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

SOURCE = Path(__file__).with_name("oracle.c")

FIELDS = {
    "joint_stiffness": "springs",
    "rotor_inertia": "rotors",
    "position_gain": "gains",
    "damping_gain": "damping_gains",
    "reaction_time": "reaction",
}
"""Fields of a package's parameters that have other names here."""


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
        exact = {
            name: x.astype(np.float32).astype(float) if x.dtype == float else x
            for name, x in vars(self).items()
        }
        return Cases(**exact)

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
        for field in p.dtype.names or ():
            values = getattr(cases, FIELDS.get(field, field), None)
            if values is not None:
                p[field] = values
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
        return status, np.array(out["force" if function == "peak_force" else "speed"], float)
