# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact pareto`` on a study of two poses: results, tables, figures, and bad input."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace
from html import unescape
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import refusal, run, run_json
from matplotlib.image import imread
from matplotlib.text import Text
from pages import well_formed
from studies import InProcess, changed, study_of, written

from softimpact.optimize import Outcome, SolverFailure, pareto_fronts
from softimpact.studio.figures.pareto import (
    draw_pareto_figures,
    figure_of_fronts,
    figure_of_speeds,
)
from softimpact.studio.figures.pareto_designs import figure_of_designs
from softimpact.studio.front.pareto_record import pareto_record
from softimpact.studio.front.pareto_report import ParetoReport, pareto_report
from softimpact.studio.front.pareto_schema import ParetoResults
from softimpact.studio.front.pareto_words import front_words, in_words, rows
from softimpact.studio.report.pareto_pages import write_pareto_report

POSES = ("q9", "q18")
HEAD: dict[str, dict[str, Any]] = {"impact": {"region": "head"}, "pareto": {"points": 3}}
FRONTS = ("free", "given", "task")


def test_the_published_schema_is_that_of_the_results() -> None:
    published = Path(__file__).parents[2] / "docs/pareto.schema.json"
    schema = json.loads(published.read_text(encoding="utf-8"))
    assert schema == ParetoResults.model_json_schema()


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """The folder of fronts and the object that was printed."""
    folder = tmp_path_factory.mktemp("pareto")
    study = written(folder, changed({"pareto": {"lower": 2e-4}}, POSES))
    out = folder / "out"
    options = ("--points", 3, "--region", "head", "--speed", 0.5)
    outcome = run("pareto", study, "--out", out, *options, "--json")
    assert outcome.code == 0, outcome.err
    return out, json.loads(outcome.out)


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> ParetoReport:
    study = study_of(tmp_path_factory.mktemp("report"), HEAD, POSES)
    return pareto_report(pareto_fronts(study, InProcess()), lambda *_: None)


@pytest.mark.slow
def test_results_are_complete(results: tuple[Path, dict[str, Any]]) -> None:
    out, printed = results
    record = json.loads((out / "results.json").read_text(encoding="utf-8"))
    assert {**record, "out": str(out)} == printed
    assert record["generator"] == "softimpact pareto"
    assert {"versions", "study", "levels", "reference", "held", "unsolved"} <= set(record)
    ParetoResults.model_validate(record)
    assert record["study"]["pareto"] | {"points": 3, "lower": 2e-4} == record["study"]["pareto"]
    assert (record["region"], record["limit"], record["study"]["speed"]) == ("head", 130, 0.5)
    assert record["levels"][0] == 2e-4
    assert set(record["fronts"]) == set(FRONTS)
    assert set(record["held"]) == set(POSES)
    assert record["unsolved"] == {}
    names = {"results.json", "fronts.csv", "report.md"}
    figures = {"fronts.png", "safe_speed.png", "designs.png"}
    assert {path.name for path in out.iterdir()} == names | figures


@pytest.mark.slow
def test_every_point_is_checked(results: tuple[Path, dict[str, Any]]) -> None:
    _, record = results
    for name in FRONTS:
        for point in record["fronts"][name]:
            check = point["check"]
            assert check["nlp"] == point["force"]
            assert check["linearised"] == pytest.approx(check["nlp"], rel=1e-3)
            assert check["full"] == pytest.approx(check["nlp"], rel=2e-2)
            assert point["meets_limit"] == (point["force"] <= record["limit"])
            assert point["status"].startswith("Solve")
            assert point["start"] in POSES


@pytest.mark.slow
def test_safe_speed_meets_the_limit_and_grows_with_deflection(
    results: tuple[Path, dict[str, Any]],
) -> None:
    _, record = results
    points = record["fronts"]["free"]
    assert all(a["safe_speed"] < b["safe_speed"] for a, b in pairwise(points))
    for point in (points[0], points[-1]):
        impact = run_json(
            *("simulate", "panda", "--q", point["q"], "--direction", "[0, 1, 0]"),
            *("--joint-stiffness", point["springs"], "--region", "head"),
            *("--speed", point["safe_speed"]),
        )
        assert impact["peak_force"] == pytest.approx(record["limit"], rel=1e-5)


@pytest.mark.slow
def test_the_table_of_numbers_is_that_of_the_record(
    results: tuple[Path, dict[str, Any]],
) -> None:
    out, record = results
    with (out / "fronts.csv").open(encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file))
    points = [(name, point) for name in FRONTS for point in record["fronts"][name]]
    assert len(table) == len(points)
    for row, (name, point) in zip(table, points, strict=True):
        assert row["front"] == name
        assert float(row["force_N"]) == point["force"]
        assert float(row["deflection_m"]) == point["deflection"]
        assert float(row["safe_speed_m_per_s"]) == point["safe_speed"]
        assert float(row["full_N"]) == point["check"]["full"]
        assert [float(v) for k, v in row.items() if k.startswith("k_s_")] == point["springs"]
        assert [float(v) for k, v in row.items() if k.startswith("q_")] == point["q"]


