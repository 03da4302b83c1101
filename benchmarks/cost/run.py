# SPDX-License-Identifier: BSD-3-Clause
"""Time the Panda's package against other ways to the same numbers, all in one process.

Usage: python benchmarks/cost/run.py [--out docs/benchmarks.md] [--others PYTHON] [--quick]

Contenders: Pinocchio with Eigen in C++, CasADi's code of our own expressions, CasADi's code of what
adam and urdf2casadi make of the robot, and a Runge-Kutta method for impacts. Needs gcc, g++ and the
``pin`` wheel with its headers; Eigen's come from there, from CasADi's wheel, from /usr/include, or
from the folder in the variable EIGEN3_INCLUDE_DIR. adam and urdf2casadi come from the Python of
``--others`` (see ``requirements.txt``), and are left out, visibly, without it.

Exits with 1 if values differ, or M(q) takes more than 0.2 of the time of Pinocchio's crba.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "tests"))

import casadi as ca  # noqa: E402
from arm import numbers, urdf  # noqa: E402
from compiled_packages import Generated  # noqa: E402
from compiling import build_host  # noqa: E402
from expressions import QUANTITIES, SLOW, Quantities, built_on, our_expressions  # noqa: E402
from microcontroller import counts  # noqa: E402
from page import Table, page, processor  # noqa: E402
from samples import impacts, still_samples  # noqa: E402

from softimpact.codegen import generate_package  # noqa: E402
from softimpact.symbolic import Robot, load_robot  # noqa: E402

OTHERS = ROOT / ".venv-others" / "bin" / "python"
ON_MICROCONTROLLERS = ("CasADi", "adam")
TARGET = 0.2
"""Time of M(q) over that of Pinocchio's crba."""


RK4_MASSES = 7
"""Masses of the chain that the Runge-Kutta method of the page starts from."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, help="page to write instead of printing it")
    parser.add_argument("--others", type=Path, default=OTHERS, help="Python with adam, urdf2casadi")
    parser.add_argument("--quick", action="store_true", help="few samples, on a PC only")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        times, text = measure(Path(folder), options.others, options.quick)
    if options.out:
        options.out.write_text(text, encoding="utf-8")
    else:
        print(text, end="")
    ratio = times["mass_matrix"]["ours"] / times["mass_matrix"]["Pinocchio"]
    print(f"M(q) over Pinocchio's crba: {ratio:.3f} (target {TARGET})", file=sys.stderr)
    return 0 if options.quick or ratio <= TARGET else 1


def measure(folder: Path, others: Path, quick: bool) -> tuple[Table, str]:
    """Return times [ns] and the page."""
    robot = load_robot("panda")
    order = RK4_MASSES
    manifest = generate_package(robot, folder / "panda", chain_order=order)
    package = Generated(robot, manifest.tip, folder / "panda", manifest)
    rivals = {"CasADi": our_expressions(robot), **from_others(robot, others, folder)}
    program, compiler = build_host(folder, rivals)
    times = run_host(program, given(robot, order, quick))
    own = {f.name.removeprefix("panda_"): f.flops for f in manifest.functions}
    flops: Table = {
        quantity: {"ours": own[quantity], **{name: q.flops[quantity] for name, q in rivals.items()}}
        for quantity in QUANTITIES
    }
    divided = {
        function.name: function.graph.only(range(len(function.outputs))).count(*SLOW)
        for function in package.functions
    }
    divisions: Table = {
        q: {"ours": divided[q], **{name: rival.divisions[q] for name, rival in rivals.items()}}
        for q in QUANTITIES
    }
    chosen = {name: rival for name, rival in rivals.items() if name in ON_MICROCONTROLLERS}
    found = {} if quick else counts(package, chosen, folder)
    return times, page(processor(), compiler, times, flops, divisions, found)


def run_host(program: Path, given: str) -> Table:
    """Return the times that the program measures once all values agree."""
    done = subprocess.run([program], input=given, text=True, capture_output=True, check=False)
    if done.returncode:
        sys.exit(f"the contenders disagree, or one failed:\n{done.stdout}{done.stderr}")
    times: Table = {}
    for line in done.stdout.splitlines():
        quantity, name, _, nanoseconds = line.split()
        times.setdefault(quantity, {})[name] = float(nanoseconds)
    return times


def given(robot: Robot, order: int, quick: bool) -> str:
    """Return the program's standard input."""
    still, hits = (10, 6) if quick else (100, 24)
    samples = [still_samples(robot, still), impacts(robot, order, hits)]
    lists = "\n".join(f"{len(some)}\n" + "\n".join(map(str, some)) for some in samples)
    return f"{'50 3' if quick else '500 61'}\n{numbers(robot)}\n{lists}\n"


def from_others(robot: Robot, python: Path, folder: Path) -> dict[str, Quantities]:
    """Return what other libraries make of the robot; nothing where they are not installed."""
    if not python.is_file():
        print(f"skipped: adam and urdf2casadi are not installed in {python}", file=sys.stderr)
        return {}
    path = folder / "panda.urdf"
    path.write_text(urdf(robot), encoding="utf-8")
    subprocess.run([python, HERE / "others.py", path, folder], check=True)
    return {
        name: built_on(name, ca.Function.load(str(folder / f"{name}.casadi")))
        for name in ("adam", "urdf2casadi")
    }


if __name__ == "__main__":
    sys.exit(main())
