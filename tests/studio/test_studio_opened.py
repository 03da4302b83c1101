# SPDX-License-Identifier: BSD-3-Clause
"""What ``softimpact studio`` opens, and what it refuses."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import refusal
from compiled_packages import tool

from softimpact.studio.page import module
from softimpact.studio.page.opened import opened
from softimpact.studio.page.package import page_package
from softimpact.studio.page.write import bundled
from softimpact.symbolic import drives, load_robot

ROOT = Path(__file__).parents[2]
STUDY = ROOT / "robots" / "studies" / "panda_24_poses.toml"
PANDA = load_robot("panda")
Q9 = [-1.22, 0.84, 0.72, -2.41, 0.79, 1.97, -2.04]


@pytest.mark.slow
def test_shim_is_clean_c(tmp_path: Path) -> None:
    robot = load_robot("rr")
    files = module.sources_of(page_package(robot, drives(robot, joint_stiffness=1e4)))
    for path, text in files.items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_text(text)
    sources = sorted((tmp_path / "src").glob("page_page*.c"))
    assert len(sources) == 3
    flags = ("-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only")
    compiler = tool("gcc")
    subprocess.run([compiler, *flags, f"-I{tmp_path / 'include'}", *sources], check=True)


def test_scripts_need_nothing_from_a_file(tmp_path: Path) -> None:
    text = bundled()
    assert not re.search(r"^(import|export) ", text, re.MULTILINE)
    assert "</script" not in text


def test_other_things_are_refused_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert "holds no results.json" in refusal("studio", tmp_path)
    (tmp_path / "results.json").write_text('{"generator": "somebody"}')
    assert "no results of design, pareto, program or map" in refusal("studio", tmp_path)
    (tmp_path / "results.json").write_text("{")
    assert "is no JSON" in refusal("studio", tmp_path)
    gone = {"generator": "softimpact pareto", "study": {"source": "gone.toml"}}
    (tmp_path / "results.json").write_text(json.dumps(gone))
    assert "gone.toml, which is not there" in refusal("studio", tmp_path)
    assert "gone.urdf" in refusal("studio", "gone.urdf")
    assert "holds" in refusal("studio", "panda", "--out", ROOT / "docs")
    assert "studies and results have theirs" in refusal("studio", STUDY, "--tip", "hand_tcp")
    assert "nobody" in refusal("studio", "panda", "--tip", "nobody")
    monkeypatch.setattr(module, "find_spec", lambda name: None)
    assert "pip install" in refusal("studio", "rr", "--out", tmp_path / "page")
    assert not (tmp_path / "page").exists()


def test_results_open_at_their_best(tmp_path: Path) -> None:
    point = {"start": "q9", "deflection": 1e-3, "force": 300.0, "springs": [5e3] * 7, "q": Q9}
    record: dict[str, Any] = {
        "generator": "softimpact pareto",
        "study": {"source": str(STUDY)},
        "limit": 280.0,
        "fronts": {"free": [point], "task": [{**point, "force": 310.0}]},
    }
    path = tmp_path / "results.json"
    path.write_text(json.dumps(record))
    found = opened(str(tmp_path))
    assert [(d.front, d.force) for d in found.designs] == [("free", 300.0), ("task", 310.0)]
    assert np.array(found.drives.springs).ravel().tolist() == [5e3] * 7
    design = {"name": "q3", "deflection": 1e-3, "springs": [4e3] * 7, "q": Q9}
    record |= {"generator": "softimpact design", "winner": design, "worst_force": 250.0}
    path.write_text(json.dumps(record))
    assert [(d.name, d.force) for d in opened(str(tmp_path)).designs] == [("q3", 250.0)]


def test_programs_open_at_their_worst_moment(tmp_path: Path) -> None:
    motion = tmp_path / "motion.csv"
    rows = [f"{t},{','.join(str(x + 0.1 * t) for x in Q9)}" for t in range(3)]
    motion.write_text("\n".join([",".join(("t", *PANDA.joint_names)), *rows, ""]))
    program = {
        "generator": "softimpact program", "robot": "panda", "motion": str(motion),
        "joint_stiffness": [None] * 7, "rotor_inertia": [0.5] * 7, "motors": {"driven": {}},
        "clamped": False, "horizon": 0.1,
        "worst": [{"q": Q9, "direction": [0, 0, 1], "speed": 0.7, "region": "hand"}],
    }  # fmt: skip
    path = tmp_path / "results.json"
    path.write_text(json.dumps(program))
    found = opened(str(tmp_path))
    assert (found.speed, found.kind) == (0.7, "driven")
    assert (found.body.region.name, found.body.clamped) == ("hand", False)
    assert found.motion is not None
    assert len(found.motion.time) == 3
    path.write_text(json.dumps({**program, "motion": "gone.csv"}))
    assert "gone.csv is not there" in refusal("studio", tmp_path)


def test_studies_open_in_their_task_and_with_all_poses() -> None:
    found = opened(str(STUDY))
    assert found.q.tolist() == Q9
    assert len(found.postures) == 24
    assert (found.body.region.name, found.speed, found.kind) == ("chest", 1.0, None)
