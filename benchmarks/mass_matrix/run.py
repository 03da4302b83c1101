# SPDX-License-Identifier: BSD-3-Clause
"""Time the generated M(q) of the Panda against Pinocchio's crba in C++, both in one process.

Usage: python benchmarks/mass_matrix/run.py [--json]

Needs gcc, g++ and the ``pin`` wheel with its headers. Eigen's come from there, from CasADi's
wheel, from /usr/include/eigen3, or from the folder in the variable EIGEN3_INCLUDE_DIR. Both sides
are compiled with -O3 for the processor's baseline, on which the wheel's libraries rely as well.
Exits with 1 if the two matrices differ or the ratio misses the target.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import casadi as ca
import numpy as np
import pinocchio as pin

from softimpact.symbolic import Robot, load_robot

HERE = Path(__file__).parent
PACKAGE = HERE.parents[1] / "generated" / "panda"
CONFIGURATIONS = 100
TOLERANCE = 1e-12
TARGET = 0.3


def include_folders() -> list[Path]:
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


def description(robot: Robot) -> str:
    """Return the robot and random configurations as numbers for the program."""
    numbers: list[float] = [robot.n]
    for joint in robot.joints:
        body = joint.inertia
        com = body.first_moment / body.mass
        steiner = body.mass * (com @ com * np.eye(3) - np.outer(com, com))
        numbers += [*joint.placement.rotation.flat, *joint.placement.translation]
        numbers += [body.mass, *com, *(body.about_origin - steiner).flat]
    q = np.random.default_rng(0).uniform(*robot.limits, (CONFIGURATIONS, robot.n))
    numbers += [CONFIGURATIONS, *q.flat]
    return " ".join(repr(float(x)) if x != int(x) else str(int(x)) for x in numbers)


def build(folder: Path) -> Path:
    ours, program = folder / "ours.o", folder / "crba"
    package = f"-I{PACKAGE / 'include'}"
    source = PACKAGE / "src" / "panda_mass_matrix.c"
    run("gcc", "-std=c99", "-O3", package, "-c", source, "-o", ours)
    includes = [f"-isystem{folder}" for folder in include_folders()]
    limits = ["-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", "-DBOOST_MPL_LIMIT_LIST_SIZE=30"]
    flags = ["-std=c++17", "-O3", "-DNDEBUG", *limits, package, *includes]
    run("g++", *flags, HERE / "crba.cpp", ours, "-o", program, "-lm")
    return program


def run(*command: str | Path) -> None:
    subprocess.run([str(c) for c in command], check=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    as_json = parser.parse_args().json
    with tempfile.TemporaryDirectory() as folder:
        program = build(Path(folder))
        done = subprocess.run(
            [str(program)], input=description(load_robot("panda")), text=True,
            capture_output=True, check=True,
        )  # fmt: skip
    difference, ours, local, world = map(float, done.stdout.split())
    ratio = ours / min(local, world)
    result = {
        "difference": difference,
        "generated_ns": ours,
        "pinocchio_local_ns": local,
        "pinocchio_world_ns": world,
        "ratio": ratio,
        "target": TARGET,
    }
    if as_json:
        print(json.dumps(result))
    else:
        print(f"largest relative difference of M(q): {difference:.1e}")
        print(f"generated C:          {ours:6.0f} ns")
        print(f"Pinocchio crba LOCAL: {local:6.0f} ns")
        print(f"Pinocchio crba WORLD: {world:6.0f} ns")
        print(f"ratio to the faster:  {ratio:6.3f} (target {TARGET})")
    return 0 if difference < TOLERANCE and ratio <= TARGET else 1


if __name__ == "__main__":
    sys.exit(main())
