# SPDX-License-Identifier: BSD-3-Clause
"""Sources of a package in the user's cache, and libraries that are compiled from them when needed."""

from __future__ import annotations

import atexit
import ctypes
import hashlib
import json
import platform
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import softimpact
from softimpact.toolchain import c_compiler, passing_folder, usable_cache, zig_environment
from softimpact.symbolic.dynamics.equations_of_motion import FixedGravity
from softimpact.symbolic import Drives, Robot, SoftImpactError

if TYPE_CHECKING:
    from softimpact.codegen.bindings.interface import Interface
    from softimpact.codegen.record.manifest import Real

PREFIX = "batched"
"""Of all C names, whatever the robot is called: the same C serves robots that are alike."""

FLAGS = ("-std=c99", "-O2", "-fPIC", "-shared", "-fopenmp-simd", "-fno-math-errno",
         "-fno-trapping-math", "-ffp-contract=fast")  # fmt: skip
"""Neither errno nor traps are used; checks for numbers that are not finite stay. At -O3 the C compiler
splits the loops over lanes, which then take half as long again."""

NATIVE = "-march=native"
"""Left out where a compiler does not know it."""

READ = ("symbolic", "codegen")
"""Folders whose sources decide what is generated."""


class NoCompiler(SoftImpactError):
    """There is no C compiler to build a package with; the functions of ``symbolic`` need none."""

    def __init__(self) -> None:
        super().__init__(
            "no C compiler found (looked for $CC, cc, gcc, clang and the package ziglang); "
            "'pip install ziglang' brings one, or use softimpact.symbolic.analyse and "
            "softimpact.simulate one call at a time"
        )


class CompilerFailed(SoftImpactError):
    """The C compiler does not make a library that can be loaded."""

    def __init__(self, command: str, reason: str) -> None:
        self.command, self.reason = command, reason
        super().__init__(f"the C compiler {command} failed ({reason}); name another one in $CC")


@dataclass(frozen=True)
class Sources:
    """A package's C in a folder.

    Attributes:
        folder: of it, in the cache.
        real: number type.
        compiler: words of the command line of the C compiler.
    """

    folder: Path
    real: Real
    compiler: tuple[str, ...]

    def interface(self) -> Interface:
        """Return what its header declares."""
        from softimpact.codegen.bindings.interface import read_interface

        return read_interface(self.folder)

    def library(self, path: str) -> ctypes.CDLL:
        """Return a library of a source and those that it needs, compiled if it is not there.

        Raises:
            CompilerFailed: it does not compile.
        """
        words = [*self.compiler, *FLAGS, sys.platform, platform.machine(), _processor()]
        key = hashlib.sha256(" ".join(words).encode()).hexdigest()[:16]
        library = self.folder / f"{Path(path).stem}-{key}.so"
        if not library.is_file():
            with tempfile.TemporaryDirectory(dir=self.folder) as scratch:
                built = Path(scratch, "library.so")
                self._compile(built, self._needed(path))
                ctypes.CDLL(str(built))  # raises OSError for code of another machine
                built.replace(library)
        return ctypes.CDLL(str(library))

    def _needed(self, path: str) -> list[str]:
        from softimpact.codegen.record.cost_digests import needed_sources

        own, name = self.folder / path, Path(path).stem
        texts = {f"src/{p.name}": p.read_text("utf-8") for p in self.folder.glob("src/*")}
        texts[f"src/{name}.c"] = own.read_text("utf-8")
        others = sorted(needed_sources(PREFIX, texts, name) - {name})
        return [path, *(f"src/{other}.c" for other in others)]

    def _compile(self, out: Path, paths: list[str]) -> None:
        use = f"-D{PREFIX.upper()}_USE_{self.real.upper()}=1"
        folders = [f"-I{self.folder / name}" for name in ("include", "src", "batch")]
        files = [str(self.folder / path) for path in paths]
        reason = ""
        for flags in ((*FLAGS, NATIVE), FLAGS):
            command = [*self.compiler, *flags, use, *folders, *files, "-o", str(out), "-lm"]
            done = subprocess.run(
                command, capture_output=True, text=True, check=False, env=zig_environment()
            )
            if done.returncode == 0:
                return
            reason = next((x for x in done.stderr.splitlines() if "error" in x), done.stderr)
        raise CompilerFailed(" ".join(self.compiler), reason.strip())


def prepared(
    robot: Robot,
    tip: str,
    real: Real,
    drives: Drives | None,
    points: Mapping[str, str],
    gravity: FixedGravity | None = None,
) -> Sources:
    """Return the sources of a robot's package, generated if they are not in the cache.

    Raises:
        NoCompiler: nothing could be made of them.
    """
    compiler = _compiler()
    if compiler is None:
        raise NoCompiler
    numbers = None if drives is None else {k: repr(v) for k, v in asdict(drives).items()}
    asked = [robot.digest(), tip, real, numbers, dict(points), gravity]
    key = hashlib.sha256(json.dumps([softimpact.__version__, _generator(), asked]).encode())
    folder = _cache() / "batch" / key.hexdigest()[:32]
    if not folder.is_dir():
        _generate(folder, robot, tip, real, drives, points, gravity)
    return Sources(folder, real, compiler)


def _compiler() -> tuple[str, ...] | None:
    """Return the words of a C compiler's command line: that of the optimiser, or else Zig's."""
    found = c_compiler()
    if found is None and find_spec("ziglang"):
        return (sys.executable, "-m", "ziglang", "cc")
    return found


def _cache() -> Path:
    """Return the user's cache, or where it cannot be written a folder for this process."""
    return usable_cache() or passing_folder()


@cache
def _generator() -> str:
    """Return a hash of whatever decides what is generated, but for the robot."""
    digest = hashlib.sha256()
    root = Path(softimpact.__file__).parent
    for name in READ:
        for path in sorted((root / name).rglob("*")):
            if path.suffix in (".py", ".jinja", ".c", ".h"):
                digest.update(f"{path.relative_to(root)} ".encode() + path.read_bytes())
    return digest.hexdigest()


@cache
def _processor() -> str:
    """Return what the processor can do, as far as Linux tells it; caches may be on a network."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return platform.processor()
    found = re.search(r"^(?:flags|Features|isa)\s*: (.*)$", text, re.MULTILINE)
    return found[1] if found else ""


def _generate(
    folder: Path,
    robot: Robot,
    tip: str,
    real: Real,
    drives: Drives | None,
    points: Mapping[str, str],
    gravity: FixedGravity | None,
) -> None:
    """Write a package's sources; whoever comes first wins."""
    from softimpact.codegen.package.batch import batch_sources
    from softimpact.codegen.package.generate import package_of
    from softimpact.codegen.package.render import Templates, sources

    package = package_of(
        robot,
        tip=tip,
        real=real,
        name=PREFIX,
        drives=drives,
        gravity=gravity,
        points=points,
        verified=False,
    )
    show = Templates(package)
    files = sources(package, show)
    files |= batch_sources(package, files[f"include/{PREFIX}.h"], show)
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent) as scratch:
        fresh = Path(scratch, "package")
        for path, text in files.items():
            target = fresh / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
        try:
            fresh.rename(folder)
        except OSError:
            if not folder.is_dir():
                raise
