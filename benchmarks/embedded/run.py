# SPDX-License-Identifier: BSD-3-Clause
"""Count the instructions, code and stack of the Panda's package on a Cortex-M4F and an M7.

Usage: python benchmarks/embedded/run.py [--out docs/embedded.md]

Needs arm-none-eabi-gcc, newlib and qemu-system-arm. The numbers depend on nothing but the
compiler's version, which the page names.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from compiled_packages import Generated, run  # noqa: E402
from cross_compiled import Count, build, calls, count, stack_of, text_of  # noqa: E402

from softimpact.codegen import generate_package  # noqa: E402
from softimpact.symbolic import load_robot  # noqa: E402

CLOCK = 480e6
"""Of a fast Cortex-M7 [Hz]."""

INTERNAL = {
    "panda_impact_chain": "chain of an impact",
    "panda_impact_modes": "its modes and their steps",
    "panda_impact": "integration",
    "panda_common": "sines, defaults, texts",
}
"""Sources without a public function."""

HEAD = """# Cost on a microcontroller

Written by `python benchmarks/embedded/run.py`; float build of `generated/panda`, {compiler},
`-O2 -ffp-contract=fast`, instructions counted under QEMU (`-icount shift=0`) over the package's
golden inputs. A division or square root counts as one instruction but takes 14 cycles, and memory
may be slower than the core, so times are what an instruction a cycle would give.

| function | M4F, instructions | M7, instructions | at most | M7 at 480 MHz | code | stack |
|---|---|---|---|---|---|---|
"""

TAIL = """
Instructions are means over the golden inputs, and the largest of them; those of `safe_speed` are
for each region's own limit, and grow with the number of impacts it integrates. Code is `.text` and
constants of the function's own source on the M7, stack the deepest of its calls without the C
library's. What functions share:

| source | code |
|---|---|
"""

CALLED = {
    "panda_peak_force": ["panda_impact_prepare", "panda_impact_chain", "panda_sine_cosine"],
    "panda_safe_speed": ["panda_impact_prepare", "panda_impact_chain", "panda_sine_cosine"],
}
"""Deepest way down from a function; others call ``panda_sine_cosine`` at most."""


def main() -> None:
    """Measure, and print the page or write it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, help="page to write instead of printing it")
    out = parser.parse_args().out
    with tempfile.TemporaryDirectory() as folder:
        page = measure(Path(folder))
    if out:
        out.write_text(page, encoding="utf-8")
    else:
        print(page, end="")


def measure(folder: Path) -> str:
    """Return the page."""
    robot = load_robot("panda")
    manifest = generate_package(robot, folder / "panda")
    package = Generated(robot, manifest.tip, folder / "panda", manifest)
    counts: dict[str, dict[str, Count]] = {}
    for core in ("m4", "m7"):
        (folder / core).mkdir()
        objects = build(package, core, "float", folder / core)
        counts[core] = {
            call.function: count(package, core, objects, call, folder / core)
            for call in calls(package)
        }
    stack, text = stack_of(folder / "m7"), text_of(objects)
    rows = [
        row(name, counts["m4"][name], counts["m7"][name], text[name], depth(name, stack))
        for name in counts["m7"]
    ]
    shared = [f"| `{name}.c`, {what} | {text[name]} B |" for name, what in INTERNAL.items()]
    compiler = run("arm-none-eabi-gcc", "--version").splitlines()[0]
    return HEAD.format(compiler=compiler) + "\n".join(rows) + "\n" + TAIL + "\n".join(shared) + "\n"


def row(name: str, m4: Count, m7: Count, text: int, stack: int) -> str:
    """Return a line of the table."""
    time = f"{m7.mean / CLOCK * 1e6:.1f} µs"
    return f"| `{name}` | {m4.mean} | {m7.mean} | {m7.most} | {time} | {text} B | {stack} B |"


def depth(name: str, stack: dict[str, int]) -> int:
    """Return the stack of a function and the deepest of what it calls."""
    return stack[name] + sum(stack[n] for n in CALLED.get(name, ["panda_sine_cosine"]))


if __name__ == "__main__":
    main()