@pytest.mark.slow
def test_the_page_links_its_figures(results: tuple[Path, dict[str, Any]]) -> None:
    out, _ = results
    page = (out / "report.md").read_text(encoding="utf-8")
    links = re.findall(r"\]\((.+?)\)", page)
    assert len(links) == 3
    assert all((out / link).is_file() for link in links)


@pytest.mark.slow
def test_words(report: ParetoReport) -> None:
    said = " ".join(in_words(report))
    points = report.fronts["free"]
    assert f"from {points[0].point.force:.1f} to {points[-1].point.force:.1f} N" in said
    assert f"{points[-1].safe_speed:.3f} m/s at the soft end" in said
    assert "no accuracy meets the quasi-static limit of 130 N" in said
    assert f"{report.pareto.reference.force:.1f} N" in said
    assert "Ipopt solved all" in said
    assert len(rows(report)) == report.pareto.levels.size
    assert "# " in front_words(report).markdown([])


@pytest.mark.slow
def test_simulation_that_finds_more_is_told(report: ParetoReport) -> None:
    assert not any("simulation" in line for line in pareto_record(report)["warnings"])
    first, *others = report.fronts["task"]
    more = replace(first, check=replace(first.check, full=1.02 * first.point.force))
    doubted = replace(report, fronts={**report.fronts, "task": (more, *others)})
    (line,) = (w for w in pareto_record(doubted)["warnings"] if "simulation" in w)
    assert f"finds {more.check.full:.1f} N for the design of" in line


@pytest.mark.slow
def test_words_about_failures_and_limits(report: ParetoReport) -> None:
    """A level that Ipopt left is told, with its status; a limit that is met, from where on."""
    front = report.pareto.free
    first = front.outcomes[0]
    assert first is not None
    failed = replace(first, solved=False, status="Restoration_Failed")
    broken = replace(front, outcomes=(failed, *front.outcomes[1:]))
    said = " ".join(in_words(replace(report, pareto=replace(report.pareto, free=broken))))
    assert "Ipopt failed at 1 of" in said
    assert "Restoration_Failed" in said
    region = replace(report.study.contact.region, quasi_static_limit=1e4)
    contact = replace(report.study.contact, region=region)
    kinder = replace(report.pareto, study=replace(report.study, contact=contact))
    assert "is met from" in " ".join(in_words(replace(report, pareto=kinder)))


def lines(axes: Any) -> dict[str, Any]:
    return {line.get_label(): line for line in axes.lines}


@pytest.mark.slow
def test_fronts_are_drawn_as_they_are(report: ParetoReport) -> None:
    force, speed = figure_of_fronts(report), figure_of_speeds(report)
    labels = {
        "free": "springs and posture designed",
        "given": "springs designed, best of the 2 given poses",
        "task": "springs designed, q9 held",
    }
    for name, label in labels.items():
        points = report.fronts[name]
        for figure, heights in (
            (force, [p.point.force for p in points]),
            (speed, [p.safe_speed for p in points]),
        ):
            x, y = lines(figure.axes[0])[label].get_data()
            np.testing.assert_allclose(x, [1e3 * p.point.deflection for p in points])
            np.testing.assert_array_equal(y, heights)
    reference = lines(force.axes[0])["before: q9 with nominal springs"]
    assert reference.get_ydata()[0] == report.pareto.reference.force
    assert any("130 N (ISO/TS 15066)" in label for label in lines(force.axes[0]))
    assert "the study's bound, 1 mm" in lines(force.axes[0])


@pytest.mark.slow
def test_a_limit_that_is_near_is_drawn(report: ParetoReport) -> None:
    region = replace(report.study.contact.region, quasi_static_limit=700.0)
    contact = replace(report.study.contact, region=region)
    near = replace(report.pareto, study=replace(report.study, contact=contact))
    (axes,) = figure_of_fronts(replace(report, pareto=near)).axes
    limit = next(line for label, line in lines(axes).items() if "700 N" in label)
    assert set(limit.get_ydata()) == {700.0}
    assert "beyond" not in axes.get_xlabel()


