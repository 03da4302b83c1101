# SPDX-License-Identifier: BSD-3-Clause
"""Generated packages on microcontrollers, emulated: right, refused where wrong, and affordable."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from compiled_packages import WARNINGS, Generated, run

BOARD = Path(__file__).parent / "cortex_m"
CORES = {
    "m4": ("mps2-an386", ["-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16"]),
    "m7": ("mps2-an500", ["-mcpu=cortex-m7", "-mfpu=fpv5-d16"]),
}
pytestmark = pytest.mark.embedded


@pytest.fixture(scope="module", autouse=True)
def _tools() -> None:
    for name in ("arm-none-eabi-gcc", "qemu-system-arm"):
        if shutil.which(name) is None:
            pytest.fail(f"needs {name} (Debian: gcc-arm-none-eabi libnewlib-arm-none-eabi, "
                        "qemu-system-arm)")  # fmt: skip


def flags(package: Generated, core: str, real: str) -> list[str]:
    """Return what the cross compiler is told."""
    name = package.manifest.name.upper()
    machine = [*CORES[core][1], "-mthumb", "-mfloat-abi=hard"]
    use = [f"-D{name}_USE_{real.upper()}=1", f"-I{package.folder / 'include'}"]
    return ["-std=c99", "-O2", "-ffp-contract=fast", *WARNINGS, *machine, *use]


def emulate(
    package: Generated, core: str, real: str, programs: list[Path], tmp_path: Path, *defines: str
) -> str:
    """Build a program for a core, run it under QEMU and return what it says."""
    gcc, image = "arm-none-eabi-gcc", tmp_path / "image.elf"
    tests = f"-I{package.folder / 'test'}"
    sources = [*package.folder.glob("src/*.c"), package.folder / "test/golden.c", *programs]
    objects = []
    for source in [*sources, BOARD / "startup.c"]:
        lenient = ["-Wno-pedantic"] if source.parent == BOARD else []
        objects.append(tmp_path / f"{source.stem}.o")
        run(gcc, *flags(package, core, real), *lenient, *defines, tests, "-c", source,
            "-o", objects[-1])  # fmt: skip
    script = ["--specs=rdimon.specs", "-nostartfiles", "-T", str(BOARD / "link.ld")]
    run(gcc, *flags(package, core, real), *script, *objects, "-o", image, "-lm")
    return run("qemu-system-arm", "-M", CORES[core][0], "-nographic", "-monitor", "none",
               "-serial", "none", "-semihosting-config", "enable=on,target=native",
               "-icount", "shift=0", "-kernel", image)  # fmt: skip


@pytest.mark.parametrize("robot", ["panda", "rr"])
@pytest.mark.parametrize(("core", "real"), [("m4", "float"), ("m7", "float"), ("m7", "double")])
def test_own_test_passes_on_the_core(
    package: Callable[[str], Generated], robot: str, core: str, real: str, tmp_path: Path
) -> None:
    generated = package(robot)
    said = emulate(generated, core, real, [generated.folder / "test/run_tests.c"], tmp_path)
    assert said.endswith("all passed\n")


COSTS = {
    "panda_reflected_mass(in->q, in->n, &(panda_real){0})": 1500,
    "panda_reduced_model(in->q, in->n, &in->p, &(panda_reduced_model_t){0})": 2100,
}


@pytest.mark.parametrize("call", COSTS)
def test_instructions_on_a_cortex_m4f(
    package: Callable[[str], Generated], call: str, tmp_path: Path
) -> None:
    said = emulate(package("panda"), "m4", "float", [BOARD / "count.c"], tmp_path, f"-DCALL={call}")
    found = re.search(r"instructions: (\d+)", said)
    assert found
    assert 600 < int(found[1]) <= COSTS[call]  # not fewer than it has operations


def test_no_soft_float_is_left_in_float_builds(
    package: Callable[[str], Generated], tmp_path: Path
) -> None:
    generated = package("panda")
    for source in generated.folder.glob("src/*.c"):
        target = tmp_path / f"{source.stem}.o"
        run("arm-none-eabi-gcc", *flags(generated, "m4", "float"), "-c", source, "-o", target)
        needed = set(re.findall(r" U (\w+)", run("arm-none-eabi-nm", target)))
        assert needed <= {"sinf", "cosf", "sqrtf", "fmaxf", "memset", "panda_sine_cosine"}
