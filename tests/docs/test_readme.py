# SPDX-License-Identifier: BSD-3-Clause
"""What the README shows beside Python: its C program and its commands."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest
from command_line import run

from softimpact.symbolic import analyse, drives, impact_model, load_robot

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"^\$ softimpact (.+)$", README, re.MULTILINE)
(PROGRAM,) = re.findall(r"^```c\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)


def test_c_program_prints_what_python_computes(tmp_path: Path) -> None:
    compiler = shutil.which("cc") or shutil.which("gcc")
    assert compiler is not None, "a C compiler is needed"
    source, program = tmp_path / "main.c", tmp_path / "main"
    source.write_text(PROGRAM)
    package = ROOT / "generated" / "panda"
    sources = [str(path) for path in sorted(package.glob("src/*.c"))]
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", f"-I{package / 'include'}"]
    subprocess.run([compiler, *flags, source, *sources, "-o", program, "-lm"], check=True)
    printed = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    panda = load_robot("panda")
    model = impact_model(panda, drives=drives(panda, 3000.0))
    found = analyse(model, [-1.22, 0.84, 0.72, -2.41, 0.79, 1.97, -2.04], [0.0, 1.0, 0.0])
    assert printed == f"m_c = {found.m_c:.2f} kg, k_r = {found.k_r:.0f} N/m\n"


def test_readme_shows_commands() -> None:
    assert {command.split()[0] for command in COMMANDS} >= {"robots", "analyze", "simulate"}


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_run(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    assert run(*shlex.split(command)).code == 0
