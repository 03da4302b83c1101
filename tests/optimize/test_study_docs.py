# SPDX-License-Identifier: BSD-3-Clause
"""docs/study-files.md holds what the code does: its example loads and every field is explained."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path
from types import ModuleType

import pytest
from pydantic import BaseModel

from softimpact.optimize import bounds, load_study, objectives, variables
from softimpact.optimize.bounds import Bound
from softimpact.optimize.members import kinds_in
from softimpact.optimize.objectives import Objective
from softimpact.optimize.study.study_file import (
    AccuracySection,
    HardwareSection,
    ImpactSection,
    MotorsSection,
    ParetoSection,
    PoseSection,
    RobotSection,
    ScenariosSection,
    StiffnessSection,
    StudyFile,
    TaskSection,
)
from softimpact.optimize.variables import Variable
from softimpact.symbolic.body.regions import REGIONS

PAGE = Path(__file__).parents[2] / "docs/study-files.md"
TEXT = PAGE.read_text(encoding="utf-8")


def fields(model: type[BaseModel]) -> list[tuple[str, bool]]:
    """Names of a section's fields and whether they are required."""
    return [(name, field.is_required()) for name, field in model.model_fields.items()]


def section(title: str) -> str:
    """Text under a heading."""
    found = re.search(rf"^## `?{re.escape(title)}`?\n(.*?)(?=^## |\Z)", TEXT, re.M | re.S)
    assert found, title
    return found[1]


def rows(text: str) -> dict[str, str]:
    """Rows of a section's table by the field they explain."""
    return {row[1]: row[0] for row in re.finditer(r"^\| `(\w+)` \|.*$", text, re.M)}


def test_examples_load(tmp_path: Path) -> None:
    examples = re.findall(r"^```toml\n(.*?)^```", TEXT, re.M | re.S)
    assert examples
    for example in examples:
        path = tmp_path / "example.toml"
        path.write_text(example, encoding="utf-8")
        study = load_study(path)
        assert study.title
        assert len(study.poses) > 1


SECTIONS: dict[str, type[BaseModel]] = {
    "[robot]": RobotSection,
    "[impact]": ImpactSection,
    "[motors]": MotorsSection,
    "[hardware]": HardwareSection,
    "[scenarios]": ScenariosSection,
    "[stiffness]": StiffnessSection,
    "[accuracy]": AccuracySection,
    "[pareto]": ParetoSection,
    "[task]": TaskSection,
    "[[poses]]": PoseSection,
}


@pytest.mark.parametrize("title", SECTIONS)
def test_every_field_is_explained(title: str) -> None:
    model = SECTIONS[title]
    explained = rows(section(title))
    assert list(explained) == [name for name, _ in fields(model)]
    for name, required in fields(model):
        assert ("| required |" in explained[name]) == required, name


def test_no_section_is_left_out() -> None:
    named = {*(title.strip("[]") for title in SECTIONS), *rows(section("Top level"))}
    named |= {"bounds", "objective"}  # see below
    assert named == set(StudyFile.model_fields)


def test_regions_are_all_named() -> None:
    assert re.findall(r"`(\w+)`", rows(section("[impact]"))["region"])[1:] == list(REGIONS)


@pytest.mark.parametrize(
    ("package", "base", "title", "pattern"),
    [
        (bounds, Bound, "[bounds]", r"^\| `\[bounds\.(\w+)\]` \|.*$"),
        (variables, Variable, "[hardware]", r"^\| `\[hardware\.(\w+)\]` \|.*$"),
        (objectives, Objective, "[objective]", r"^\| `\"(\w+)\"` \|.*$"),
    ],
)
def test_every_bound_variable_and_objective_is_explained(
    package: ModuleType, base: type, title: str, pattern: str
) -> None:
    kinds = kinds_in(package, base)
    explained = {row[1]: row[0] for row in re.finditer(pattern, section(title), re.M)}
    given_elsewhere = {"deflection", "joint_stiffness"}
    assert set(explained) == set(kinds) - given_elsewhere
    for kind, row in explained.items():
        for field in dataclasses.fields(kinds[kind]):
            if field.name not in ("lower", "upper"):
                assert f"`{field.name}`" in row, (kind, field.name)
