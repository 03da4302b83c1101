# SPDX-License-Identifier: BSD-3-Clause
"""Files that state the version or the dependencies again state the same."""

from __future__ import annotations

import re
import tomllib
from importlib.metadata import version
from pathlib import Path

import softimpact

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
CONDA = {"matplotlib": "matplotlib-base", "mujoco": "mujoco-python"}
"""Names that conda has for the same."""


def text(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def test_version() -> None:
    stated = PROJECT["version"]
    assert f"\nversion: {stated}\n" in text("CITATION.cff")
    assert f'\n  version: "{stated}"\n' in text("packaging/conda/recipe.yaml")
    assert version("softimpact") == stated
    assert softimpact.__doc__


def test_conda_depends_on_what_pip_does() -> None:
    run = text("packaging/conda/recipe.yaml").split("  run:\n")[1].split("\n\n")[0]
    recipe = dict(re.findall(r"- ([\w-]+) (>=[\d.]+)", run))
    declared = dict(re.findall(r"^([\w-]+)(>=[\d.]+)$", "\n".join(PROJECT["dependencies"]), re.M))
    assert len(declared) == len(PROJECT["dependencies"])
    expected = {CONDA.get(name, name): bound for name, bound in declared.items()}
    assert recipe == {"python": PROJECT["requires-python"], **expected}


def test_every_dependency_is_pinned_for_the_tests() -> None:
    pins = {line.split("==")[0].lower() for line in text("constraints.txt").splitlines()}
    extras = PROJECT["optional-dependencies"].values()
    needed = [*PROJECT["dependencies"], *(name for extra in extras for name in extra)]
    names = {re.split(r"[<>=\[ ;]", name)[0].lower() for name in needed}
    assert names <= pins
