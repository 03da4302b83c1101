# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact factors-study``: numbers, figures, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import refusal, run
from hypothesis import given
from hypothesis import strategies as st
from oracles import example_urdf
from scipy.stats import spearmanr
from studies import PANDA_24, changed, written

from softimpact.papers.factor_study.agreement import STIFFNESSES, spearman

POSES = """
[[poses]]
name = "low"
q = [-2.01, 1.76, 0.96, -2.44, -0.51, 2.15, -1.06]
[[poses]]
name = "middle"
q = [-1.48, 1.05, 0.89, -2.44, 0.52, 2.15, -1.85]
[[poses]]
name = "high"
q = [-0.96, 0.72, 0.49, -2.39, 0.96, 1.82, -2.15]
"""

PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    text = PANDA_24.read_text(encoding="utf-8").split("[[poses]]")[0]
    path = tmp_path_factory.mktemp("factors") / "small.toml"
    path.write_text(text.replace('pose_of = "q9"', 'pose_of = "low"') + POSES)
    return path


@pytest.fixture(scope="module")
def made(small: Path) -> tuple[dict[str, Any], Path]:
    out = small.parent / "out"
    record = run_json_quietly("factors-study", small, "--out", out)
    return record, out


def run_json_quietly(*arguments: object) -> dict[str, Any]:
    """Like ``run_json`` for a command that tells its progress on stderr."""
    outcome = run(*arguments, "--json")
    assert outcome.code == 0, outcome.err
    record: dict[str, Any] = json.loads(outcome.out)
    return record


@pytest.mark.slow
def test_record(made: tuple[dict[str, Any], Path]) -> None:
    record, _ = made
    assert [pose["name"] for pose in record["poses"]] == ["low", "middle", "high"]
    assert {case["rotors"] for case in record["factors"]} == set(record["rotor_inertia_sets"])
    for case in record["factors"]:
        assert case["tip"] == "hand_tcp"
        assert np.shape(case["single_joint_giaf"]) == (3, 7)
        assert all(0 < zeta < 1 for zeta in case["giaf"])
    for case in record["self_motion"]["figures"]:
        assert case["most_giaf"]["solved"]
        assert case["most_giaf"]["value"] >= max(case["giaf"]) * (1 - 1e-6)
        assert case["least_mass"]["value"] <= min(case["mass_free"]) * (1 + 1e-6)
        assert case["least_force"]["value"] <= min(case["peak_force"]) * (1 + 1e-4)
    assert len(record["agreement"]["cases"]) == 6
    for case in record["agreement"]["cases"]:
        assert np.shape(case["peak_force"]) == (3, len(STIFFNESSES))


@pytest.mark.slow
def test_files(made: tuple[dict[str, Any], Path]) -> None:
    record, out = made
    on_disk = json.loads((out / "results.json").read_text(encoding="utf-8"))
    assert on_disk == {key: value for key, value in record.items() if key != "out"}
    figures = {path.name for path in out.glob("*.png")}
    assert figures == {
        "giaf_of_poses.png",
        "giaf_sweeps_hand_tcp.png",
        "single_joint_giaf.png",
        "directional_giaf.png",
        "postures.png",
        "self_motion_hand_tcp.png",
        "fixed_base_imf.png",
        "rank_correlation.png",
        "giaf_against_force.png",
    }
    assert all((out / name).read_bytes().startswith(PNG) for name in figures)


def test_unknown_tip(small: Path) -> None:
    out = small.parent / "never"
    assert "unknown frame 'nose'" in refusal("factors-study", small, "--out", out, "--tip", "nose")
    assert not out.exists()


def test_foreign_folder_is_left_alone(small: Path, tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("years of work")
    message = refusal("factors-study", small, "--out", tmp_path)
    assert "no earlier results of 'softimpact factors-study'" in message
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_robot_without_redundancy(tmp_path: Path) -> None:
    fields = {"model": str(example_urdf("ur5_robot.urdf")), "tip": "tool0", "rotor_inertia": 0.1}
    study = changed({"robot": fields, "task": {"pose_of": "only"}})
    study["poses"] = [{"name": "only", "q": [0.3, -1.2, 1.4, -0.5, 1.0, 0.2]}]
    message = refusal("factors-study", written(tmp_path, study), "--out", tmp_path / "out")
    assert "no self-motion" in message
    assert not (tmp_path / "out").exists()


def test_missing_study(tmp_path: Path) -> None:
    assert "nowhere.toml" in refusal("factors-study", "nowhere.toml", "--out", tmp_path / "out")


values = st.lists(st.integers(-5, 5), min_size=3, max_size=12)


@given(values, st.randoms(use_true_random=False))
def test_rank_correlation_agrees_with_scipy(first: list[int], random: Any) -> None:
    """Also where values tie; NaN where one does not vary, as SciPy has it."""
    second = [random.randint(-5, 5) for _ in first]
    ours = spearman(np.array(first, dtype=float), np.array(second, dtype=float))
    if len(set(first)) == 1 or len(set(second)) == 1:
        assert np.isnan(ours)
    else:
        assert ours == pytest.approx(spearmanr(first, second).statistic)
