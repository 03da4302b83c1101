# SPDX-License-Identifier: BSD-3-Clause
"""Adversarial search for impacts that a package gets wrong, against the tests' own integrator."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from compiled_impacts import DRIVEN, FREE, FREE_OR_DRIVEN
from compiled_packages import KINDS, Generated, run, tool

from softimpact.symbolic import REGIONS, contact_point_jacobian, mass_matrix
from softimpact.symbolic.body.contact import HERTZ_STIFFNESS
from softimpact.symbolic.robot.rigid import Array

SOURCE = Path(__file__).parent / "codegen/impact_oracle.c"

LONGEST = 2e-5
"""Longest step [s] of the integrator before it is made coarser."""


@dataclass(frozen=True, eq=False)
class Case:
    """Inputs of a safe speed; arrays have one entry a joint."""

    q: Array
    n: Array
    springs: Array
    rotors: Array
    gains: Array
    damping_gains: Array
    motors: int
    reaction: float
    horizon: float
    region: str
    clamped: bool
    stiffness: float
    damping: float
    limit: float

    @property
    def mass(self) -> float:
        """Effective mass of the body [kg]; 0 where it is held."""
        return 0.0 if self.clamped else REGIONS[self.region].effective_mass


def rounded(case: Case) -> Case:
    """Return a case whose numbers are exact in float, so that both builds and the oracle agree."""
    changed: dict[str, Any] = {}
    for name, value in vars(case).items():
        if isinstance(value, np.ndarray):
            changed[name] = value.astype(np.float32).astype(float)
        elif isinstance(value, float):
            changed[name] = float(np.float32(value))
    return replace(case, **changed)


class Robot:
    """A package with elastic joints, compiled, and what its impacts should be."""

    def __init__(self, package: Generated, folder: Path) -> None:
        self.package, self.folder = package, folder
        self.n = package.robot.n
        q = ca.SX.sym("q", self.n)
        robot = package.robot
        J = contact_point_jacobian(robot, package.tip, q)
        self.model = ca.Function("model", [q], [mass_matrix(robot, q), J])
        self.lower, self.upper = (np.clip(x, -math.pi, math.pi) for x in robot.limits)

    @cached_property
    def oracle(self) -> Callable[[object], float]:
        """The tests' integrator."""
        out = self.folder / "oracle.so"
        if not out.exists():
            run(tool("gcc"), "-std=c99", "-O2", "-shared", "-fPIC", SOURCE, "-o", out, "-lm")
        entry = ctypes.CDLL(str(out)).largest_force
        entry.restype = ctypes.c_double
        return lambda impact: float(entry(ctypes.byref(impact)))  # type: ignore[arg-type]

    def arrival(self, case: Case) -> tuple[Array, Array, Array]:
        """Return M⁻¹, nᵀJ and the least joint velocities along n."""
        M, J = (np.array(x) for x in self.model(case.q))
        n = case.n / np.linalg.norm(case.n)
        rates = np.linalg.pinv(J, rcond=1e-9) @ n
        return np.asarray(np.linalg.inv(M)), np.asarray(n @ J), np.asarray(rates)

    def right_force(self, case: Case, speed: float, coarse: float = 1.0) -> float:
        """Return the largest force [N] by the tests' integrator.

        Args:
            case: inputs.
            speed: of the impact [m/s].
            coarse: factor on its steps; at 2 errors are still below 1e-4.
        """
        if case.motors == FREE_OR_DRIVEN:
            ends = (FREE, DRIVEN)
            return max(self.right_force(replace(case, motors=m), speed, coarse) for m in ends)
        inverse, row, rates = self.arrival(case)
        root = np.sqrt(case.springs)
        fastest = math.sqrt(float(np.linalg.eigvalsh(root[:, None] * inverse * root).max()))
        step = min(LONGEST if coarse > 1 else 5e-6, 0.3 / fastest)
        if case.damping > 0:
            stiff = case.stiffness + 1.5 * (HERTZ_STIFFNESS**2 * 3 * case.limit) ** (1 / 3)
            step = min(step, 0.7 * case.damping / stiff)
        step = max(coarse * step, 2e-7)
        arrays = [
            np.ascontiguousarray(x, dtype=float)
            for x in (
                inverse,
                row,
                rates,
                case.springs,
                case.rotors,
                case.gains,
                case.damping_gains,
            )
        ]
        pointers = [x.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for x in arrays]
        impact = _Impact(
            self.n, case.motors, *pointers, speed, case.stiffness, case.damping, case.mass,
            HERTZ_STIFFNESS, case.reaction, case.horizon, step,
        )  # fmt: skip
        return self.oracle(impact)

    def call(
        self, function: str, case: Case, number: float, real: str, steps: int = 4000
    ) -> tuple[int, Array]:
        """Return status and the two numbers of peak_force or safe_speed."""
        c_real, kind = KINDS[real]
        library = self.package.load(real).library
        motion = {"reaction_time": case.reaction, "horizon": case.horizon}
        drives = [case.springs, case.rotors, case.gains, case.damping_gains]
        p = self.package.params(
            real, drives, **motion, motors=case.motors, steps=steps
        ).tobytes()  # fmt: skip
        region = np.zeros(1, self.package.interface.dtype("region", real))
        region["stiffness"], region["damping"] = case.stiffness, case.damping
        region["effective_mass"], region["clamped"] = case.mass or 1.0, case.clamped
        region["hertz_stiffness"] = HERTZ_STIFFNESS
        out = np.full(2, np.nan, dtype=kind)
        q, n = case.q.astype(kind), case.n.astype(kind)
        entry = getattr(library, f"{self.package.manifest.name}_{function}")
        status = entry(
            *(ctypes.c_void_p(v.ctypes.data) for v in (q, n)), c_real(number),
            ctypes.c_void_p(region.ctypes.data), ctypes.c_char_p(p),
            ctypes.c_void_p(out.ctypes.data),
        )  # fmt: skip
        return status, out.astype(float)


