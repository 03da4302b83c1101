# SPDX-License-Identifier: BSD-3-Clause
"""``--report``: one page that opens offline and says what the answer rests on."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from command_line import run, run_json
from pages import well_formed

WHERE = ("panda", "--q", "[0, 0.3, 0, -2, 0, 2, 0.8]", "--direction", "[0, 1, 0]")
IMPACT = ("simulate", *WHERE, "--joint-stiffness", 1e4, "--region", "chest", "--speed", 0.5)


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("report") / "impact.html"
    assert run(*IMPACT, "--report", path).code == 0
    return path.read_text("utf-8")


def test_it_is_one_well_formed_page_that_needs_nothing_else(report: str) -> None:
    assert well_formed(report)


def test_it_gives_the_answer_of_the_json(report: str) -> None:
    found = run_json(*IMPACT)
    assert f"Yes: at most {found['peak']:.0f} N" in report
    assert "May panda hit the chest (held) at 0.5 m/s?" in report
    for word in ("transient force", "two-body formula", "motors keep their speed", "full"):
        assert word in report


def test_it_can_be_read_without_seeing(report: str) -> None:
    pictures = re.findall(r'<svg class="arm"[^>]*>', report, re.DOTALL)
    assert len(pictures) == 1
    assert 'role="img" aria-label="The arm as a stick figure, hit at hand_tcp' in pictures[0]
    assert '<html lang="en">' in report


def test_the_same_question_gives_the_same_bytes(report: str, tmp_path: Path) -> None:
    path = tmp_path / "impact.html"
    run(*IMPACT, "--report", path)
    repeated = re.compile(r"<code>softimpact .*?</code>")
    assert repeated.sub("", path.read_text("utf-8")) == repeated.sub("", report)


def test_a_report_that_cannot_be_written_is_one_line(tmp_path: Path) -> None:
    outcome = run(*IMPACT, "--report", tmp_path / "no" / "impact.html")
    assert outcome.code == 2
    assert "No such file or directory" in outcome.err
