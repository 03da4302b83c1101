# SPDX-License-Identifier: BSD-3-Clause
"""What the README shows beside Python: its C program and its commands."""

from __future__ import annotations

import contextlib
import io
import json
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest
from command_line import run

from softimpact.symbolic import body_region

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"^\$ softimpact (.+)$", README, re.MULTILINE)
PYTHON = re.findall(r"^```python\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)[0]
(PROGRAM,) = re.findall(r"^```c\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)


def test_c_and_python_print_the_speed_that_the_page_states(tmp_path: Path) -> None:
    compiler = shutil.which("cc") or shutil.which("gcc")
    assert compiler is not None, "a C compiler is needed"
    source, program = tmp_path / "main.c", tmp_path / "main"
    source.write_text(PROGRAM)
    package = ROOT / "generated" / "panda"
    sources = [str(path) for path in sorted(package.glob("src/*.c"))]
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", f"-I{package / 'include'}"]
    subprocess.run([compiler, *flags, source, *sources, "-o", program, "-lm"], check=True)
    printed = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    speed, force = map(float, re.findall(r"^([\d.]+) m/s: (\d+) N at most$", printed)[0])
    assert f"Both say {speed:.2f} m/s." in README
    limit = body_region("chest").transient_limit
    assert limit is not None
    assert force < limit
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(PYTHON, {})
    assert f"; {speed:.2f} m/s keep every limit" in said.getvalue()


def test_readme_says_what_safe_speeds_cost() -> None:
    costs = json.loads((ROOT / "generated/panda/manifest.json").read_text())["costs"]["functions"]
    mean = {f["name"].removeprefix("panda_safe_speed"): f["m7"]["mean"] / 1e6 for f in costs}
    said = re.search(r"([\d.]+) million instructions.*?([\d.]+) million for driven", README, re.S)
    assert said is not None
    assert [float(x) for x in said.groups()] == [round(mean[x], 2) for x in ("", " (driven)")]


def test_readme_shows_commands() -> None:
    assert {command.split()[0] for command in COMMANDS} >= {"robots", "analyze", "simulate"}


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_run(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    assert run(*shlex.split(command)).code == 0
