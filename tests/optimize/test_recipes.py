# SPDX-License-Identifier: BSD-3-Clause
"""CONTRIBUTING's recipes for bounds, variables, objectives: a new one is a new file."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from small_arm import small_study

from softimpact.optimize import bounds, objectives, robust_design, scenarios_of, variables
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

OBJECTIVE = """
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from softimpact.optimize.objectives.mean_force import MeanForce


@dataclass(frozen=True)
class RootMeanSquare(MeanForce):
    \"\"\"The root of the mean square of all forces over their limits.\"\"\"

    kind: ClassVar[str] = "rms_force"

    def value(self, own, scenarios, speeds):
        return float((own**2).mean() ** 0.5)

    def cost(self, own, scenarios, speeds):
        return ca.sqrt(ca.sumsqr(own) / own.numel())
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which bounds, variables and objectives are looked for, too."""
    for package in (bounds, variables, objectives):
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


REGIONS = 'regions = ["chest", "hand", "thigh"]'


@pytest.mark.slow
def test_an_objective_is_one_file(folder: Path) -> None:
    """A mean is no more than the root of the mean square, and that no more than the largest."""
    (folder / "objectives/rms.py").write_text(OBJECTIVE, encoding="utf-8")
    least = []
    pool = ThreadPoolExecutor(1)  # other processes would not find the file
    for kind in ("mean_force", "rms_force", "worst_force"):
        tables = '[hardware]\njoint_stiffness = [["turn"], ["lift", "bend"]]\n[objective]\n'
        study = small_study(folder, f"{tables}kind = '{kind}'", scenarios=REGIONS)
        assert study.objective.kind == kind
        least.append(robust_design(study, scenarios_of(study), pool).bound)
    assert least == sorted(least)
    assert len(set(least)) == 3
