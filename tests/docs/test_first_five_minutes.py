# SPDX-License-Identifier: BSD-3-Clause
"""docs/first-five-minutes.md: its files are written and its commands run, as a reader does."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "first-five-minutes.md").read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"^## (\w+)\b.*?\n(.*?)(?=^## |\Z)", PAGE, re.DOTALL | re.MULTILINE))
BLOCK = re.compile(r'^```(\w+)(?: title="(\S+)")?\n(.*?)^```$', re.DOTALL | re.MULTILINE)
SHIM = """#!{python}
import sys
from softimpact.cli import main
if __name__ == "__main__":  # its workers import it again
    sys.exit(main())
"""


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """A folder in which ``softimpact`` can be called."""
    shim = tmp_path / "bin" / "softimpact"
    shim.parent.mkdir()
    shim.write_text(SHIM.format(python=sys.executable))
    shim.chmod(0o755)
    return tmp_path


def follow(section: str, place: Path) -> str:
    """Do what a section says; return what its commands print."""
    path = f"{place / 'bin'}{os.pathsep}{os.environ['PATH']}"
    printed = ""
    for kind, name, text in BLOCK.findall(section):
        if name:
            (place / name).write_text(text, encoding="utf-8")
        for command in re.findall(r"^\$ (.*)$", text, re.MULTILINE) if kind == "console" else []:
            done = subprocess.run(
                ["bash", "-c", command],
                cwd=place,
                env={**os.environ, "PATH": path},
                capture_output=True,
                text=True,
                check=False,
            )
            assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
            printed += done.stdout
    return printed


def test_there_is_a_section_for_each() -> None:
    assert list(SECTIONS) == ["Control", "Robot", "Cell", "Researcher"]
    commands = re.findall(r"^\$ softimpact (\w+)", PAGE, re.MULTILINE)
    assert set(commands) >= {"generate", "init", "check", "design", "program", "simulate"}
    for command in re.findall(r"^\$ (.*)$", PAGE, re.MULTILINE):
        assert shlex.split(command)


@pytest.mark.slow
def test_control_engineer(place: Path) -> None:
    assert shutil.which("cc"), "a C compiler is needed"
    said = re.search(
        r"^factor ([\d.]+), (\d+) N at most$", follow(SECTIONS["Control"], place), re.M
    )
    assert said
    assert 0 < float(said[1]) < 1
    assert 200 < float(said[2]) <= 280


@pytest.mark.slow
def test_robot_designer(place: Path) -> None:
    said = follow(SECTIONS["Robot"], place)
    assert "nothing is wrong" in said
    assert "Winner: first" in said
    assert (place / "results" / "study" / "results.json").is_file()


@pytest.mark.slow
def test_cell_engineer(place: Path) -> None:
    said = follow(SECTIONS["Cell"], place)
    assert "samples slow down" in said
    assert (place / "cell" / "program.csv").is_file()
    assert "<html" in (place / "hand.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_researcher(place: Path) -> None:
    assert "mass felt at the contact point, m_c" in follow(SECTIONS["Researcher"], place)
