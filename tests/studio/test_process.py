# SPDX-License-Identifier: BSD-3-Clause
"""The installed command, run as a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

COMMAND = Path(sys.executable).with_name("softimpact")
PANDA = ("panda", "--q", "[0, 0.3, 0, -1.8, 0.1, 2, 0.5]", "--direction", "[0, 1, 0]")


def start(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(COMMAND), *arguments], cwd=folder, capture_output=True, text=True, check=False
    )


def test_answers_on_stdout(tmp_path: Path) -> None:
    done = start(tmp_path, "analyze", *PANDA, "--joint-stiffness", "1e4", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["m_c"] > 0
    assert list(tmp_path.iterdir()) == []


def test_complains_on_stderr_without_a_traceback(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text("<mujoco><worldbody><body><joint/><inertial mass='NaN' pos='0 0 0'/></body>")
    done = start(tmp_path, "analyze", str(path), *PANDA[1:])
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"error: {path}: ")
    assert done.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == [path]


def test_version_and_help(tmp_path: Path) -> None:
    assert start(tmp_path, "--version").stdout.strip() == version("softimpact")
    for arguments in ([], ["--help"]):
        done = start(tmp_path, *arguments)
        assert done.returncode == 0
        assert "analyze" in done.stdout


def test_help_does_not_load_the_physics() -> None:
    """So that it answers at once."""
    script = (
        "import sys; from softimpact.cli import main; main(['--help']);"
        "print(sorted({'casadi', 'mujoco', 'numpy', 'matplotlib'} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-1] == "[]"
