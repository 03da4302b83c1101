# SPDX-License-Identifier: BSD-3-Clause
"""Generated packages on the processors of single-board computers, emulated."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from compiled_packages import COMMITTED, Generated
from cross_compiled import LINUX, run_on_linux

pytestmark = pytest.mark.embedded


@pytest.mark.parametrize("real", ["double", "float"])
@pytest.mark.parametrize("processor", LINUX)
@pytest.mark.parametrize("robot", COMMITTED)
def test_own_test_passes_on_the_processor(
    package: Callable[[str], Generated], robot: str, processor: str, real: str, tmp_path: Path
) -> None:
    said = run_on_linux(package(robot), processor, real, tmp_path / "test")
    assert said.endswith("all passed\n")
