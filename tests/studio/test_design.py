# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact design`` on a study of two poses."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from command_line import refusal, run, run_json
from matplotlib.text import Text
from small_arm import small_study as arm_study
from studies import InProcess

from softimpact.optimize import design
from softimpact.studio.design.checks import doubts
from softimpact.studio.design.report import (
    design_record,
    design_report,
    gains_in_words,
    nominal_in_words,
    task_result,
)
from softimpact.studio.figures.gains import figure_of_gains
from softimpact.studio.figures.ranking import figure_of_ranking

Results = tuple[Path, dict[str, Any]]

STUDY = Path(__file__).resolve().parents[2] / "robots" / "studies" / "panda_24_poses.toml"


def small_study(folder: Path, *replacements: tuple[str, str]) -> Path:
    """Write the Panda's study with two of its poses and some lines replaced."""
    head, *poses = STUDY.read_text(encoding="utf-8").split("[[poses]]")
    kept = [pose for pose in poses if '"q9"' in pose or '"q22"' in pose]
    text = "[[poses]]".join([head, *kept])
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new)
    path = folder / "small.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """Return the folder of a design and the object it printed."""
    folder = tmp_path_factory.mktemp("design")
    out = folder / "out"
    outcome = run("design", small_study(folder), "--out", out, "--json")
    assert outcome.code == 0, outcome.err
    return out, json.loads(outcome.out)


def test_results_are_complete(results: Results) -> None:
    out, printed = results
    written = json.loads((out / "results.json").read_text(encoding="utf-8"))
    assert {**written, "out": str(out)} == printed
    assert {"winner", "check", "gains", "safe_speed", "poses", "versions", "study"} <= set(written)
    assert (out / "c" / "include" / "panda.h").is_file()
    assert {path.name for path in out.glob("*.png")} >= {
        "force_over_time.png",
        "ranking.png",
        "postures.png",
    }


def test_poses_are_ranked_and_solved(results: Results) -> None:
    _, record = results
    best = [min(pose["table"]["force"], pose["free"]["force"]) for pose in record["poses"]]
    assert best == sorted(best)
    assert record["winner"]["force"] == best[0]
    assert all(pose[mode]["solved"] for pose in record["poses"] for mode in ("table", "free"))
    turned = {pose["name"]: pose["turned"] for pose in record["poses"]}
    assert turned["q9"] == 0
    assert turned["q22"] == pytest.approx(0.31, abs=0.01)


def test_winner_is_confirmed_by_simulation(results: Results) -> None:
    _, record = results
    check = record["check"]
    assert check["linearised"] == pytest.approx(check["nlp"], rel=1e-3)
    assert check["full"] == pytest.approx(check["nlp"], rel=2e-2)
    assert record["winner"]["meets_limit"] == (record["winner"]["force"] <= record["limit"])


def test_speed_that_meets_the_limit_meets_it(results: Results) -> None:
    _, record = results
    winner = record["winner"]
    found = run_json(
        *("simulate", "panda", "--q", winner["q"], "--direction", "[0, 1, 0]"),
        *("--joint-stiffness", winner["springs"], "--region", "chest"),
        *("--rotor-inertia", "drake_fr3", "--speed", record["safe_speed"]["after"]),
    )
    assert found["peak"] == pytest.approx(record["limit"], rel=1e-5)


def test_gains_add_up(results: Results) -> None:
    _, record = results
    gains = record["gains"]
    assert gains["both"] <= min(gains["springs"], gains["posture"]) * (1 + 1e-3)
    assert gains["before"] >= gains["springs"]


@pytest.mark.slow
def test_tables_say_what_was_found(tmp_path: Path) -> None:
    outcome = run("design", small_study(tmp_path), "--out", tmp_path / "out", "--mode", "table")
    assert outcome.code == 0
    for piece in ("Winner:", "limit", "m/s", "SUNDIALS", "kN·m/rad", "turned about the base"):
        assert piece in outcome.out
    assert "2 of 2 solved" in outcome.out


@pytest.mark.slow
def test_region_and_speed_override_the_study(tmp_path: Path) -> None:
    record = run_json_without_progress(
        *("design", small_study(tmp_path), "--out", tmp_path / "out", "--mode", "table"),
        *("--region", "head", "--speed", 0.5),
    )
    assert (record["region"], record["limit"], record["limit_kind"]) == (
        "head",
        130,
        "quasi_static",
    )
    assert record["study"]["speed"] == 0.5
    assert record["gains"] is None


def run_json_without_progress(*arguments: object) -> dict[str, Any]:
    """Run a command whose progress goes to stderr."""
    outcome = run(*arguments, "--json")
    assert outcome.code == 0, outcome.err
    result = json.loads(outcome.out)
    assert isinstance(result, dict)
    return result


def test_infeasible_study_says_what_can_be_reached_and_keeps_older_results(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "results.json").write_text('{"generator": "softimpact design"}')
    study = small_study(tmp_path, ("max_deflection = 0.001", "max_deflection = 1e-6"))
    outcome = run("design", study, "--out", out, "--json")
    assert outcome.code == 3
    assert "Traceback" not in outcome.err
    message = outcome.err.splitlines()[-1]
    assert re.search(r"below 0\.001 mm in pose 'q\d+': the least that can be reached is", message)
    printed = json.loads(outcome.out)
    assert message == f"error: {printed['error']}"
    assert printed["conflicts"][0] == "accuracy.max_deflection"
    assert printed["least"]["deflection"] > 1e-6
    assert len(printed["least"]["q"]) == len(printed["least"]["springs"]) == 7
    assert (out / "results.json").read_text() == '{"generator": "softimpact design"}'
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []


def test_the_answer_says_what_it_rests_on(results: Results) -> None:
    _, record = results
    assert record["worst_force"] == record["winner"]["force"]
    assert record["worst_scenario"]["motors"] in ("free", "driven")
    assert record["winner"]["deflection"] <= record["study"]["max_deflection"] * (1 + 1e-5)
    assert [motors["kind"] for motors in record["study"]["motors"]] == ["free", "driven"]
    for joint, own in zip(record["study"]["joints"], record["winner"]["springs"], strict=True):
        low, high = record["indifferent"][joint]
        assert low <= own * (1 + 1e-9)
        assert high >= own * (1 - 1e-9)
    assert record["conflicts"] == []
    assert record["reference"]["deflection"] <= record["study"]["max_deflection"] * (1 + 1e-3)
    for pose in record["poses"]:
        kept = pose["deflection_before"] <= record["study"]["max_deflection"]
        assert pose["keeps_bounds_before"] == kept


@pytest.mark.slow
def test_one_machine_for_all_scenarios(tmp_path: Path) -> None:
    study = small_study(tmp_path)
    text = study.read_text(encoding="utf-8")
    table = '[scenarios]\nregions = ["chest", "hand"]\nspeeds = [0.5]\n\n[task]'
    study.write_text(text.replace("[task]", table), encoding="utf-8")
    record = run_json_without_progress("design", study, "--out", tmp_path / "out")
    assert record["certificate"]["scenarios"] == 2 * 2 * 2
    assert record["worst_force"] == pytest.approx(record["check"]["linearised"], rel=1e-3)
    worst = record["worst_scenario"]
    assert record["worst_share"] == pytest.approx(record["worst_force"] / worst["limit"])
    assert record["worst_share"] <= record["equal"]["worst_share"] * (1 + 1e-3)
    assert set(record["indifferent"]) == {f"joint{i}" for i in range(1, 8)}
    assert record["winner"]["deflection"] <= 1e-3 * (1 + 1e-5)
    assert (tmp_path / "out/c/include/panda.h").is_file()


def test_bad_input_is_refused_before_the_search(tmp_path: Path) -> None:
    study = small_study(tmp_path)
    foreign = tmp_path / "foreign"
    foreign.mkdir()
    (foreign / "thesis.tex").write_text("irreplaceable")
    assert "foreign" in refusal("design", study, "--out", foreign)
    assert (foreign / "thesis.tex").read_text() == "irreplaceable"
    blocked = tmp_path / "file"
    blocked.write_text("")
    assert f"{blocked / 'out'}: cannot be written" in refusal(
        "design", study, "--out", blocked / "out"
    )
    assert "table, free, both" in refusal("design", study, "--mode", "quick")
    everybody = small_study(tmp_path, ("[task]", "[scenarios]\n[task]"))
    assert "scenarios.posture says" in refusal("design", everybody, "--mode", "table")
    study = small_study(tmp_path)
    assert "chest" in refusal("design", study, "--region", "elbow")
    assert "speed" in refusal("design", study, "--speed", "-1")
    assert "no such" in refusal("design", tmp_path / "absent.toml")
    bounds = small_study(tmp_path, ("lower = 300.0", "lower = 200000.0"))
    assert "stiffness" in refusal("design", bounds)
    outside = small_study(tmp_path, ("0.63, -0.10, -2.36", "1.90, -0.10, -2.36"))
    assert "outside its limits" in refusal("design", outside)


@pytest.mark.slow
def test_nominal_springs_that_break_a_bound_are_no_reference(tmp_path: Path) -> None:
    """They are marked as such in record, words and figures; gains are over springs that keep it."""
    study = replace(arm_study(tmp_path, deflection=1e-3), scenarios=None)
    report = design_report(design(study, executor=InProcess()))
    task = task_result(report.design)
    reference, gains = report.design.answers.reference, report.design.gains
    assert not task.keeps_before
    assert task.deflection_before > study.max_deflection
    assert reference.deflection == pytest.approx(study.max_deflection, rel=2e-3)
    assert gains is not None
    assert gains.before == reference.force > gains.springs
    record = design_record(report)
    assert [pose["keeps_bounds_before"] for pose in record["poses"]] == [
        pose.result.keeps_before for pose in report.poses
    ]
    words = nominal_in_words(report.design) or ""
    assert "break accuracy.max_deflection in bent" in words
    assert f"{task.force_before:.1f} N" in words
    said = " ".join(gains_in_words(gains, report))
    assert f"{reference.force:.1f} → {gains.springs:.1f} N" in said
    assert "break a bound" in figure_of_gains(report, gains).get_suptitle()
    labels = [text.get_text() for text in figure_of_ranking(report).findobj(Text)]
    assert "before, but nominal springs break a bound there" in labels


def test_an_optimum_that_simulation_contradicts_is_said() -> None:
    assert not doubts(100.0, 100.9, 99.0)
    (line,) = doubts(100.0, 99.0, 101.1)
    assert "simulation finds 101.1 N for the winner, where the optimum has 100.0 N" in line
