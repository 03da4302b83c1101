# SPDX-License-Identifier: BSD-3-Clause
"""Functions as machine code: compiled once by the C compiler, kept in a cache.

Without a C compiler everything runs in CasADi's virtual machine, about ten times slower.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import casadi as ca

FLAGS = ("-O2", "-fPIC", "-shared", "-fno-math-errno")


def c_compiler() -> str | None:
    """Return the C compiler: $CC, or the first of cc, gcc and clang; None if there is none."""
    named = os.environ.get("CC")
    candidates = [named] if named else ["cc", "gcc", "clang"]
    return next((found for name in candidates if (found := shutil.which(name))), None)


def cache_folder() -> Path:
    """Return the folder of compiled functions: $SOFTIMPACT_CACHE, or the user's cache."""
    named = os.environ.get("SOFTIMPACT_CACHE")
    if named:
        return Path(named)
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "softimpact"


def compiled_functions(functions: Sequence[ca.Function], compiler: str | None) -> Path | None:
    """Return a shared library of functions, compiled if it is not in the cache.

    Args:
        functions: to be loaded by ``casadi.external`` under their names.
        compiler: the C compiler, None for none.

    Returns:
        Path of the library; None without a compiler, or if it fails (a broken toolchain must not
        stop the design).
    """
    if compiler is None:
        return None
    folder = cache_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            return _compile(functions, compiler, folder, Path(scratch))
    except OSError:
        return None


def _compile(
    functions: Sequence[ca.Function], compiler: str, folder: Path, scratch: Path
) -> Path | None:
    generator = ca.CodeGenerator("functions.c")
    for function in functions:
        generator.add(function)
    generator.generate(f"{scratch}{os.sep}")
    source = scratch / "functions.c"
    key = hashlib.sha256(source.read_bytes())
    key.update(" ".join([compiler, *FLAGS, sys.platform, platform.machine()]).encode())
    library = folder / f"impact_{key.hexdigest()[:24]}.so"
    if not library.exists():
        built = scratch / "functions.so"
        command = [compiler, *FLAGS, str(source), "-o", str(built), "-lm"]
        if subprocess.run(command, capture_output=True, check=False).returncode != 0:
            return None
        ctypes.CDLL(str(built))  # raises OSError for code of another machine
        built.replace(library)
    return library
