# SPDX-License-Identifier: BSD-3-Clause
"""Compile all contenders into one program, with the same flags."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import casadi as ca
import pinocchio as pin
from expressions import Quantities

HERE = Path(__file__).parent
FLAGS = ("-O3", "-march=native", "-ffp-contract=fast", "-DNDEBUG")
"""For C and C++ alike; Pinocchio and Eigen are compiled from their headers."""


def build_host(folder: Path, rivals: Mapping[str, Quantities]) -> tuple[Path, str]:
    """Return the program and what compiled it."""
    declare(rivals, folder)
    objects, package = [], folder / "panda"
    includes = [f"-I{package / 'include'}", f"-I{HERE}", f"-I{folder}"]
    for source in [*sorted(package.glob("src/*.c")), HERE / "rk4.c", *sorted(folder.glob("*.c"))]:
        objects.append(folder / f"{source.stem}.o")
        run("gcc", "-std=gnu99", *FLAGS, *includes, "-c", source, "-o", objects[-1])
    program = folder / "host"
    limits = ["-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", "-DBOOST_MPL_LIMIT_LIST_SIZE=30"]
    libraries = [f"-isystem{path}" for path in include_folders()]
    flags = ["-std=c++17", "-w", *FLAGS, *limits, *includes, *libraries]
    run("g++", *flags, HERE / "host.cpp", *objects, "-o", program, "-lm")
    return program, f"{run('g++', '--version').splitlines()[0]}, `{' '.join(FLAGS)}`"


def declare(rivals: Mapping[str, Quantities], folder: Path) -> None:
    """Write CasADi's C code, one file a function, and ``contenders.h``."""
    declarations, entries, work = [], [], 1
    for name, quantities in rivals.items():
        for quantity, function in quantities.functions.items():
            write_c(function, folder)
            work = max(work, function.sz_iw(), function.sz_w())
            arguments = "const double **, double **, long long *, double *, int"
            declarations.append(f"int {function.name()}({arguments});")
            entries.append(f'X("{quantity}", "{name}", {function.name()})')
    lines = ['extern "C" {', *declarations, "}", f"enum {{ WORK = {work} }};"]
    table = f"#define CONTENDERS(X) {' '.join(entries)}"
    (folder / "contenders.h").write_text("\n".join([*lines, table, ""]), encoding="utf-8")


def write_c(function: ca.Function, folder: Path, **options: str) -> Path:
    """Write a function as CasADi does, and return its path."""
    here = Path.cwd()
    try:
        os.chdir(folder)  # CasADi takes a name without folders
        function.generate(f"{function.name()}.c", options)
    finally:
        os.chdir(here)
    return folder / f"{function.name()}.c"


def include_folders() -> list[Path]:
    """Return the folders of Pinocchio's and Eigen's headers."""
    wheel = Path(pin.__file__).parents[4] / "include"
    given = os.environ.get("EIGEN3_INCLUDE_DIR")
    places = [
        *([Path(given)] if given else []),
        wheel / "eigen3",
        Path("/usr/include/eigen3"),
        Path(ca.__file__).parent / "include" / "eigen3",
    ]
    for eigen in places:
        if (eigen / "Eigen" / "Core").is_file():
            return [wheel, eigen]
    sys.exit("no Eigen headers found; set EIGEN3_INCLUDE_DIR")


def run(*command: str | Path) -> str:
    done = subprocess.run(
        [str(c) for c in command], check=False, text=True, stdout=subprocess.PIPE, stderr=None
    )
    if done.returncode:
        sys.exit(f"{command[0]} failed")
    return done.stdout
