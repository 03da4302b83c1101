# SPDX-License-Identifier: BSD-3-Clause
"""A package whose impacts are looked at, and what they should be."""

from __future__ import annotations

import ctypes
import math
from functools import cached_property
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from compiled_packages import Generated, run, tool
from numpy.typing import NDArray
from sharing import once

from softimpact.codegen.inputs.parameters import is_elastic
from softimpact.symbolic import Drives, closed_chain, contact_point_jacobian, impact_model
from softimpact.symbolic.robot.rigid import Array

from .cases import Cases
from .questions import QUESTIONS, Answers, Question, answers, called

ORACLE = Path(__file__).with_name("oracle")

FLAGS = ("-std=c99", "-O3", "-march=native", "-Wall", "-Wextra", "-Wconversion", "-Werror")


def library(folder: Path, name: str, *sources: str) -> ctypes.CDLL:
    """Return some of the tests' own C, compiled in a folder once."""
    out = folder / f"{name}.so"
    files = [ORACLE / f"{source}.c" for source in sources]
    once(out, lambda path: run(tool("gcc"), *FLAGS, "-shared", "-fPIC", *files, "-o", path, "-lm"))
    return ctypes.CDLL(str(out))


class Robot:
    """A package, compiled, and the links that its impacts should be of."""

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
        self.damping = np.array(robot.damping)[self.independent]
        self.n = len(self.actuated)
        M, K = model.generalised_mass(q).matrix, ca.SX(model.potential_stiffness(q))
        parts = [ca.densify(ca.SX(x)) for x in (M, K, model.jacobian(q))]
        self.model = ca.Function("model", [q, rotors], parts)
        self.lower, self.upper = (np.clip(x, -math.pi, math.pi) for x in robot.limits)

    @cached_property
    def oracle(self) -> ctypes.CDLL:
        """The tests' integrator."""
        found = library(self.folder, "oracle", "impact", "linear", "contact")
        found.largest_forces.restype = ctypes.c_long
        return found

    @cached_property
    def frames(self) -> list[ca.Function]:
        """Jacobians of the origin and of a point along each axis, of each frame that C knows."""
        robot, q = self.package.robot, ca.SX.sym("q", self.joints)

        def at(frame: str, place: str) -> ca.SX:
            point = robot.frame(f"{frame}@{place}").name
            return ca.densify(contact_point_jacobian(robot, point, q))

        names = [frame.name for frame in robot.frames.values() if frame.joint >= 0]
        ends = ("0,0,0", "1,0,0", "0,1,0", "0,0,1")
        return [ca.Function("frame", [q], [at(name, end) for end in ends]) for name in names]

    def jacobians(self, q: Array, frame: Any = None, place: Any = None) -> Array:
        """Return J of contact points over the independent joints, the package's own by default."""
        count, n = len(q), self.n
        found = self.model.map(count)(q.T, np.ones(q.T.shape))[2]
        J = np.array(found).reshape(3, count, n).swapaxes(0, 1)
        for number in set(frame[frame >= 0].tolist() if frame is not None else ()):
            rows = np.flatnonzero(frame == number)
            ends = self.frames[number].map(len(rows))(q[rows].T)
            start, *axes = (np.array(x).reshape(3, len(rows), n).swapaxes(0, 1) for x in ends)
            ways = np.stack([end - start for end in axes])
            J[rows] = start + np.einsum("rk,krij->rij", place[rows], ways)
        return J

    def links(self, cases: Cases) -> tuple[Array, Array, Array]:
        """Return masses, potentials' curvatures and Jacobians over the independent joints."""
        count, n = len(cases), self.n
        found = self.model.map(count)(cases.q.T, cases.rotors.T)
        M, K = (np.array(x).reshape(n, count, n).swapaxes(0, 1) for x in found[:2])
        return M, K, self.jacobians(cases.q, cases.frame, cases.place)

    def moved(self, cases: Cases) -> Array:
        """Return the velocities of the contact points at joint velocities, a row each [m/s]."""
        J = self.jacobians(cases.q, cases.frame, cases.place)
        return np.asarray(np.einsum("kij,kj->ki", J, cases.dq[:, self.independent]))

    def answers(self, question: Question, cases: Cases, real: str) -> Answers:
        """Return what the package answers."""
        moved = np.linalg.norm(self.moved(cases), axis=1) if question.moves else cases.speed
        return answers(self.package, question, cases, real, moved)

    def peaks(self, cases: Cases, speeds: Array, real: str) -> tuple[NDArray[np.int32], Array]:
        """Return statuses and forces of ``peak_force``."""
        status, out = called(self.package, "peak_force", cases, speeds, real)
        return status, np.array(out["force"], float)

    def speeds(self, cases: Cases, real: str) -> tuple[NDArray[np.int32], Array]:
        """Return statuses and speeds of ``safe_speed``."""
        found = self.answers(QUESTIONS["limit"], cases, real)
        return found.status, found.speed
