# SPDX-License-Identifier: BSD-3-Clause
"""The examples run and say what the command line says."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from command_line import run_json
from pages import well_formed

from softimpact.robots import FOLDER

EXAMPLES = Path(__file__).parents[2] / "examples"


def printed(script: Path, folder: Path) -> list[str]:
    """Run an example; return the lines it prints."""
    assert len(script.read_text().splitlines()) <= 25
    done = subprocess.run(
        [sys.executable, "-W", "error", script],
        cwd=folder,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.splitlines()


@pytest.mark.slow
def test_analyze_panda(tmp_path: Path) -> None:
    lines = printed(EXAMPLES / "01_analyze_panda.py", tmp_path)
    assert [float(line.split()[1]) for line in lines] == [3e4, 1e4, 3e3]
    where = ("--q", "[0.2, 0.3, -0.4, -1.8, 0.1, 2.0, 0.5]", "--direction", "[0, 1, 0]")
    impact = ("--region", "chest", "--speed", 1, "--safe-speed")
    for line in lines:
        stiffness = float(line.split()[1])
        expected = run_json("simulate", "panda", *where, *impact, "--joint-stiffness", stiffness)
        speed = float(re.findall(r"([\d.]+) m/s", line)[0])
        assert speed == pytest.approx(expected["safe_speed"], abs=0.006)


@pytest.mark.slow
def test_pareto_panda(tmp_path: Path) -> None:
    lines = printed(EXAMPLES / "04_pareto_panda.py", tmp_path)
    numbers = [[float(number) for number in re.findall(r"\d+\.\d+", line)] for line in lines]
    *front, before = numbers
    deflections, forces = zip(*front, strict=True)
    assert list(deflections) == sorted(deflections)
    assert list(forces) == sorted(forces, reverse=True)
    assert deflections[0] == 0.2
    assert 1.0 in deflections
    ranked = run_json("select", FOLDER / "studies/panda_24_poses.toml")["poses"]
    nominal = next(pose["peak_force"] for pose in ranked if pose["name"] == "q9")
    assert before[1] == pytest.approx(nominal, abs=0.1)


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("notebooks/*.py")), ids=lambda p: p.stem)
def test_notebooks_run_and_show_their_results(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MPLBACKEND", "Agg")
    cells = re.split(r"^# %%.*$", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
    space: dict[str, Any] = {}
    shown = []
    for cell in cells:
        *first, last = ast.parse(cell).body or ast.parse("pass").body
        exec(compile(ast.Module(first, []), str(path), "exec"), space)
        if isinstance(last, ast.Expr):
            shown.append(eval(compile(ast.Expression(last.value), str(path), "eval"), space))
        else:
            exec(compile(ast.Module([last], []), str(path), "exec"), space)
    tables = [x._repr_html_() for x in shown if hasattr(x, "_repr_html_")]
    assert len(tables) >= 2
    for table in tables:
        assert well_formed(table)
        assert table.count("<tr>") >= 2
