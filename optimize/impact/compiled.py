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
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import casadi as ca

from softimpact.toolchain import Command, cache_folder

LOGGER = logging.getLogger(__name__)

FLAGS = ("-O2", "-fPIC", "-shared", "-fno-math-errno")


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
    if library.exists() and _loads(library):
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


def _loads(library: Path) -> bool:
    """Return whether a library in the cache is whole, and of this machine."""
    try:
        ctypes.CDLL(str(library))
    except OSError:
        return False
    return True
