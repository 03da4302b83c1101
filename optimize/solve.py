# SPDX-License-Identifier: BSD-3-Clause
"""Solve the design NLP from one start; everything here runs in a worker process."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import casadi as ca
import numpy as np

from softimpact.symbolic.robot.rigid import Array

Mode = Literal["table", "free"]
"""``table``: the posture is given and k_s is sought; ``free``: both are sought."""

IPOPT: dict[str, Any] = {
    "hessian_approximation": "limited-memory",
    "limited_memory_max_history": 20,
    "max_iter": 300,
    "tol": 1e-5,
    "acceptable_tol": 1e-4,
    "acceptable_iter": 8,
}
"""Options of Ipopt: the exact Hessian halves the iterations but costs seven times each."""


def quiet(ipopt: dict[str, Any]) -> dict[str, Any]:
    """Return options of CasADi's nlpsol for an Ipopt that prints nothing and raises nothing."""
    silent = {**ipopt, "print_level": 0, "sb": "yes"}
    return {"ipopt": silent, "print_time": False, "error_on_fail": False}


@dataclass(frozen=True, eq=False)
class Program:
    """An NLP that a process can load.

    Attributes:
        oracle: the problem's functions, serialised.
        library: their compiled form, None to run in CasADi's virtual machine.
        n: number of joints.
        pose: entries of g that are the tip's pose error.
        forces: entries of g that are f_k − F.
    """

    oracle: str
    library: Path | None
    n: int
    pose: slice
    forces: slice


@dataclass(frozen=True, eq=False)
class Start:
    """Where a search begins.

    Attributes:
        name: of the pose.
        mode: table or free.
        points: postures [rad] and stiffnesses [N·m/rad] to start from; the best answer counts.
        fallbacks: the same, to try in turn if no search from the points succeeds.
    """

    name: str
    mode: Mode
    points: tuple[tuple[Array, Array], ...]
    fallbacks: tuple[tuple[Array, Array], ...] = ()


@dataclass(frozen=True, eq=False)
class Bounds:
    """Limits of the variables, length n each; and the force that F = 1 stands for [N]."""

    q_lower: Array
    q_upper: Array
    springs_lower: Array
    springs_upper: Array
    unit: float


@dataclass(frozen=True, eq=False)
class Outcome:
    """What a search found.

    Attributes:
        name: of the pose it started from.
        mode: table or free.
        status: Ipopt's.
        solved: whether a local optimum was found.
        iterations: of all attempts.
        attempts: number of searches.
        seconds: wall time.
        q: posture, length n [rad].
        springs: joint stiffness, length n [N·m/rad].
        force: peak of the first contact [N].
        violation: largest violation of a constraint, in the NLP's units (m, rad, shares).
    """

    name: str
    mode: Mode
    status: str
    solved: bool
    iterations: int
    attempts: int
    seconds: float
    q: Array
    springs: Array
    force: float
    violation: float


FEASIBLE = 1e-5
"""Violation up to which a point counts as feasible."""


IN_TURN = threading.Lock()
"""Held by a search: MUMPS, Ipopt's linear solver, is not thread-safe."""


@lru_cache(maxsize=4)
def _solver(oracle: str, library: Path | None) -> tuple[ca.Function, ca.Function]:
    functions = ca.Function.deserialize(oracle)
    if library is not None:
        return ca.nlpsol("design", "ipopt", str(library), quiet(IPOPT)), functions
    return nlp_solver(functions), functions


def nlp_solver(oracle: ca.Function) -> ca.Function:
    """Return Ipopt on the problem, in CasADi's virtual machine."""
    x, p = (ca.MX.sym(name, oracle.numel_in(name)) for name in ("x", "p"))
    f, g = oracle(x, p)
    problem: dict[str, Any] = {"x": x, "p": p, "f": f, "g": g}
    return ca.nlpsol("design", "ipopt", problem, quiet(IPOPT))


def solve(program: Program, start: Start, bounds: Bounds, parameters: Array) -> Outcome:
    """Search from all points of a start, and from its fallbacks as long as Ipopt fails.

    Returns:
        The solved point of least force; if there is none, the feasible point of least force, else
        the one of least violation.
    """
    with IN_TURN:
        return _search(program, start, bounds, parameters)


def _search(program: Program, start: Start, bounds: Bounds, parameters: Array) -> Outcome:
    begin = time.perf_counter()
    found = [_attempt(program, start, *point, bounds, parameters) for point in start.points]
    for point in start.fallbacks:
        if any(outcome.solved for outcome in found):
            break
        found.append(_attempt(program, start, *point, bounds, parameters))
    return replace(
        min(found, key=preference),
        iterations=sum(outcome.iterations for outcome in found),
        attempts=len(found),
        seconds=time.perf_counter() - begin,
    )


def preference(outcome: Outcome) -> tuple[bool, bool, float]:
    """Sort key: solved before feasible before the rest; then by force, or by violation."""
    feasible = outcome.violation <= FEASIBLE
    return not outcome.solved, not feasible, outcome.force if feasible else outcome.violation


def better(first: Outcome, second: Outcome) -> Outcome:
    """Return the preferred of two outcomes of one start, with the effort of both."""
    best = min(first, second, key=preference)
    return replace(
        best,
        iterations=first.iterations + second.iterations,
        attempts=first.attempts + second.attempts,
        seconds=first.seconds + second.seconds,
    )


def _constraint_bounds(program: Program, mode: Mode) -> tuple[Array, Array]:
    """Bounds on g: the tip's pose is held where the posture is free, all else is at most zero."""
    size = program.forces.stop
    lower, upper = np.full(size, -np.inf), np.zeros(size)
    lower[program.pose], upper[program.pose] = (0.0, 0.0) if mode == "free" else (-np.inf, np.inf)
    return lower, upper


def _attempt(
    program: Program, start: Start, q: Array, springs: Array, bounds: Bounds, parameters: Array
) -> Outcome:
    solver, functions = _solver(program.oracle, program.library)
    n = program.n
    posture = np.clip(q, bounds.q_lower, bounds.q_upper)
    x0 = np.concatenate([posture, np.log10(springs), [0.0]])
    x0[-1] = np.array(functions(x0, parameters)[1])[program.forces].max()
    lower, upper = _constraint_bounds(program, start.mode)
    q_lower, q_upper = (
        (posture, posture) if start.mode == "table" else (bounds.q_lower, bounds.q_upper)
    )
    least = np.concatenate([q_lower, np.log10(bounds.springs_lower), [0.0]])
    most = np.concatenate([q_upper, np.log10(bounds.springs_upper), [np.inf]])
    solution = solver(x0=x0, p=parameters, lbx=least, ubx=most, lbg=lower, ubg=upper)
    x, g = np.array(solution["x"]).ravel(), np.array(solution["g"]).ravel()
    x = np.clip(x, least, most)  # Ipopt relaxes bounds by 1e-8
    stats = solver.stats()
    violated = np.maximum(np.maximum(lower - g, g - upper), 0.0)
    violation = float(violated[: program.forces.start].max())
    peak = x[-1] + g[program.forces].max()  # where Ipopt gave up, F need not bound the forces
    return Outcome(
        name=start.name,
        mode=start.mode,
        status=stats["return_status"],
        solved=bool(stats["success"]) and violation <= FEASIBLE,
        iterations=int(stats["iter_count"]),
        attempts=1,
        seconds=0.0,
        q=x[:n],
        springs=10 ** x[n : 2 * n],
        force=float(peak * bounds.unit),
        violation=violation,
    )
