# SPDX-License-Identifier: BSD-3-Clause
"""Results on disk: a run that is ended goes on where it was, to the same answer."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_arm import small_study
from studies import InProcess

from softimpact.optimize import Design, Study, design
from softimpact.optimize.running.execution import Execution
from softimpact.optimize.running.journal import Journal
from softimpact.symbolic import InvalidValue

TWO = '[hardware]\njoint_stiffness = "equal"\n'


class Ended(Exception):
    """Stands for Ctrl-C or a power cut."""


class Few(InProcess):
    """Runs so many jobs, then is ended."""

    def __init__(self, jobs: int) -> None:
        self.left = jobs

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        if fn.__name__ != "_load":
            self.left -= 1
            if self.left < 0:
                raise Ended
        return super().submit(fn, *args, **kwargs)


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    return small_study(tmp_path_factory.mktemp("journal"), TWO)


@pytest.fixture(scope="module")
def whole(study: Study) -> Design:
    return design(study, ["table"], InProcess())


Opened = Callable[..., Journal]


@pytest.fixture
def journal() -> Iterator[Opened]:
    """Open journals, which are closed after the test."""
    with ExitStack() as stack:

        def opened(path: Path, jobs: int, *, resume: bool) -> Journal:
            return stack.enter_context(Journal(path, Few(jobs), resume=resume))

        yield opened


def test_what_was_found_is_not_sought_again(
    tmp_path: Path, study: Study, whole: Design, journal: Opened
) -> None:
    path = tmp_path / "run.jsonl"
    with pytest.raises(Ended):
        design(study, ["table"], journal(path, 1, resume=False))
    again = journal(path, 1, resume=True)
    found = design(study, ["table"], again)  # the second of two poses is left
    assert (again.known, again.used) == (1, 1)
    assert found.winner.force == whole.winner.force
    for a, b in zip(found.outcomes("table"), whole.outcomes("table"), strict=True):
        np.testing.assert_array_equal(a.springs, b.springs)
    last = journal(path, 0, resume=True)
    assert design(study, ["table"], last).winner.force == whole.winner.force
    assert last.used == 2


def test_a_line_that_was_cut_off_is_lost(tmp_path: Path, study: Study, journal: Opened) -> None:
    path = tmp_path / "run.jsonl"
    design(study, ["table"], journal(path, 2, resume=False))
    text = path.read_text(encoding="utf-8")
    path.write_text(text[:-20], encoding="utf-8")
    again = journal(path, 1, resume=True)
    assert again.known == 1
    design(study, ["table"], again)
    assert len(path.read_text(encoding="utf-8").splitlines()) == 3


def test_another_study_finds_nothing(tmp_path: Path, study: Study, journal: Opened) -> None:
    path = tmp_path / "run.jsonl"
    design(study, ["table"], journal(path, 2, resume=False))
    other = small_study(tmp_path, TWO, deflection=3e-3)
    again = journal(path, 2, resume=True)
    design(other, ["table"], again)
    assert (again.known, again.used) == (2, 0)


@pytest.mark.parametrize("text", ["not one", '{"a": 1}', "[]"])
def test_another_file_is_left_alone(tmp_path: Path, text: str, journal: Opened) -> None:
    path = tmp_path / "run.jsonl"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InvalidValue, match="is no journal"):
        journal(path, 1, resume=True)
    assert path.read_text(encoding="utf-8") == text


def test_lines_are_json(tmp_path: Path, study: Study, journal: Opened) -> None:
    path = tmp_path / "run.jsonl"
    design(study, ["table"], journal(path, 2, resume=False))
    lines = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    assert {line["result"]["name"] for line in lines[1:]} == {"bent", "far"}


def test_execution_that_cannot_be() -> None:
    with pytest.raises(InvalidValue, match="--workers: must be at least 1"):
        Execution(processes=0)
    with pytest.raises(InvalidValue, match="excludes --dask"):
        Execution(processes=2, address="tcp://here:1")
