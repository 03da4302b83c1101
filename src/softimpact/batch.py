# SPDX-License-Identifier: BSD-3-Clause
"""A robot's C package over arrays: thousands of poses, directions and parameters in one call.

    panda = compiled("panda", joint_stiffness=1e4)
    found = panda.safe_speed(q, n, limit, region="chest")
    found["speed"], found["status"]

The package is generated and compiled once, kept in the user's cache, and called in several threads.
"""

from __future__ import annotations

import ctypes
import hashlib
import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from platformdirs import user_cache_path

import softimpact
from softimpact.codegen import package_of
from softimpact.codegen.inputs import SCALARS
from softimpact.codegen.interface import Interface, interface_of
from softimpact.codegen.render import Package, render
from softimpact.symbolic import (
    REGIONS,
    Drives,
    InvalidValue,
    Robot,
    SoftImpactError,
    chain_to,
    drives,
    load_robot,
)
from softimpact.symbolic.impact.drives import PerJoint

Arrays = dict[str, NDArray[Any]]
"""Results by name, one row a call, and ``status``."""

COMPILERS = ("cc", "gcc", "clang")

FLAGS = ("-std=c99", "-O3", "-march=native", "-fPIC", "-shared")

MOTORS = ("free_or_driven", "free", "driven", "servo")
"""What motors do, as C counts."""

CHUNK = 4096
"""Fewest rows that are worth a thread of their own."""

RESULTS = {
    "peak_force": ("force", "time"),
    "safe_speed": ("speed", "force"),
    "speed_factor": ("factor", "point", "speed", "force"),
}


class NoCompiler(SoftImpactError):
    """There is no C compiler to build a package with; the functions of ``symbolic`` need none."""

    def __init__(self) -> None:
        super().__init__(
            f"no C compiler found (looked for $CC, {', '.join(COMPILERS)}); install one, or use "
            "softimpact.symbolic.analyse and softimpact.simulate one call at a time"
        )


