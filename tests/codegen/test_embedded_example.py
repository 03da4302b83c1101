# SPDX-License-Identifier: BSD-3-Clause
"""The control loop of ``examples/embedded`` builds, and keeps its promise."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from compiled_packages import WARNINGS, run, tool

ROOT = Path(__file__).parents[2]
EXAMPLE, PACKAGE = ROOT / "examples/embedded", ROOT / "generated/panda"


def check(said: str) -> None:
    """The loop slows down where it must, by no more than it must."""
    shares = [float(line.split()[2]) for line in said.splitlines()[1:-1]]
    found = re.search(
        r"(\d+) cycles, (\d+) slowed down, highest force ([\d.]+) N, limit ([\d.]+)", said
    )
    assert found, said
    cycles, slowed, force, limit = map(float, found.groups())
    assert 2000 < cycles < 4000
    assert 200 < slowed < cycles
    assert 0.975 * limit < force < limit
    assert min(shares) < 0.9 < max(shares) == 1


@pytest.mark.parametrize("real", ["float", pytest.param("double", marks=pytest.mark.slow)])
def test_control_loop_stays_below_the_limit(tmp_path: Path, real: str) -> None:
    include = [f"-I{PACKAGE / 'include'}", f"-DPANDA_USE_{real.upper()}=1"]
    sources = [EXAMPLE / "main.c", *PACKAGE.glob("src/*.c")]
    binary = tmp_path / "safe_arm"
    run(tool("gcc"), "-std=c99", "-O1", *WARNINGS, *include, *sources, "-o", binary, "-lm")
    check(run(binary))


@pytest.mark.slow
def test_cmake_builds_it_with_the_package_beside_it(tmp_path: Path) -> None:
    cmake = tool("cmake")
    run(cmake, "-S", EXAMPLE, "-B", tmp_path)
    run(cmake, "--build", tmp_path)
    check(run(tmp_path / "safe_arm"))
