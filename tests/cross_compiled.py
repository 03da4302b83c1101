# SPDX-License-Identifier: BSD-3-Clause
"""Generated packages built for other processors, and run under QEMU."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

from compiled_packages import WARNINGS, Generated, run, tool
from sharing import once

BOARD = Path(__file__).parent / "codegen" / "cortex_m"
"""Start-up code, linker script and the program that counts instructions."""

CORES = {
    "m4": ("mps2-an386", ["-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16"]),
    "m7": ("mps2-an500", ["-mcpu=cortex-m7", "-mfpu=fpv5-d16"]),
}
"""QEMU's machine and the compiler's options of each microcontroller."""

GCC = "arm-none-eabi-gcc"

OPTIMISE = ["-O2", "-ffp-contract=fast"]
"""Fused multiply-adds round once less than the host's tests do."""

LINUX = ("aarch64", "riscv64")
"""Processors whose Linux programs QEMU runs on this one."""


def used(package: Generated, real: str) -> list[str]:
    """Return how a package is used: its number type and headers, those of its test included."""
    include = [f"-I{package.folder / folder}" for folder in ("include", "test")]
    return [f"-D{package.manifest.name.upper()}_USE_{real.upper()}=1", *include]


def flags(package: Generated, real: str) -> list[str]:
    """Return what every cross compiler is told."""
    return ["-std=c99", *OPTIMISE, *WARNINGS, *used(package, real)]


def machine(core: str) -> list[str]:
    """Return how the compiler is told of a microcontroller."""
    return [*CORES[core][1], "-mthumb", "-mfloat-abi=hard"]


def run_on_linux(package: Generated, processor: str, real: str, out: Path) -> str:
    """Build a package's own test for a processor, run it under QEMU and return what it says."""
    compiler, emulator = tool(f"{processor}-linux-gnu-gcc"), tool(f"qemu-{processor}")
    sources = [*package.folder.glob("src/*.c"), *package.folder.glob("test/*.c")]
    run(compiler, *flags(package, real), "-static", *sources, "-o", out, "-lm")
    return run(emulator, out)


def build(
    package: Generated, core: str, real: str, out: Path, programs: Sequence[Path] = ()
) -> list[Path]:
    """Compile a package, its golden inputs and programs of its own; return the objects.

    Beside each object the compiler leaves ``.su`` and ``.ci``, the stack that its functions take
    and whom they call.
    """
    own = [*sorted(package.folder.glob("src/*.c")), package.folder / "test/golden.c"]
    return [
        compile_one(package, core, real, out, source)
        for source in [*own, *programs, BOARD / "startup.c"]
    ]


def compile_one(
    package: Generated, core: str, real: str, out: Path, source: Path, *defines: str
) -> Path:
    """Compile one source; return the object.

    The package's own are compiled once in a test run, and put where they are wanted.
    """
    if defines or package.folder not in source.parents:
        return _compiled(package, core, real, out / f"{source.stem}.o", source, *defines)
    shared = package.folder.with_suffix(f".{core}.{real}") / f"{source.stem}.o"
    once(shared, lambda target: str(_compiled(package, core, real, target, source)))
    for file in shared.parent.glob(f"{source.stem}.*"):
        shutil.copy(file, out)
    return out / shared.name


def _compiled(
    package: Generated, core: str, real: str, target: Path, source: Path, *defines: str
) -> Path:
    lenient = ["-Wno-pedantic"] if source.parent == BOARD else []
    told = [*flags(package, real), *machine(core), "-g", "-fcallgraph-info=su", *lenient, *defines]
    run(GCC, *told, "-c", source, "-o", target)
    return target


def link(core: str, objects: Sequence[Path], out: Path) -> Path:
    """Link objects to an image for QEMU's board."""
    image = out / "image.elf"
    script = ["--specs=rdimon.specs", "-nostartfiles", "-T", str(BOARD / "link.ld")]
    run(GCC, *machine(core), *script, *objects, "-o", image, "-lm")
    return image


def run_image(image: Path, core: str) -> str:
    """Run an image, one instruction a nanosecond, and return what it says."""
    return run("qemu-system-arm", "-M", CORES[core][0], "-nographic", "-monitor", "none",
               "-serial", "none", "-semihosting-config", "enable=on,target=native",
               "-icount", "shift=0", "-kernel", image)  # fmt: skip


def undefined_symbols(nm: str, target: Path) -> set[str]:
    """Return the names that an object needs from others."""
    return {line.split()[-1] for line in run(nm, "--undefined-only", target).splitlines()}
