# SPDX-License-Identifier: BSD-3-Clause
"""The examples run and say what the command line says."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import run_json

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_analyze_panda(tmp_path: Path) -> None:
    script = EXAMPLES / "analyze_panda.py"
    assert len(script.read_text().splitlines()) <= 25
    done = subprocess.run(
        [sys.executable, "-W", "error", script],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )
    lines = done.stdout.splitlines()
    assert [float(line.split()[1]) for line in lines] == [3e4, 1e4, 3e3]
    where = ("--q", "[0.2, 0.3, -0.4, -1.8, 0.1, 2.0, 0.5]", "--direction", "[0, 1, 0]")
    impact = ("--region", "chest", "--speed", 1, "--safe-speed")
    for line in lines:
        stiffness = float(line.split()[1])
        expected = run_json("simulate", "panda", *where, *impact, "--joint-stiffness", stiffness)
        speed = float(re.findall(r"([\d.]+) m/s", line)[0])
        assert speed == pytest.approx(expected["safe_speed"], abs=0.006)
