# SPDX-License-Identifier: BSD-3-Clause
"""CONTRIBUTING's recipes for bounds and variables, followed: a new one is a new file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from small_arm import small_study

from softimpact.optimize import bounds, variables
from softimpact.optimize.evaluation import equipped, kept

BOUND = """
from dataclasses import dataclass
from typing import ClassVar

from softimpact.optimize.bounds import AtMost


@dataclass(frozen=True)
class Height(AtMost):
    \"\"\"Square of the tip's distance from the first axis.\"\"\"

    kind: ClassVar[str] = "reach"
    unit: ClassVar[str] = "m²"

    most: float

    def figures(self, machine, q):
        J = machine.jacobian(q)
        return J[0, 0] ** 2 + J[1, 0] ** 2
"""

VARIABLE = """
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from softimpact.optimize.variables import Range, Variable


@dataclass(frozen=True)
class Softening(Variable):
    \"\"\"One factor on all springs.\"\"\"

    kind: ClassVar[str] = "softening"
    unit: ClassVar[str] = "1"
    moves: ClassVar[tuple[str, ...]] = ("springs",)

    lower: float

    def range(self, model):
        one = np.ones(1)
        return Range(("all springs",), self.lower * one, one, one)

    def apply(self, hardware, values):
        return replace(hardware, springs=hardware.springs * values)
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which bounds and variables are looked for, too."""
    for package in (bounds, variables):
        place = tmp_path / package.__name__.rpartition(".")[2]
        place.mkdir()
        monkeypatch.setattr(package, "__path__", [*package.__path__, str(place)])
    return tmp_path


def test_a_bound_is_one_file(folder: Path) -> None:
    (folder / "bounds/reach_of_tip.py").write_text(BOUND, encoding="utf-8")
    study = small_study(folder, "[bounds.reach]\nmost = 0.5")
    q = study.task_pose.q
    found = kept(study, q, study.nominal)[-1]
    assert (found.name, found.unit) == ("bounds.reach.most", "m²")
    J = np.array(study.model.jacobian(q))
    assert found.figure == pytest.approx(np.sum(J[:2, 0] ** 2))
    assert found.share == pytest.approx(found.figure / 0.5)


def test_a_variable_is_one_file(folder: Path) -> None:
    (folder / "variables/softening.py").write_text(VARIABLE, encoding="utf-8")
    study = small_study(folder, "[hardware.softening]\nlower = 0.5")
    assert study.range.names[-1] == "softening of all springs"
    softer = equipped(study, study.nominal, np.array([0.6])).springs
    np.testing.assert_allclose(np.array(softer).ravel(), 0.6 * study.nominal)
