# SPDX-License-Identifier: BSD-3-Clause
"""Inputs on which a safe speed takes most instructions of a Cortex-M7, by hill climbing.

Usage: PYTHONPATH=tests python -m adversarial.instructions [--turns N] [--steps N] [--motors N]
           [--seed N] [ROBOT ...]

Float builds, counted under QEMU. Every turn changes each of ``CLIMBS`` inputs; those that take more
instructions stay. ``--motors`` as in C's enumeration; driven ones if it is left out.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from compiled_impacts import DRIVEN
from compiled_packages import Generated
from cross_compiled import BOARD, build, compile_one, link, run_image
from measured_costs import Call

from softimpact.codegen.record.costs import FEW_STEPS
from softimpact.symbolic.robot.rigid import Array

from .cases import Cases
from .draw import Draw
from .impacts import Robot
from .questions import FIELDS
from .robots import package_of
from .search import pick

CLIMBS = 100
"""That go on side by side: inputs of one image."""

TABLE = """#include "NAME.h"
static const struct {
    NAME_real q[JOINTS], n[3], limit;
    NAME_region region;
    NAME_params p;
} hard[] = {
ROWS
};
"""


class Counter:
    """Counts the instructions of safe speeds of a package.

    Args:
        package: whose float build is counted.
        folder: for what is compiled.
    """

    def __init__(self, package: Generated, folder: Path) -> None:
        self.package, self.folder = package, folder
        self.objects = build(package, "m7", "float", folder)

    def __call__(self, cases: Cases) -> Array:
        """Return the instructions of each case's safe speed."""
        name = self.package.manifest.name
        rows = ",\n".join(self._row(cases, k) for k in range(len(cases)))
        table = TABLE.replace("NAME", name).replace("JOINTS", str(cases.q.shape[1]))
        (self.folder / "hard.h").write_text(table.replace("ROWS", rows), encoding="utf-8")
        full = f"{name}_safe_speed"
        text = f"{full}(in->q, in->n, in->limit, &in->region, &in->p, &({full}_t){{0}})*0"
        call = Call(full, text, "hard", rounds=2)
        include = f"-include{self.folder / 'hard.h'}"
        counter = compile_one(
            self.package, "m7", "float", self.folder, BOARD / "count.c", *call.defines, "-DEACH",
            include,
        )  # fmt: skip
        said = run_image(link("m7", [*self.objects, counter], self.folder), "m7").split()
        return np.array([float(number) for number in said[: len(cases)]])

    def _row(self, cases: Cases, k: int) -> str:
        name = self.package.manifest.name.upper()
        region = {
            "stiffness": cases.stiffness[k],
            "damping": cases.damping[k],
            "effective_mass": cases.mass[k] or 1.0,
            "hertz_stiffness": cases.skin[k],
        }
        body = [f".{field} = {float(x)!r}f" for field, x in region.items()]
        p = [f".layout = {name}_LAYOUT"]
        for field in self.package.interface.structs["params"].fields:
            values = getattr(cases, FIELDS.get(field.name, field.name), None)
            if values is not None:
                p.append(f".{field.name} = {_number(values[k])}")
        return (
            f"{{ {_list(cases.q[k])}, {_list(cases.n[k])}, {float(cases.limit[k])!r}f, "
            f"{{ {', '.join(body)}, .clamped = {int(cases.mass[k] == 0)} }}, "
            f"{{ {', '.join(p)} }} }}"
        )


def _list(values: Iterable[float]) -> str:
    return "{" + ", ".join(f"{float(x)!r}f" for x in values) + "}"


def _number(value: Array | np.integer) -> str:
    if isinstance(value, np.ndarray):
        return _list(value)
    return str(int(value)) if isinstance(value, np.integer) else f"{float(value)!r}f"


def climb(counter: Counter, draw: Draw, turns: int, steps: int, motors: int) -> tuple[Array, Cases]:
    """Return the inputs at which the climbs end, and their instructions."""

    def allowed(cases: Cases) -> Cases:
        count = len(cases)
        kinds, budgets = np.full(count, motors, np.int32), np.full(count, steps, np.int32)
        return replace(cases, motors=kinds, steps=budgets)

    cases = allowed(draw.cases(CLIMBS))
    most = counter(cases)
    for _ in range(turns):
        others = allowed(draw.changed(cases))
        found = counter(others)
        better = found > most
        most = np.where(better, found, most)
        cases = pick(better, others, cases)
    return most, cases


def main(arguments: Sequence[str] | None = None) -> int:
    """Climb, and say what was found."""
    parser = argparse.ArgumentParser(description=str(__doc__).split("\n", maxsplit=1)[0])
    parser.add_argument("robots", nargs="*", default=["panda"], metavar="ROBOT")
    parser.add_argument("--turns", type=int, default=30)
    parser.add_argument("--steps", type=int, default=FEW_STEPS)
    parser.add_argument("--motors", type=int, choices=range(4), default=DRIVEN)
    parser.add_argument("--seed", type=int, default=1)
    told = parser.parse_args(arguments)
    for name in told.robots:
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            package = package_of(name, root / name)
            robot = Robot(package, root)
            counter = Counter(package, root)
            for wide in (False, True):
                random = np.random.default_rng([told.seed, int(wide)])
                draw = Draw(robot, random, wide=wide)
                most, cases = climb(counter, draw, told.turns, told.steps, told.motors)
                hardest = int(most.argmax())
                print(
                    f"{name}, {'wide' if wide else 'plain'}: {(told.turns + 1) * CLIMBS} inputs, "
                    f"at most {most.max():.0f} instructions\n  {cases.row(hardest)}",
                    flush=True,
                )
    return 0


if __name__ == "__main__":
    sys.exit(main())
