# SPDX-License-Identifier: BSD-3-Clause
"""Generated packages on microcontrollers, emulated: right, and in single precision only."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from compiled_packages import COMMITTED, Generated, tool
from cross_compiled import build, compile_one, link, run_image, undefined_symbols

pytestmark = pytest.mark.embedded
EXAMPLE = Path(__file__).parents[2] / "examples/embedded/main.c"
SOFT_FLOAT = ("__aeabi_d", "__aeabi_f2d", "__aeabi_i2d", "__aeabi_ui2d", "__aeabi_l2d")
"""What double operations become on a core that has none."""

FLOAT_CALLS = {
    *("sinf", "cosf", "sqrtf", "fmaxf", "fminf", "cbrtf", "powf", "logf", "expf"),
    *("memset", "memcpy"),
}


@pytest.fixture(scope="module", autouse=True)
def _tools() -> None:
    tool("arm-none-eabi-gcc")
    tool("qemu-system-arm")


def emulate(package: Generated, core: str, real: str, programs: list[Path], tmp_path: Path) -> str:
    """Build a program for a core, run it under QEMU and return what it says."""
    objects = build(package, core, real, tmp_path, programs)
    return run_image(link(core, objects, tmp_path), core)


@pytest.mark.parametrize("robot", COMMITTED)
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
    assert 0.975 * limit < force < limit


@pytest.mark.parametrize("robot", COMMITTED)
def test_no_soft_float_is_left_in_float_builds(
    package: Callable[[str], Generated], robot: str, tmp_path: Path
) -> None:
    generated = package(robot)
    for source in generated.folder.glob("src/*.c"):
        target = compile_one(generated, "m4", "float", tmp_path, source)
        needed = undefined_symbols("arm-none-eabi-nm", target)
        assert not {name for name in needed if name.startswith(SOFT_FLOAT)}
        needed = {name for name in needed if not name.startswith(f"{robot}_")}
        assert needed <= FLOAT_CALLS


def test_soft_float_would_be_noticed(package: Callable[[str], Generated], tmp_path: Path) -> None:
    source = tmp_path / "slip.c"
    source.write_text(
        "float slip(float x);\nfloat slip(float x) { return (float)(0.1*(double)x); }\n"
    )
    generated = package("rr")
    relaxed = compile_one(generated, "m4", "float", tmp_path, source, "-Wno-double-promotion")
    needed = undefined_symbols("arm-none-eabi-nm", relaxed)
    assert {"__aeabi_f2d", "__aeabi_dmul"} <= needed