@pytest.mark.slow
def test_designs_are_drawn_joint_by_joint(report: ParetoReport) -> None:
    stiffness, angles = figure_of_designs(report).axes
    points = report.fronts["free"]
    for i, joint in enumerate(report.study.robot.joint_names):
        springs = lines(stiffness)[joint].get_ydata()
        np.testing.assert_allclose(springs, [p.point.outcome.springs[i] for p in points])
        turned = np.radians(lines(angles)[joint].get_ydata()) + report.pareto.reference.q[i]
        np.testing.assert_allclose(turned, [p.point.outcome.q[i] for p in points])


@pytest.mark.slow
def test_figures_are_legible_and_the_same_each_time(report: ParetoReport, tmp_path: Path) -> None:
    for figure in (figure_of_fronts(report), figure_of_speeds(report), figure_of_designs(report)):
        figure.draw_without_rendering()
        shown = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip()]
        assert min(float(text.get_fontsize()) for text in shown) >= 9
        box = figure.get_tightbbox()
        width, height = figure.get_size_inches()
        assert 0 <= box.x0 < box.x1 <= width
        assert 0 <= box.y0 < box.y1 <= height
    folders = [tmp_path / "one", tmp_path / "two"]
    for folder in folders:
        folder.mkdir()
        draw_pareto_figures(report, folder)
    for path in folders[0].iterdir():
        assert imread(path).std() > 0.01
        assert path.read_bytes() == (folders[1] / path.name).read_bytes()


@pytest.mark.long
@pytest.mark.slow
def test_tables_say_what_was_found(tmp_path: Path) -> None:
    study = written(tmp_path, changed(HEAD, ("q9",)))
    outcome = run("pareto", study, "--out", tmp_path / "out", "--points", 3)
    assert outcome.code == 0, outcome.err
    for piece in ("deflection", "Posture:", "m/s", "SUNDIALS", "solved", "the study's 1 mm"):
        assert piece in outcome.out
    assert "simulation of each point" in outcome.err


def test_infeasible_study_fails_with_one_line_and_keeps_older_results(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "results.json").write_text('{"generator": "softimpact pareto"}')
    study = written(tmp_path, changed({"pareto": {"lower": 1e-6}}, ("q9",)))
    outcome = run("pareto", study, "--out", out)
    assert outcome.code == 2
    assert "pareto.lower" in outcome.err.splitlines()[-1]
    assert (out / "results.json").read_text() == '{"generator": "softimpact pareto"}'
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []


def test_solver_failure_has_its_exit_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any, **__: Any) -> None:
        q = np.zeros(1)
        status = "Maximum_Iterations_Exceeded"
        raise SolverFailure([Outcome("q9", "free", status, False, 1, 1, 0.0, q, q, 400.0, 0.0)])

    monkeypatch.setattr("softimpact.optimize.pareto_fronts", fails)
    study = written(tmp_path, changed(HEAD, ("q9",)))
    outcome = run("pareto", study, "--out", tmp_path / "out")
    assert outcome.code == 3
    assert "Maximum_Iterations_Exceeded" in outcome.err
    assert "400.0 N" in outcome.err
    assert not (tmp_path / "out").exists()


def test_bad_input_is_refused_before_the_search(tmp_path: Path) -> None:
    study = written(tmp_path, changed(HEAD, ("q9",)))
    foreign = tmp_path / "foreign"
    foreign.mkdir()
    (foreign / "results.json").write_text('{"generator": "softimpact design"}')
    assert "foreign" in refusal("pareto", study, "--out", foreign)
    assert (foreign / "results.json").read_text() == '{"generator": "softimpact design"}'
    assert "points" in refusal("pareto", study, "--points", 1)
    assert "chest" in refusal("pareto", study, "--region", "elbow")
    assert "no such" in refusal("pareto", tmp_path / "absent.toml")


@pytest.mark.parametrize(
    ("fields", "reason"),
    [
        ({"points": 1}, "pareto.points"),
        ({"points": 2.5}, "pareto.points"),
        ({"lower": -1.0}, "pareto.lower"),
        ({"upper": "soft"}, "pareto.upper"),
        ({"lower": 2e-3, "upper": 1e-3}, "pareto: lower 0.002 must be below upper 0.001"),
        ({"levels": 3}, "pareto.levels"),
    ],
)
def test_fields_of_the_study(tmp_path: Path, fields: dict[str, Any], reason: str) -> None:
    study = written(tmp_path, changed({"pareto": fields}, ("q9",)))
    assert reason in refusal("pareto", study)


@pytest.mark.slow
def test_the_report_is_one_page_with_the_answer(report: ParetoReport, tmp_path: Path) -> None:
    page = write_pareto_report(report, tmp_path / "pareto.html").read_text("utf-8")
    assert well_formed(page)
    assert "What does accuracy cost where panda hits the skull" in page
    for line in in_words(report):
        assert line in unescape(page)
