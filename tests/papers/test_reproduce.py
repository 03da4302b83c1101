# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact reproduce``: verdicts, the page, and what it refuses."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pytest
from command_line import refusal
from matplotlib.colors import to_rgb

from softimpact.optimize.running.workers import cores
from softimpact.papers.msm.compare import Comparison, compared, grid_points
from softimpact.papers.msm.compute import Results, compute
from softimpact.papers.msm.figures import STYLE, draw
from softimpact.papers.msm.ladder import LADDER
from softimpact.papers.msm.ladder_figures import BARS
from softimpact.papers.msm.page import msm_page
from softimpact.papers.msm.scenarios import RR, SCENARIOS

PNG = b"\x89PNG\r\n"


@pytest.fixture(scope="module")
def results() -> Results:
    """Scenario (a) alone, on the paper's grid alone."""
    return compute(("a",), between=0)


@pytest.fixture(scope="module")
def comparisons(results: Results) -> list[Comparison]:
    return compared(results)


def of(comparisons: list[Comparison], what: str) -> Comparison:
    found = [line for line in comparisons if what in line.what]
    assert len(found) == 1
    return found[0]


@pytest.mark.slow
def test_verdicts_follow_from_the_numbers(comparisons: list[Comparison]) -> None:
    assert of(comparisons, "m_a").verdict == "agrees"
    assert of(comparisons, "m_a").difference == pytest.approx(0.2, abs=0.05)
    swapped = of(comparisons, "peak force, chest")
    assert (swapped.printed, swapped.verdict) == (152, "misprint")
    assert swapped.ours == pytest.approx(125.3, abs=0.1)
    assert of(comparisons, "peak force, head").verdict == "agrees"
    chest = of(comparisons, "two masses (paper), mean error of the first peak, chest")
    assert chest.verdict == "not determined by the text"
    assert chest.difference == pytest.approx(chest.ours - chest.printed)
    decoupling = of(comparisons, "isolated")
    assert decoupling.verdict == "agrees"
    assert 4056 < decoupling.ours < 6164


@pytest.mark.slow
def test_the_page_shows_every_number_and_figure(
    results: Results, comparisons: list[Comparison], tmp_path: Path
) -> None:
    captions = draw(results, tmp_path)
    text = msm_page(results, comparisons, captions)
    assert text.count("| input") + text.count("| agrees") + text.count("| misprint") + text.count(
        "| not deter"
    ) == len(comparisons)
    shown = re.findall(r"\]\((\S+\.png)\)", text)
    assert sorted(shown) == sorted(path.name for path in tmp_path.iterdir())
    assert {name[:5] for name in shown} == {"fig05", "fig06", "fig07", "fig08", "fig09", "ladde"}
    assert all((tmp_path / name).read_bytes().startswith(PNG) for name in shown)


def test_bars_of_errors_are_told_apart() -> None:
    assert list(BARS) == list(LADDER)[:-1]
    with mpl.rc_context(STYLE):
        assert len({to_rgb(colour) for colour in BARS.values()}) == len(BARS)


def reproduced(paper: str, out: Path) -> dict[str, Any]:
    start = "from softimpact.cli import main; raise SystemExit(main())"
    done = subprocess.run(
        [sys.executable, "-c", start, "reproduce", "--paper", paper, "--out", str(out), "--json"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    record: dict[str, Any] = json.loads(done.stdout)
    return record


@pytest.mark.long
@pytest.mark.slow
def test_the_whole_paper(tmp_path: Path) -> None:
    out = tmp_path / "msm"
    record = reproduced("msm", out)
    assert record["verdicts"]["misprint"] == 1
    assert record["verdicts"]["agrees"] >= 46
    assert sum(record["verdicts"].values()) == len(record["comparisons"]) == 101
    figures = {path.stem[:5] for path in out.glob("fig*.png")}
    assert figures == {f"fig{number:02}" for number in (5, 6, 7, 8, 9, 12, 13, 14, 15)}
    kept = json.loads((out / "results.json").read_text())
    assert kept["comparisons"] == record["comparisons"]
    assert sorted(kept["sweeps"]) == list("abcdef")
    assert (out / "report.md").read_text().count("![") == 11


@pytest.mark.long
@pytest.mark.slow
def test_the_paper_on_impact_factors(tmp_path: Path) -> None:
    """39 statements: six for each of two tips and three sets of rotors, and one a set on bases."""
    out = tmp_path / "giaf"
    found = reproduced("giaf", out)["giaf"]
    assert len(found["statements"]) == 39
    others = [x for x in found["statements"] if x["verdict"] != "holds"]
    assert {x["source"] for x in others} == {"Fig. 3", "Fig. 4"}
    assert all("base's axes" in x["claim"] for x in others if x["source"] == "Fig. 4")
    assert all(x["tip"] == "flange" for x in others if x["source"] == "Fig. 3")
    assert [path.name for path in out.iterdir() if path.is_file()] == ["results.json"]
    text = (out / "giaf" / "report.md").read_text()
    shown = re.findall(r"\]\((\S+\.png)\)", text)
    assert sorted(shown) == sorted(path.name for path in (out / "giaf").glob("*.png"))
    assert len(shown) == 11
    assert text.count("| holds |") == found["verdicts"]["holds"]


def test_unknown_papers_are_refused(tmp_path: Path) -> None:
    message = refusal("reproduce", "--out", tmp_path / "out", "--paper", "iso")
    assert "'iso'" in message
    assert "giaf" in message


def test_unknown_scenarios_are_refused(tmp_path: Path) -> None:
    out = tmp_path / "msm"
    message = refusal("reproduce", "--out", out, "--scenarios", "ag")
    assert "'g'" in message
    assert "a, b, c, d, e, f" in message
    assert not out.exists()


def test_foreign_folders_are_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("keep")
    assert "choose another folder" in refusal("reproduce", "--out", tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_there_are_no_more_processes_than_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    class Stop(Exception):
        pass

    asked = []

    def workers(count: int) -> None:
        asked.append(count)
        raise Stop

    monkeypatch.setattr("softimpact.papers.msm.compute.workers", workers)
    with pytest.raises(Stop):
        compute()
    assert asked == [cores()]


def test_a_folder_to_write_into_is_needed() -> None:
    assert "--out" in refusal("reproduce")


def test_finer_sweeps_hold_the_papers_grid() -> None:
    fine, coarse = RR.stiffnesses(2), RR.stiffnesses()
    assert len(fine) == 34
    assert grid_points(list(fine)) == pytest.approx(list(coarse))
    assert coarse[5] == pytest.approx(4056, abs=0.5)
    assert SCENARIOS["f"].arm.stiffnesses()[3] == pytest.approx(351, abs=0.5)
