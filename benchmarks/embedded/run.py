# SPDX-License-Identifier: BSD-3-Clause
"""Count the instructions, code and stack of generated packages on a Cortex-M4F and an M7.

Usage: python benchmarks/embedded/run.py [--all] [ROBOT ...]

Measures what has changed since it was last measured, or everything with ``--all``, and writes
``codegen/record/costs/ROBOT.json`` for each robot (default: all of ``generated/``), from which the
generator fills in README and manifest of a package, and ``docs/embedded.md`` for the Panda.
Needs arm-none-eabi-gcc, newlib and qemu-system-arm. The numbers depend on nothing but the
compiler's version.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from compiled_packages import COMMITTED, Generated, candidate_poses  # noqa: E402
from measured_costs import compiler_version, measure  # noqa: E402

from softimpact.codegen import generate_package  # noqa: E402
from softimpact.codegen.record.costs import COSTS, FEW_STEPS, Costs, FunctionCost  # noqa: E402
from softimpact.symbolic import load_robot  # noqa: E402

PAGE = ROOT / "docs/embedded.md"

CLOCK = 480e6
"""Of a fast Cortex-M7 [Hz]."""

HEAD = """# Cost on a microcontroller

Written by `make bench-c`; float build of `generated/panda`, {compiler},
`{flags}`, instructions counted under QEMU (`-icount shift=0`) over the package's
golden inputs. A division or square root counts as one instruction but takes 14 cycles, and memory
may be slower than the core, so times are what an instruction a cycle would give. Every package has
its own table, in its README and in `manifest.json`.

| function | M4F, instructions | M7, instructions | at most | M7 at 480 MHz | code | stack |
|---|---|---|---|---|---|---|
"""

TAIL = """
Instructions are means over the golden inputs, and the largest of them; those of `safe_speed` are
for each region's own limit, and grow with the number of impacts it integrates. Golden inputs take
motors of all kinds by turns, servos among them, which cost most; *driven* is a call with motors
that drive on for 20 ms, a horizon of 0.1 s and a budget of {steps} steps. Code is `.text` and
constants of the function's own source on the M7, stack the deepest of its calls without the C
library's. What functions share:

| source | code |
|---|---|
"""


def main() -> None:
    """Measure, and write what was found."""
    afresh = "--all" in sys.argv
    for name in [name for name in sys.argv[1:] if name != "--all"] or COMMITTED:
        with tempfile.TemporaryDirectory() as folder:
            costs = measured(name, Path(folder), afresh=afresh)
        (COSTS / f"{name}.json").write_text(costs.to_json(), encoding="utf-8")
        if name == "panda":
            PAGE.write_text(page(costs), encoding="utf-8")
        print(f"{name}: {len(costs.functions)} functions measured")


def measured(name: str, folder: Path, *, afresh: bool) -> Costs:
    """Return the costs of a built-in robot's package; afresh, or what has changed."""
    robot = load_robot(name)
    manifest = generate_package(robot, folder / name, poses=candidate_poses(name, robot))
    known = manifest.costs
    same = known is not None and known.compiler == compiler_version() and not afresh
    generated = Generated(robot, manifest.tip, folder / name, manifest)
    return measure(generated, folder, known.functions if known and same else ())


def page(costs: Costs) -> str:
    """Return the text of the page."""
    rows = [row(function) for function in costs.functions]
    shared = [f"| `{s.name}.c` | {s.text + s.rodata} B |" for s in costs.shared]
    head = HEAD.format(compiler=costs.compiler, flags=costs.flags)
    return head + "\n".join(rows) + "\n" + TAIL.format(steps=FEW_STEPS) + "\n".join(shared) + "\n"


def row(f: FunctionCost) -> str:
    """Return a line of the table."""
    time = f"{f.m7.mean / CLOCK * 1e6:.1f} µs"
    code = f"{f.text + f.rodata} B | {f.stack} B"
    return f"| `{f.name}` | {f.m4.mean} | {f.m7.mean} | {f.m7.most} | {time} | {code} |"


if __name__ == "__main__":
    main()
