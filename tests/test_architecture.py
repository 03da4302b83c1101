# SPDX-License-Identifier: BSD-3-Clause
"""The structure that CONTRIBUTING.md promises."""

from __future__ import annotations

import ast
import re
import subprocess
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
MAY_IMPORT = {
    "robots": set(),
    "symbolic": {"robots"},
    "codegen": {"symbolic", "toolchain"},
    "simulate": {"symbolic"},
    "optimize": {"robots", "symbolic", "toolchain", "lazy"},  # built-in studies by name
    "studio": {"robots", "symbolic", "codegen", "simulate", "optimize", "batch", "toolchain"},
    "papers": {"robots", "symbolic", "simulate", "optimize", "studio"},
}
ORDER = {
    "codegen": (
        *("inputs", "expressions", "sharing", "functions", "bindings", "record"),
        *("verification", "sources", "package"),
    ),
    "optimize": ("machine", "posture", "search", "robust", "front"),
    "studio": (
        *("typed", "output", "robot", "impact", "program", "map", "design", "front"),
        *("figures", "report", "page", "commands"),
    ),
}
"""Folders of a folder, each of which may import those before it."""


def tracked(*patterns: str) -> list[Path]:
    """Return the files under version control that match."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", *patterns],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    )
    return [ROOT / name for name in listed.stdout.splitlines() if (ROOT / name).is_file()]


def imported_folders(path: Path) -> Iterator[str]:
    """Yield the folders of softimpact that a module imports."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level == 0:
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        yield from (name.split(".")[1] for name in names if name.startswith("softimpact."))


def siblings_imported(path: Path, folder: str) -> Iterator[str]:
    """Yield the folders beside a module's own, of those in ``folder``, that it imports."""
    depth = len(path.relative_to(ROOT / folder).parts)
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            module = node.module or ""
            if node.level == depth:
                yield module.split(".")[0]
            elif node.level == 0 and module.startswith(f"softimpact.{folder}."):
                yield module.split(".")[2]


@pytest.mark.parametrize("folder", MAY_IMPORT)
def test_arrows_point_one_way(folder: str) -> None:
    modules = tracked(f"{folder}/*.py")
    assert modules
    for path in modules:
        assert set(imported_folders(path)) <= MAY_IMPORT[folder] | {folder}, path


@pytest.mark.parametrize("folder", ORDER)
def test_folders_build_on_those_before(folder: str) -> None:
    for place, part in enumerate(ORDER[folder]):
        modules = tracked(f"{folder}/{part}/*.py")
        assert modules
        for path in modules:
            later = set(siblings_imported(path, folder)) & set(ORDER[folder][place + 1 :])
            assert not later, path


def test_files_can_be_read_at_a_sitting() -> None:
    long = {
        path.relative_to(ROOT).as_posix(): count
        for path in tracked("*.py", "*.jinja")
        if (count := path.read_text(encoding="utf-8").count("\n")) > 400
    }
    assert long == {}


def test_sources_say_their_licence() -> None:
    sources = [
        path for path in tracked("*.py", "*.toml", "*.xml", "Makefile") if path.stat().st_size
    ]
    assert [p for p in sources if "SPDX-License-Identifier" not in p.read_text("utf-8")[:200]] == []


def public_types(path: Path) -> Iterator[str]:
    """Yield the public classes and types that a module defines, but not a command's options."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield node.name
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            called = isinstance(node.value, ast.Call)  # a TypeVar is its module's own
            option = node.targets[0].id.endswith(("Option", "Argument"))
            if not called and not option and re.fullmatch("[A-Z][a-z]\\w*", node.targets[0].id):
                yield node.targets[0].id


def test_a_type_has_a_name_of_its_own() -> None:
    places = defaultdict(list)
    for path in tracked(*(f"{folder}/*.py" for folder in MAY_IMPORT), "src/*.py"):
        for name in public_types(path):
            places[name].append(path.relative_to(ROOT).as_posix())
    assert len(places) > 200
    assert {name: found for name, found in places.items() if len(found) > 1} == {}
