# SPDX-License-Identifier: BSD-3-Clause
"""Functions as machine code: compiled once by the C compiler, kept in a cache.

Without a C compiler everything runs in CasADi's virtual machine, about ten times slower.
"""

from __future__ import annotations

import ctypes
import hashlib
import logging
import os
import platform
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import casadi as ca
from platformdirs import user_cache_path

LOGGER = logging.getLogger(__name__)

Command = tuple[str, ...]
"""Words of a command line."""

WELL_KNOWN = [["cc"], ["gcc"], ["clang"]]

FLAGS = ("-O2", "-fPIC", "-shared", "-fno-math-errno")


def c_compiler() -> Command | None:
    """Return the C compiler: $CC, or the first of cc, gcc and clang; None if there is none.

    $CC may be a command of several words, such as ``ccache gcc``.
    """
    named = os.environ.get("CC")
    commands = [[named], shlex.split(named, posix=os.name != "nt")] if named else WELL_KNOWN
    for first, *others in filter(None, commands):
        found = shutil.which(first)
        if found:
            return (found, *others)
    return None


def cache_folder() -> Path | None:
    """Return the folder of compiled functions: $SOFTIMPACT_CACHE, or the user's cache.

    None for a user without a home.
    """
    named = os.environ.get("SOFTIMPACT_CACHE")
    if named:
        return Path(named)
    try:
        found = user_cache_path("softimpact", appauthor=False)
    except RuntimeError:
        return None
    return found if found.is_absolute() else None  # older versions of platformdirs return ~


def compiled_functions(functions: Sequence[ca.Function], compiler: Command | None) -> Path | None:
    """Return a shared library of functions, compiled if it is not in the cache.

    Args:
        functions: to be loaded by ``casadi.external`` under their names.
        compiler: the C compiler, None for none.

    Returns:
        Path of the library; None without a compiler, or if it fails (a broken toolchain must not
        stop the design).
    """
    folder = cache_folder()
    if compiler is None or folder is None:
        LOGGER.info(
            "no %s: impacts run in CasADi's virtual machine", "cache" if compiler else "C compiler"
        )
        return None
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            return _compile(functions, compiler, folder, Path(scratch))
    except OSError as error:
        LOGGER.info("impacts run in CasADi's virtual machine: %s", error)
        return None


def _compile(
    functions: Sequence[ca.Function], compiler: Command, folder: Path, scratch: Path
) -> Path | None:
    generator = ca.CodeGenerator("functions.c")
    for function in functions:
        generator.add(function)
    generator.generate(f"{scratch}{os.sep}")
    source = scratch / "functions.c"
    key = hashlib.sha256(source.read_bytes())
    key.update(" ".join([*compiler, *FLAGS, sys.platform, platform.machine()]).encode())
    library = folder / f"impact_{key.hexdigest()[:24]}.so"
    if library.exists():
        LOGGER.info("take compiled impacts from %s", library)
    else:
        LOGGER.info("compile impacts with %s into %s", compiler[0], library)
        built = scratch / "functions.so"
        command = [*compiler, *FLAGS, str(source), "-o", str(built), "-lm"]
        if subprocess.run(command, capture_output=True, check=False).returncode != 0:
            LOGGER.info("the compiler failed: impacts run in CasADi's virtual machine")
            return None
        ctypes.CDLL(str(built))  # raises OSError for code of another machine
        built.replace(library)
    return library