@dataclass(frozen=True, eq=False)
class CompiledPackage:
    """A package's functions over arrays; each is a method by its C name without the prefix.

    ``q`` is N×n, or n for all rows; so are ``n`` (3), ``dq`` (n), other arguments and parameters
    by the names of the C struct's fields. Results are arrays of N rows by name, with ``status``
    beside them; rows whose status is neither OK (0) nor BOUNDED (9) hold NaN.

    Attributes:
        package: what was generated.
        path: of the library.
        threads: that calls are spread over.
    """

    package: Package
    path: Path
    threads: int

    def __getattr__(self, name: str) -> Any:
        """Return a method for a function of the package."""
        if name in RESULTS and self.package.impact:
            return lambda q, *given, **options: self._impact(name, q, *given, **options)
        if not name.startswith("_") and self.package.has(name):
            return lambda q, n=None, **options: self._function(name, q, n, **options)
        raise AttributeError(f"package '{self.package.prefix}' has no function '{name}'")

    def __dir__(self) -> list[str]:
        """Return the names of all functions, too."""
        impacts = list(RESULTS) if self.package.impact else []
        return [*super().__dir__(), *self.package.tables, *impacts]

    @property
    def _kind(self) -> type[np.floating[Any]]:
        return np.float64 if self.package.real == "double" else np.float32

    @cached_property
    def _library(self) -> ctypes.CDLL:
        return ctypes.CDLL(str(self.path))

    @cached_property
    def _interface(self) -> Interface:
        header = self.path.with_suffix(".h").read_text(encoding="utf-8")
        return interface_of(header, self.package.prefix)

    @cached_property
    def _params(self) -> np.dtype[Any]:
        return self._interface.dtype("params", self.package.real)

    def _function(self, name: str, q: ArrayLike, n: ArrayLike | None, **options: Any) -> Arrays:
        (source,) = [f for f in self.package.functions if f.function.name == name]
        function = source.function
        if function.direction and n is None:
            raise InvalidValue("n", f"{name} needs directions, N×3 or 3 numbers")
        scalars = {s.name: options.pop(s.name) for s in function.scalars}
        inputs = [self._rows("q", q, self.package.robot.n)]
        inputs += [self._rows("n", n, 3)] if function.direction else []
        inputs += [self._rows(s.name, scalars[s.name], 1) for s in function.scalars]
        inputs += [self._parameters(options)] if function.parameters else []
        if options:
            raise InvalidValue(next(iter(options)), f"is nothing that {name} reads")
        sizes = [int(np.prod(o.shape)) for o in function.outputs]
        out, status = self._call(name, inputs, sum(sizes))
        parts = np.split(out, np.cumsum(sizes)[:-1], axis=1)
        found = {
            o.name: part.reshape(len(out), *o.shape)
            for o, part in zip(function.outputs, parts, strict=True)
        }
        return {**found, "status": status}

    def _impact(
        self,
        name: str,
        q: ArrayLike,
        along: ArrayLike,
        number: ArrayLike,
        *,
        region: str | Mapping[str, float] = "chest",
        clamped: bool = True,
        motors: str = "free_or_driven",
        **options: Any,
    ) -> Arrays:
        """Call an impact: ``along`` is n or dq, ``number`` a speed or a limit."""
        if motors not in MOTORS:
            raise InvalidValue("motors", f"must be one of {', '.join(MOTORS)}, not '{motors}'")
        width = self.package.robot.n if name == "speed_factor" else 3
        inputs = [self._rows("q", q, self.package.robot.n), self._rows("along", along, width)]
        inputs += [self._rows("number", number, 1), self._region(region, clamped)]
        inputs.append(self._parameters({**options, "motors": MOTORS.index(motors)}))
        out, status = self._call(name, inputs, len(RESULTS[name]))
        return {**{r: out[:, i] for i, r in enumerate(RESULTS[name])}, "status": status}

    def _rows(self, name: str, values: Any, width: int) -> NDArray[Any]:
        array = np.ascontiguousarray(values, dtype=self._kind)
        rows = array.reshape(-1, width) if array.ndim < 2 and width == 1 else np.atleast_2d(array)
        if rows.ndim != 2 or rows.shape[1] != width:
            raise InvalidValue(name, f"needs rows of {width} numbers, not {array.shape}")
        return rows

    def _region(self, region: str | Mapping[str, float], clamped: bool) -> NDArray[Any]:
        names = "stiffness damping effective_mass hertz_stiffness quasi_static_limit force_limit"
        fields: list[Any] = [(f, self._kind) for f in names.split()]
        row = np.zeros(1, np.dtype([*fields, ("clamped", np.int32)], align=True))
        if isinstance(region, str):
            if region not in REGIONS:
                raise InvalidValue("region", f"must be one of {', '.join(REGIONS)}")
            entry = getattr(self._library, f"{self.package.prefix}_body_region")
            entry(list(REGIONS).index(region), int(clamped), ctypes.c_void_p(row.ctypes.data))
        else:
            for field, value in region.items():
                row[field] = value
            row["clamped"] = clamped
        return row

    def _parameters(self, given: dict[str, Any]) -> NDArray[Any]:
        """Return parameter structs, one or one a row; takes the fields out of ``given``."""
        default = np.zeros(1, self._params)
        getattr(self._library, f"{self.package.prefix}_fill_params")(
            ctypes.c_void_p(default.ctypes.data),
            ctypes.c_uint(self._interface.layout_in(self.package.real)),
        )
        values = {f: np.asarray(given.pop(f)) for f in self._params.names or () if f in given}
        plain = {f: len(self._params[f].shape) for f in values}
        rows = [len(v) for f, v in values.items() if v.ndim > plain[f]]
        table = np.repeat(default, max(rows, default=1))
        for field, value in values.items():
            table[field] = value
        return table

    def _call(self, name: str, inputs: list[NDArray[Any]], width: int) -> tuple[Any, Any]:
        count = max(len(rows) for rows in inputs)
        for rows in inputs:
            if len(rows) not in (1, count):
                raise InvalidValue("rows", f"needs {count} rows or one everywhere, not {len(rows)}")
        out = np.full((count, width), np.nan, dtype=self._kind)
        status = np.empty(count, dtype=np.int32)
        entry = getattr(self._library, f"batch_{name}")
        strides = [0 if len(rows) == 1 else rows.strides[0] for rows in inputs]

        def part(bounds: tuple[int, int]) -> None:
            first, last = bounds
            at = [
                argument
                for rows, stride in zip(inputs, strides, strict=True)
                for argument in (
                    ctypes.c_void_p(rows.ctypes.data + first * stride),
                    ctypes.c_long(stride),
                )
            ]
            place = (out.ctypes.data + first * out.strides[0], status.ctypes.data + 4 * first)
            entry(ctypes.c_long(last - first), *at, *map(ctypes.c_void_p, place))

        pieces = max(1, min(8 * self.threads, count // CHUNK)) if self.threads > 1 else 1
        edges = np.linspace(0, count, pieces + 1).astype(int).tolist()
        with ThreadPoolExecutor(self.threads) as pool:
            list(pool.map(part, pairwise(edges)))
        return out, status


def compiled(
    model: str | Path,
    *,
    tip: str | None = None,
    end: str | None = None,
    points: Mapping[str, str] | None = None,
    real: Literal["double", "float"] = "double",
    joint_stiffness: PerJoint | None = None,
    rotor_inertia: PerJoint | None = None,
    position_gain: PerJoint | None = None,
    threads: int | None = None,
) -> CompiledPackage:
    """Return a robot's C package as a library over arrays; built once, then taken from the cache.

    Args:
        model: built-in robot, or path of a file.
        tip: contact frame; default the robot's own.
        end: end of the arm, whose joints all stay; default the contact frame.
        points: further contact points for ``speed_factor``.
        real: number type; ``float`` is faster and good for 2e-3 of forces, too.
        joint_stiffness: default of the parameter, and so the next two.
        rotor_inertia: the file's unless given.
        position_gain: of a servo.
        threads: default one a processor.

    Raises:
        NoCompiler: there is none.
        SoftImpactError: the robot cannot be read, or has no such frame.
    """
    robot = load_robot(str(model), tip)
    contact = robot.tip if tip is None else tip
    if contact is None and end is None:
        raise InvalidValue("tip", f"{model} names no contact frame; name one")
    arm = chain_to(robot, end or str(contact))
    given = (joint_stiffness, rotor_inertia, position_gain)
    known = None if all(x is None for x in given) else drives(arm, *given)
    return compiled_arm(arm, known, tip=contact or end, points=points, real=real, threads=threads)


def compiled_arm(
    arm: Robot,
    drives_: Drives | None = None,
    *,
    tip: str | None = None,
    points: Mapping[str, str] | None = None,
    real: Literal["double", "float"] = "double",
    gravity: tuple[float, float, float] | None = None,
    threads: int | None = None,
) -> CompiledPackage:
    """Return the library of an arm that is there already: loaded, with its tool and payload.

    Args:
        arm: all of its joints are moved.
        drives_: defaults of the parameters; the file's unless given.
        tip: contact frame; default the arm's own.
        points: as ``compiled``, and what follows.
        real: number type.
        gravity: whose curvature counts [m/s²]; default as ``generate_package``.
        threads: default one a processor.

    Raises:
        NoCompiler: there is none.
        SoftImpactError: the arm has no such frame.
    """
    package = package_of(
        arm, tip=tip, real=real, name="batched", drives_=drives_, gravity=gravity, points=points
    )
    return CompiledPackage(package, _built(package), threads or os.cpu_count() or 1)


def _built(package: Package) -> Path:
    """Return the library of a package from the cache, compiled if it is not there."""
    compiler = os.environ.get("CC") or next(filter(shutil.which, COMPILERS), None)
    if compiler is None:
        raise NoCompiler
    files, _ = render(package)
    files = {path: text for path, text in files.items() if path.endswith((".c", ".h"))}
    files["src/batch.c"] = _loops(package)
    content = json.dumps([softimpact.__version__, compiler, FLAGS, package.real, files])
    key = hashlib.sha256(content.encode()).hexdigest()[:32]
    library = user_cache_path("softimpact") / "batch" / f"{key}.so"
    if library.is_file():
        return library
    library.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=library.parent) as folder:
        for path, text in files.items():
            target = Path(folder, path)
            target.parent.mkdir(exist_ok=True)
            target.write_text(text, encoding="utf-8")
        out = Path(folder, "library.so")
        sources = sorted(Path(folder, "src").glob("*.c"))
        use = f"-DBATCHED_USE_{package.real.upper()}=1"
        command = [compiler, *FLAGS, use, f"-I{folder}/include", *map(str, sources)]
        subprocess.run([*command, "-o", str(out), "-lm"], check=True, capture_output=True)
        library.with_suffix(".h").write_text(files[f"include/{package.prefix}.h"], encoding="utf-8")
        out.replace(library)
    return library


def _loops(package: Package) -> str:
    """Return a C function over rows for each function of a package."""
    name, real = package.prefix, f"{package.prefix}_real"
    lines = [f'#include "{name}.h"', "#define AT(type, x) ((type)((const char *)x + i*x##_step))"]
    scalars = {s.name for s in SCALARS}

    def loop(short: str, inputs: list[str], target: str, width: int, scalar: set[str]) -> None:
        declared = ", ".join(f"const void *{x}, long {x}_step" for x in inputs)
        kinds = {"p": f"const {name}_params *", "region": f"const {name}_region *"}
        read = [
            f"*AT(const {real} *, {x})" if x in scalar
            else f"AT({kinds.get(x, f'const {real} *')}, {x})"
            for x in inputs
        ]  # fmt: skip
        lines.append(
            f"void batch_{short}(long count, {declared}, {real} *out, int *status);\n"
            f"void batch_{short}(long count, {declared}, {real} *out, int *status)\n{{\n"
            f"    for (long i = 0; i < count; ++i) {{\n"
            f"        {real} *const row = out + {width}*i;\n"
            f"        status[i] = {name}_{short}({', '.join(read)}, {target});\n    }}\n}}"
        )

    for source in package.functions:
        function = source.function
        width = sum(int(np.prod(o.shape)) for o in function.outputs)
        target = f"({source.struct} *)row" if source.struct else "(void *)row"
        loop(function.name, source.inputs, target, width, scalars)
    if package.impact:
        for short in ("peak_force", "safe_speed"):
            inputs = ["q", "n", "number", "region", "p"]
            loop(short, inputs, f"({name}_{short}_t *)row", 2, {"number"})
        loop("speed_factor", ["q", "dq", "number", "region", "p"], "&found", 4, {"number"})
        lines[-1] = (
            lines[-1]
            .replace(
                "        status[i]", f"        {name}_speed_factor_t found;\n        status[i]"
            )
            .replace(
                "    }\n}",
                "        if (status[i] == 0 || status[i] == 9) {\n"
                "            row[0] = found.factor;\n"
                f"            row[1] = ({real})found.point;\n"
                "            row[2] = found.speed;\n            row[3] = found.force;\n"
                "        }\n    }\n}",
            )
        )
    return "\n".join(lines) + "\n"
