# SPDX-License-Identifier: BSD-3-Clause
"""A name is public because somebody outside its package needs it, and for no other reason."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = {
    "softimpact": "src/softimpact",
    "softimpact.batch": "src/softimpact/batch",
    "softimpact.codegen": "codegen",
    "softimpact.optimize": "optimize",
    "softimpact.simulate": "simulate",
    "softimpact.symbolic": "symbolic",
}
LISTS = ("docs/python.md", "tests/docs/test_python_page.py")
"""They have every name, so they show no use of any."""


def words(*patterns: str, without: str = "") -> set[str]:
    """Return all words of the files that match."""
    found: set[str] = set()
    for pattern in patterns:
        for path in ROOT.glob(pattern):
            name = path.relative_to(ROOT).as_posix()
            if name not in LISTS and not (without and name.startswith(f"{without}/")):
                found |= set(re.findall(r"\w+", path.read_text(encoding="utf-8")))
    return found


@pytest.mark.parametrize("package", PACKAGES)
def test_somebody_needs_each_public_name(package: str) -> None:
    folder = PACKAGES[package]
    module = import_module(package)
    sources = (
        f"{each}/**/*.py" for each in ("codegen", "optimize", "papers", "simulate", "studio")
    )
    used = words(*sources, "src/softimpact/*.py", "src/softimpact/batch/*.py", without=folder)
    used |= words(
        "README.md", "docs/*.md", "examples/**/*.py", "benchmarks/**/*.py", "tests/**/*.py"
    )
    results = "\n".join(p.read_text(encoding="utf-8") for p in (ROOT / folder).rglob("*.py"))
    used |= set(re.findall(r"-> (\w+)", results)) | set(re.findall(r"\braise (\w+)", results))
    assert [name for name in module.__all__ if name not in used] == []
