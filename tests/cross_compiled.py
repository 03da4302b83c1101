# SPDX-License-Identifier: BSD-3-Clause
"""Generated packages built for a Cortex-M, run under QEMU, and measured there."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from compiled_packages import WARNINGS, Generated, run

BOARD = Path(__file__).parent / "codegen" / "cortex_m"
"""Start-up code, linker script and the program that counts instructions."""

CORES = {
    "m4": ("mps2-an386", ["-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16"]),
    "m7": ("mps2-an500", ["-mcpu=cortex-m7", "-mfpu=fpv5-d16"]),
}
"""QEMU's machine and the compiler's options of each core."""

GCC = "arm-none-eabi-gcc"


def flags(package: Generated, core: str, real: str) -> list[str]:
    """Return what the cross compiler is told."""
    name = package.manifest.name.upper()
    machine = [*CORES[core][1], "-mthumb", "-mfloat-abi=hard"]
    use = [f"-D{name}_USE_{real.upper()}=1", f"-I{package.folder / 'include'}"]
    return ["-std=c99", "-O2", "-ffp-contract=fast", *WARNINGS, *machine, *use]


def build(
    package: Generated, core: str, real: str, out: Path, programs: Sequence[Path] = ()
) -> list[Path]:
    """Compile a package, its golden inputs and programs of its own; return the objects.

    Beside each object the compiler leaves ``.su``, the stack that its functions take.
    """
    own = [*sorted(package.folder.glob("src/*.c")), package.folder / "test/golden.c"]
    return [
        compile_one(package, core, real, out, source)
        for source in [*own, *programs, BOARD / "startup.c"]
    ]


def compile_one(
    package: Generated, core: str, real: str, out: Path, source: Path, *defines: str
) -> Path:
    """Compile one source; return the object."""
    target = out / f"{source.stem}.o"
    lenient = ["-Wno-pedantic"] if source.parent == BOARD else []
    tests = f"-I{package.folder / 'test'}"
    command = [*flags(package, core, real), "-fstack-usage", *lenient, *defines, tests]
    run(GCC, *command, "-c", source, "-o", target)
    return target


def link(package: Generated, core: str, real: str, objects: Sequence[Path], out: Path) -> Path:
    """Link objects to an image for QEMU's board."""
    image = out / "image.elf"
    script = ["--specs=rdimon.specs", "-nostartfiles", "-T", str(BOARD / "link.ld")]
    run(GCC, *flags(package, core, real), *script, *objects, "-o", image, "-lm")
    return image


def run_image(image: Path, core: str) -> str:
    """Run an image, one instruction a nanosecond, and return what it says."""
    return run("qemu-system-arm", "-M", CORES[core][0], "-nographic", "-monitor", "none",
               "-serial", "none", "-semihosting-config", "enable=on,target=native",
               "-icount", "shift=0", "-kernel", image)  # fmt: skip


@dataclass(frozen=True)
class Call:
    """A call of a function on its golden inputs."""

    function: str
    text: str
    impact: bool

    @property
    def defines(self) -> list[str]:
        """What ``count.c`` needs to know."""
        kind = "impact" if self.impact else "input"
        part, clamped = ("(x).part", "(x).clamped") if self.impact else ("0", "0")
        prefix = self.function.split("_")[0]
        return [
            f"-DCALL={self.text}",
            f"-DINPUT={prefix}_golden_{kind}",
            f"-DINPUTS={prefix}_golden_{kind}s",
            f"-DPART(x)={part}",
            f"-DCLAMPED(x)={clamped}",
        ]


def calls(package: Generated) -> list[Call]:
    """Return a call of each function of a package; safe speeds are asked for regions' limits."""
    name, found = package.manifest.name, []
    for function in package.functions:
        full = f"{name}_{function.name}"
        arguments = ["in->q"]
        arguments += ["in->n"] if function.direction else []
        arguments += [f"in->{scalar.name}" for scalar in function.scalars]
        arguments += ["&in->p"] if function.parameters else []
        if len(function.outputs) > 1:
            arguments.append(f"&({full}_t){{0}}")
        else:
            shape = "".join(f"[{size}]" for size in function.outputs[0].shape)
            zero = "{{0}}" if len(function.outputs[0].shape) == 2 else "{0}"
            arguments.append(f"{'' if shape else '&'}({name}_real{shape}){zero}")
        found.append(Call(full, f"{full}({', '.join(arguments)})", impact=False))
    if package.manifest.impact:
        for short, number in (("peak_force", "in->speed"), ("safe_speed", "region->force_limit")):
            full = f"{name}_{short}"
            text = f"{full}(in->q, in->n, {number}, region, &in->p, &({full}_t){{0}})"
            found.append(Call(full, text, impact=True))
    return found


@dataclass(frozen=True)
class Count:
    """Instructions of a call, on average over the golden inputs and at most."""

    mean: int
    most: int


def count(package: Generated, core: str, objects: Sequence[Path], call: Call, out: Path) -> Count:
    """Count the instructions of a call in a float build."""
    counter = compile_one(package, core, "float", out, BOARD / "count.c", *call.defines)
    said = run_image(link(package, core, "float", [*objects, counter], out), core)
    numbers = re.search(r"instructions: (\d+), at most (\d+)", said)
    assert numbers, said
    return Count(int(numbers[1]), int(numbers[2]))


def stack_of(out: Path) -> dict[str, int]:
    """Return the stack [bytes] of each function compiled into a folder, without what it calls."""
    stack = {}
    for file in sorted(out.glob("*.su")):
        for line in file.read_text().splitlines():
            place, size, kind = line.split("\t")
            assert kind == "static", line  # no array whose length is not known
            stack[place.rsplit(":", 1)[1]] = int(size)
    return stack


def text_of(objects: Sequence[Path]) -> dict[str, int]:
    """Return the size of code and constants [bytes] of each object by its name."""
    said = run("arm-none-eabi-size", *objects)
    rows = [line.split() for line in said.splitlines()[1:]]
    return {Path(row[5]).stem: int(row[0]) for row in rows}
