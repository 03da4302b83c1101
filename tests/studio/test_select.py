# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact select`` on the Panda's study and on what is wrong with others."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import refusal, run, run_json
from pages import well_formed

from softimpact.robots import FOLDER
from softimpact.studio.design import selection

STUDY = FOLDER / "studies/panda_24_poses.toml"

SMALL = """
[robot]
model = "panda"
rotor_inertia = "menagerie_fr3"
[impact]
region = "head"
direction = [0.0, 1.0, 0.0]
speed = 0.5
[stiffness]
lower = 300.0
upper = 1e5
nominal = 5e3
[accuracy]
forces = [[30.0, 0.0, 0.0]]
max_deflection = 0.001
[task]
pose_of = "low"
[[poses]]
name = "low"
q = [-2.01, 1.76, 0.96, -2.44, -0.51, 2.15, -1.06]
[[poses]]
name = "high"
q = [-1.48, 1.05, 0.89, -2.44, 0.52, 2.15, -1.85]
"""


@pytest.fixture(scope="module")
def selected() -> dict[str, Any]:
    return run_json("select", STUDY)


@pytest.fixture
def study(tmp_path: Path) -> Path:
    path = tmp_path / "small.toml"
    path.write_text(SMALL)
    return path


def test_every_pose_is_ranked_by_peak_force(selected: dict[str, Any]) -> None:
    poses = selected["poses"]
    assert [pose["rank"] for pose in poses] == list(range(1, 25))
    assert {pose["name"] for pose in poses} == {f"q{i}" for i in range(1, 25)}
    force = [pose["peak_force"] for pose in poses]
    assert force == sorted(force)
    assert selected["winner"] == poses[0]["name"]
    assert selected["peak_definition"] == "peak"


def test_figures_are_those_of_analyze_and_simulate(study: Path) -> None:
    springs = ("--joint-stiffness", 5e3, "--rotor-inertia", "menagerie_fr3")
    for pose in run_json("select", study)["poses"]:
        where = ("panda", "--q", pose["q"], "--direction", "[0, 1, 0]", *springs)
        figures = run_json("analyze", *where)
        for key in ("m_c", "k_r", "m_a", "giaf", "directional_giaf"):
            assert pose[key] == pytest.approx(figures[key], rel=1e-9)
        impact = run_json("simulate", *where, "--region", "head", "--speed", 0.5)
        assert pose["peak_force"] == pytest.approx(impact["peak"], rel=1e-9)


def test_poses_turned_about_the_base_are_turned_back(selected: dict[str, Any]) -> None:
    turned = {pose["name"]: pose["turned"] for pose in selected["poses"] if pose["turned"]}
    assert set(turned) == {"q22", "q23", "q24"}
    np.testing.assert_allclose(np.abs(list(turned.values())), 0.31, atol=0.05)


def test_other_criteria(study: Path) -> None:
    for criterion, sign in (("m_c", 1), ("giaf", -1), ("directional_giaf", -1)):
        result = run_json("select", study, "--by", criterion)
        figures = [sign * pose[criterion] for pose in result["poses"]]
        assert figures == sorted(figures)
        assert result["winner"] == result["poses"][0]["name"]


def test_other_models(study: Path) -> None:
    exact = run_json("select", study)["poses"][0]["peak_force"]
    rough = run_json("select", study, "--model", "one_mass")
    assert rough["model"] == "one_mass"
    assert abs(rough["poses"][0]["peak_force"] / exact - 1) > 0.01


def test_table_for_people(study: Path) -> None:
    outcome = run("select", study)
    assert outcome.code == 0
    assert outcome.err == (
        "warning: contact with 'head' is not permitted, whatever the force; its limits are for "
        "reference\n"
    )
    for word in ("low", "high", "GIAF", "peak", "limit"):
        assert word in outcome.out


def test_people_see_the_first_of_many(study: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(selection, "SHOWN", 1)
    shown, whole = run("select", study).out, run("select", study, "--csv").out
    assert "the first 1 of 2; --csv and --json have all" in shown
    assert ("low" in shown) != ("high" in shown)
    assert "low" in whole
    assert "high" in whole


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ('region = "head"', 'region = "toe"', "unknown body region 'toe'; known: "),
        ("speed = 0.5", "speed = -0.5", "impact.speed"),
        ("speed = 0.5", "", "impact.speed"),
        ("lower = 300.0", "lower = 3e6", "lower bound 3e+06 is above the upper"),
        ('model = "panda"', 'model = "pandora"', "'pandora'"),
        ("-2.44, -0.51", "-0.01, -0.51", "outside its limits"),
        ("0.96, -2.44", "nan, -2.44", "poses"),
        ('pose_of = "low"', 'pose_of = "there"', "no pose is named 'there'"),
        ("[robot]", "[robot", "not valid TOML"),
        ("[task]", "[task]\ncolour = 1", "task.colour"),
        ("[0.0, 1.0, 0.0]", "[0.0, 0.0, 0.0]", "direction: must not be zero"),
    ],
)
def test_bad_study(study: Path, old: str, new: str, reason: str) -> None:
    assert SMALL.count(old) == 1
    study.write_text(SMALL.replace(old, new))
    assert reason in refusal("select", study)


@pytest.mark.parametrize(
    ("robot", "reason"),
    [
        ("rmin", "joint 'q11' is elastic, so its rotor needs an inertia greater than 0"),
        ("rr", "its file says that it has none: name it in stiffness.rigid"),
    ],
)
def test_robots_that_a_study_cannot_hold(study: Path, robot: str, reason: str) -> None:
    text = SMALL.replace('model = "panda"', f'model = "{robot}"')
    study.write_text(text.replace('rotor_inertia = "menagerie_fr3"\n', ""))
    assert reason in refusal("select", study)


def test_bad_options(tmp_path: Path, study: Path) -> None:
    assert "no such study file" in refusal("select", tmp_path / "none.toml")
    assert "unknown criterion 'luck'; known: peak_force" in refusal("select", study, "--by", "luck")
    assert "unknown impact model" in refusal("select", study, "--model", "exact")


def test_the_report_is_one_page_with_the_answer(study: Path, tmp_path: Path) -> None:
    path = tmp_path / "select.html"
    outcome = run("select", study, "--report", path)
    assert outcome.code == 0
    page = path.read_text("utf-8")
    assert well_formed(page)
    best = run_json("select", study)["poses"][0]
    assert f"{best['name']}, by peak force: {best['peak_force']:.0f} N" in page
