# SPDX-License-Identifier: BSD-3-Clause
"""What tests of reading files share."""

from __future__ import annotations

from pathlib import Path

import pytest
from robot_files import Read

from softimpact.symbolic import Robot, load_robot


@pytest.fixture
def read(tmp_path: Path) -> Read:
    """Load a robot from text."""

    def load(text: str, suffix: str = ".xml", *, tip: str | None = None) -> Robot:
        path = tmp_path / f"robot{suffix}"
        path.write_text(text, encoding="utf-8")
        return load_robot(path, tip)

    return load
