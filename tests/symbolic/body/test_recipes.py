# SPDX-License-Identifier: BSD-3-Clause
"""CONTRIBUTING's recipes for what is hit, followed: nothing but the file they name is touched."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from softimpact.symbolic import Contact, body_region
from softimpact.symbolic.body import laws, tables
from softimpact.symbolic.body.body_file import load_cover
from softimpact.symbolic.body.pads import read_pads
from softimpact.symbolic.body.regions import read_areas, read_regions

ROOT = Path(__file__).resolve().parents[3]
DATA = ROOT / "symbolic" / "body" / "data"

LAW = """
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from softimpact.symbolic.body.laws.law import Law


@dataclass(frozen=True)
class Gel(Law):
    stiffness: float

    kind: ClassVar[str] = "gel"
    parameters: ClassVar[tuple[str, ...]] = ("stiffness",)

    def force(self, depth):
        return self.stiffness * (ca.exp(ca.fmax(depth, 0) / 1e-3) - 1)
"""


def test_a_law_is_one_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "gel.py").write_text(LAW)
    (tmp_path / "cover.toml").write_text('[law]\nkind = "gel"\nstiffness = 5.0\n')
    monkeypatch.setattr(laws, "__path__", [*laws.__path__, str(tmp_path)])
    chest = body_region("chest")
    padded = Contact(chest, cover=load_cover(tmp_path / "cover.toml"))
    assert 0 < padded.force(1e-3) < Contact(chest).force(1e-3)


@pytest.fixture
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a copy of the tables that is read in their place."""
    copy = tmp_path / "data"
    shutil.copytree(DATA, copy)
    monkeypatch.setattr(tables, "DATA", copy)
    return copy


def add(table: Path, line: str) -> None:
    with table.open("a", encoding="utf-8") as file:
        file.write(line + "\n")


def test_a_region_and_its_area_are_a_line_each(data: Path) -> None:
    add(data / "regions.csv", "foot,Feet,yes,80,75,120,240,")
    add(data / "areas.csv", "heel,Heel,foot,200,400,1")
    regions = read_regions()
    heel = read_areas(regions)["heel"]
    assert regions["foot"].force_limit == 240
    assert (heel.stiffness, heel.quasi_static_limit, heel.transient_pressure) == (80e3, 120, 4e6)
    assert regions["foot"].energy_limit is None


def test_a_pad_is_a_line(data: Path) -> None:
    add(data / "pads.csv", "sh50,50,5,7,9e6")
    pad = read_pads()["sh50"]
    assert (pad.hardness, pad.thickness, pad.law.stiffness) == (55, 7e-3, 9e6)


def test_contributing_names_what_is_there() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    for name in ("regions.csv", "areas.csv", "pads.csv", "devices.csv"):
        assert name in text
        assert (DATA / name).is_file()
    assert "symbolic/body/laws/" in text
