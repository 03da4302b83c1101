# SPDX-License-Identifier: BSD-3-Clause
"""Generated packages on microcontrollers, emulated: right, refused where wrong, and affordable."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from compiled_packages import Generated, run
from cross_compiled import build, calls, count, flags, link, run_image

pytestmark = pytest.mark.embedded
EXAMPLE = Path(__file__).parents[2] / "examples/embedded/main.c"


@pytest.fixture(scope="module", autouse=True)
def _tools() -> None:
    for name in ("arm-none-eabi-gcc", "qemu-system-arm"):
        if shutil.which(name) is None:
            pytest.fail(f"needs {name} (Debian: gcc-arm-none-eabi libnewlib-arm-none-eabi, "
                        "qemu-system-arm)")  # fmt: skip


def emulate(package: Generated, core: str, real: str, programs: list[Path], tmp_path: Path) -> str:
    """Build a program for a core, run it under QEMU and return what it says."""
    objects = build(package, core, real, tmp_path, programs)
    return run_image(link(package, core, real, objects, tmp_path), core)


@pytest.mark.parametrize("robot", ["panda", "rr"])
@pytest.mark.parametrize(("core", "real"), [("m4", "float"), ("m7", "float"), ("m7", "double")])
def test_own_test_passes_on_the_core(
    package: Callable[[str], Generated], robot: str, core: str, real: str, tmp_path: Path
) -> None:
    generated = package(robot)
    said = emulate(generated, core, real, [generated.folder / "test/run_tests.c"], tmp_path)
    assert said.endswith("all passed\n")


def test_control_loop_runs_on_the_core(package: Callable[[str], Generated], tmp_path: Path) -> None:
    said = emulate(package("panda"), "m7", "float", [EXAMPLE], tmp_path)
    force, limit = map(float, re.findall(r"force ([\d.]+) N, limit ([\d.]+) N", said)[0])
    assert 0.995 * limit < force < limit


COSTS = {
    ("panda_reflected_mass", "m4"): 1400,
    ("panda_reduced_model", "m4"): 2100,
    ("panda_peak_force", "m7"): 25_000,
    ("panda_safe_speed", "m7"): 48_000,  # 100 µs at 480 MHz and an instruction a cycle
}


@pytest.mark.parametrize(("function", "core"), COSTS)
def test_instructions_of_float_builds(
    package: Callable[[str], Generated], function: str, core: str, tmp_path: Path
) -> None:
    generated = package("panda")
    objects = build(generated, core, "float", tmp_path)
    (call,) = [call for call in calls(generated) if call.function == function]
    found = count(generated, core, objects, call, tmp_path)
    assert 600 < found.mean <= COSTS[function, core]  # not fewer than it has operations
    assert found.mean <= found.most
    if function == "panda_safe_speed":
        assert found.most <= COSTS[function, core]


def test_no_soft_float_is_left_in_float_builds(
    package: Callable[[str], Generated], tmp_path: Path
) -> None:
    generated = package("panda")
    for source in generated.folder.glob("src/*.c"):
        target = tmp_path / f"{source.stem}.o"
        run("arm-none-eabi-gcc", *flags(generated, "m4", "float"), "-c", source, "-o", target)
        needed = set(re.findall(r" U (\w+)", run("arm-none-eabi-nm", target)))
        needed = {name for name in needed if not name.startswith("panda_")}
        assert needed <= {"sinf", "cosf", "sqrtf", "fmaxf", "powf", "logf", "memset", "memcpy"}
