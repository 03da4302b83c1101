# SPDX-License-Identifier: BSD-3-Clause
"""The studies that come with the package can run: they load, and their bounds can be kept."""

from __future__ import annotations

from pathlib import Path

import pytest

from softimpact.optimize import load_study
from softimpact.optimize.search.reach import require_reachable
from softimpact.optimize.study.study_scenarios import scenarios_of
from softimpact.optimize.study_check import study_problems
from softimpact.robots import FOLDER

STUDIES = sorted((FOLDER / "studies").glob("*.toml"))


def test_there_are_some() -> None:
    assert len(STUDIES) >= 6


@pytest.mark.parametrize("path", STUDIES, ids=lambda path: path.stem)
def test_it_can_run(path: Path) -> None:
    assert study_problems(path) == []
    study = load_study(path)
    scenarios = scenarios_of(study)
    assert len(scenarios) >= len(study.motors)
    if study.scenarios is not None:
        require_reachable(study, scenarios.poses, free=False)