class _Impact(ctypes.Structure):
    _fields_ = [
        ("n", ctypes.c_int),
        ("motors", ctypes.c_int),
        *((name, ctypes.POINTER(ctypes.c_double)) for name in (
            "inverse", "row", "rates", "springs", "rotors", "gains", "damping_gains")),
        *((name, ctypes.c_double) for name in (
            "speed", "stiffness", "damping", "mass", "skin", "reaction", "horizon", "step")),
    ]  # fmt: skip


def draw(robot: Robot, random: np.random.Generator, motors: int | None = None) -> Case:
    """Return a random case: uniform or mixed drives, plain or corner numbers."""
    n = robot.n

    def spread(low: float, high: float) -> Array:
        """Return numbers between two: all alike, each its own, or at the ends."""
        how = random.random()
        if how < 0.4:
            share = np.full(n, random.random())
        elif how < 0.8:
            share = random.random(n)
        else:
            share = random.integers(0, 2, n).astype(float)
        return np.asarray(low * (high / low) ** share)

    region = str(random.choice(list(REGIONS)))
    body = REGIONS[region]
    servo = spread(10, 1e5) if random.random() < 0.9 else np.zeros(n)
    rotors = spread(0.05, 2.0)
    damping = 2 * random.random() * np.sqrt(servo * rotors)
    plain = random.random() < 0.7
    return rounded(
        Case(
            q=robot.lower + (robot.upper - robot.lower) * random.random(n),
            n=random.normal(size=3),
            springs=spread(300, 1e5),
            rotors=rotors,
            gains=servo,
            damping_gains=damping,
            motors=int(random.integers(0, 4)) if motors is None else motors,
            reaction=float(random.choice([0.0, 0.005, 0.02, 0.05, 10.0])),
            horizon=0.1,
            region=region,
            clamped=bool(random.random() < 0.5),
            stiffness=body.stiffness,
            damping=10.0 if plain else float(10 ** random.uniform(1, 3)),
            limit=body.force_limit,
        )
    )


def changed(case: Case, random: np.random.Generator, robot: Robot) -> Case:
    """Return a neighbour of a case."""
    scale = 10 ** random.uniform(-2.5, -0.3)

    def turned(x: Array) -> Array:
        mask = random.random(len(x)) < 0.4
        return np.asarray(x * np.exp(scale * random.normal(size=len(x)) * mask))

    q = case.q + scale * random.normal(size=robot.n) * (random.random(robot.n) < 0.4)
    return rounded(
        replace(
            case,
            q=np.clip(q, robot.lower, robot.upper),
            n=case.n + 0.5 * scale * random.normal(size=3) * np.linalg.norm(case.n),
            springs=np.clip(turned(case.springs), 300, 1e5),
            rotors=np.clip(turned(case.rotors), 0.05, 2),
            gains=np.clip(turned(case.gains), 0, 1e5),
            limit=case.limit * math.exp(0.3 * scale * random.normal()),
        )
    )


def climb(
    robot: Robot,
    case: Case,
    score: Callable[[Case], float],
    random: np.random.Generator,
    turns: int,
) -> Iterator[tuple[float, Case]]:
    """Climb towards a higher score from a case; yield every improvement."""
    best = score(case)
    yield best, case
    for _ in range(turns):
        other = changed(case, random, robot)
        found = score(other)
        if found > best:
            best, case = found, other
            yield best, case
