# SPDX-License-Identifier: BSD-3-Clause
"""Generated packages, compiled and called through ctypes."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray
from sharing import once

from softimpact.codegen.bindings.interface import Interface, read_interface
from softimpact.codegen.functions import functions_of, symbols_of
from softimpact.codegen.functions.description import CFunction
from softimpact.codegen.inputs.parameters import SCALARS, Parameter, freeze, parameters_of
from softimpact.codegen.inputs.samples import Sample
from softimpact.codegen.record.manifest import Manifest
from softimpact.studio.typed.pose_table import pose_table
from softimpact.symbolic import Robot
from softimpact.symbolic.robot.rigid import Array

STUDIES = Path(__file__).parents[1] / "robots/studies"

WARNINGS = [
    *("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion", "-Wshadow"),
    *("-Wmissing-prototypes", "-Wstrict-prototypes", "-Wfloat-equal", "-Wundef", "-Werror"),
]
COMMITTED = sorted(path.name for path in (Path(__file__).parents[1] / "generated").iterdir())
"""Names of the built-in robots whose packages are in the repository."""

QUICK = ("panda", "rr", "gantry", "rmin")
"""Robots with whose packages the fast tests are content; the others' are slow."""

KINDS = {"double": (ctypes.c_double, np.float64), "float": (ctypes.c_float, np.float32)}


def mostly_slow(cases: Iterable[Any], quick: Collection[Any] = QUICK) -> list[Any]:
    """Return cases for ``parametrize``, marked slow but for the quick ones."""
    slow = pytest.mark.slow
    return [
        pytest.param(
            *(case if isinstance(case, tuple) else (case,)), marks=() if case in quick else slow
        )
        for case in cases
    ]


def candidate_poses(name: str, robot: Robot) -> dict[str, Sequence[float]]:
    """Return the poses built into a committed package: those of the robot's study, if any."""
    study = next(STUDIES.glob(f"{name}_*.toml"), None)
    return pose_table(study, robot) if study else {}


def tool(name: str) -> str:
    """Return a program's path; without it skip, or fail where nothing may be skipped."""
    path = shutil.which(name)
    if path is None:
        missing(name)
    return str(path)


def missing(what: str) -> None:
    """Skip a test for want of something, or fail where nothing may be skipped."""
    (pytest.fail if os.environ.get("CI") else pytest.skip)(f"needs {what}")


def run(*command: str | Path, ok: bool = True) -> str:
    """Run a program and return what it says."""
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)
    if ok:
        assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


@dataclass(frozen=True, eq=False)
class Generated:
    """A package on disk and what it was generated from."""

    robot: Robot
    tip: str
    folder: Path
    manifest: Manifest

    def flags(self, real: str) -> list[str]:
        """Return what every compiler of the package is told."""
        use = f"-D{self.manifest.name.upper()}_USE_{real.upper()}=1"
        return ["-std=c99", "-O1", *WARNINGS, use, f"-I{self.folder / 'include'}"]

    @cached_property
    def functions(self) -> tuple[CFunction, ...]:
        """What the package computes."""
        m = self.manifest
        x, y, z = m.gravity
        symbols = symbols_of(self.robot, self.tip, (x, y, z), self.parameters)
        return functions_of(symbols, m.chain_order, floating=m.floating)

    @cached_property
    def interface(self) -> Interface:
        """What its header declares."""
        return read_interface(self.folder)

    def params(self, real: str, parameters: Sequence[ArrayLike], **motion: float) -> NDArray[Any]:
        """Return a parameter struct: values of all parameters, and of what impacts go by."""
        p = np.zeros(1, self.interface.dtype("params", real))
        p["layout"] = self.interface.layout_in(real)
        for parameter, values in zip(self.parameters, parameters, strict=True):
            if parameter.frozen is None:
                p[parameter.name] = np.reshape(values, parameter.shape)
        for name, value in motion.items():
            p[name] = value
        return p

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """All parameters, frozen ones too."""
        m = self.manifest
        payload = "payload_mass" in (*m.parameters, *m.frozen)
        return freeze(parameters_of(self.robot, payload=payload), m.frozen)

    def run_own_test(self, compiler: str, real: str, out: Path) -> str:
        """Compile the package's own test without a warning, run it and return what it says."""
        sources = [*self.folder.glob("src/*.c"), *self.folder.glob("test/*.c")]
        run(tool(compiler), *self.flags(real), *sources, "-o", out, "-lm")
        return run(out)

    def load(self, real: str) -> Library:
        """Compile the package to a shared library beside it, once, and open it."""
        out = self.folder.with_suffix(f".{real}.so")
        flags = [*self.flags(real), "-shared", "-fPIC"]
        files = self.folder.glob("src/*.c")
        once(out, lambda path: run(tool("gcc"), *flags, *files, "-o", path, "-lm"))
        return Library(self, ctypes.CDLL(str(out)), real)


@dataclass(frozen=True, eq=False)
class Library:
    """A compiled package."""

    package: Generated
    library: ctypes.CDLL
    real: str

    def call(self, function: CFunction, sample: Sample) -> tuple[int, list[Array]]:
        """Return a function's status and its outputs, which start as NaN."""
        real, kind = KINDS[self.real]
        sizes = [int(np.prod(output.shape)) for output in function.outputs]
        out = np.full(sum(sizes), np.nan, dtype=kind)
        scalars = dict(zip(SCALARS, sample.scalars, strict=True))
        vectors = [np.array(sample.q, dtype=kind), np.array(sample.n, dtype=kind)]
        if function.parameters:
            vectors.append(self.package.params(self.real, sample.parameters))
        q, n, *p = (ctypes.c_void_p(vector.ctypes.data) for vector in vectors)
        entry = getattr(self.library, f"{self.package.manifest.name}_{function.name}")
        status = entry(
            q,
            *([n] if function.direction else []),
            *(real(scalars[scalar]) for scalar in function.scalars),
            *p,
            ctypes.c_void_p(out.ctypes.data),
        )
        parts = np.split(out.astype(float), np.cumsum(sizes)[:-1])
        shapes = [output.shape for output in function.outputs]
        return status, [part.reshape(shape) for part, shape in zip(parts, shapes, strict=True)]


def parameter(package: Generated, sample: Sample, name: str) -> Array:
    """Return a sample's values of one field of the parameter struct."""
    names = [p.name for p in package.parameters]
    return np.array(sample.parameters[names.index(name)])
