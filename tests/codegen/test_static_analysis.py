# SPDX-License-Identifier: BSD-3-Clause
"""cppcheck and the rules of MISRA C:2012; ``docs/misra.md`` lists and justifies deviations."""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest
from compiled_packages import COMMITTED, Generated, missing, run, tool
from sharing import once

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/misra.md").read_text(encoding="utf-8")
DEVIATIONS = set(re.findall(r"^\| (\d+\.\d+) \|", PAGE, re.MULTILINE))
VERSION = re.findall(r"Cppcheck [\d.]+\d", PAGE)[0]
"""Others find other things."""

MISRA = re.compile(r"misra-c2012-(\d+\.\d+)$")


@pytest.fixture(scope="module", autouse=True)
def _tools() -> None:
    if run(tool("cppcheck"), "--version").strip() != VERSION:
        missing(VERSION)


def findings(package: Generated, real: str, *what: str | Path) -> set[str]:
    """Return what cppcheck finds, as ``file:line name``."""
    command = [
        *("cppcheck", "--quiet", "--std=c99", "--inconclusive", "--template={file}:{line} {id}"),
        *("--enable=warning,style,performance,portability", "--template-location="),
        f"-D{package.manifest.name.upper()}_USE_{real.upper()}=1",
        f"-I{package.folder / 'include'}",
    ]
    return set(run(*command, *what).splitlines())


IN_DOUBLE = ("rr", "rmin")
"""Packages that are looked at in double, the others in float: of open and of closed chains."""


def broken_rules(package: Generated) -> set[str]:
    """Return the rules that a package's sources break; there must be no other finding."""
    real = "double" if package.manifest.name in IN_DOUBLE else "float"
    return once(package.folder.with_suffix(".misra"), lambda _: _broken_rules(package, real))


def _broken_rules(package: Generated, real: str) -> set[str]:
    with tempfile.TemporaryDirectory() as folder:  # the addon writes beside the sources
        sources = shutil.copytree(package.folder / "src", Path(folder) / "src")
        found = findings(package, real, "--addon=misra", sources)
    assert not {line for line in found if not MISRA.search(line)}
    return {match[1] for match in map(MISRA.search, found) if match}


@pytest.mark.long
@pytest.mark.parametrize("robot", COMMITTED)
def test_cppcheck_finds_listed_deviations_only(
    package: Callable[[str], Generated], robot: str
) -> None:
    assert broken_rules(package(robot)) <= DEVIATIONS


@pytest.mark.long
def test_every_listed_deviation_is_needed(package: Callable[[str], Generated]) -> None:
    assert set().union(*(broken_rules(package(name)) for name in IN_DOUBLE)) == DEVIATIONS


@pytest.mark.parametrize("robot", COMMITTED)
def test_cppcheck_finds_nothing_in_tests_and_examples(
    package: Callable[[str], Generated], robot: str
) -> None:
    generated = package(robot)
    sources = [generated.folder / folder for folder in ("test", "fuzz")]
    if robot == "panda":
        sources += sorted((ROOT / "examples").rglob("*.c"))
    assert not findings(generated, "double", *sources)


def test_cppcheck_would_notice(package: Callable[[str], Generated], tmp_path: Path) -> None:
    source = tmp_path / "slip.c"
    source.write_text(
        "int f(void);\nint f(void) { int a[2] = {0, 0}; goto end; end: return a[2]; }\n"
    )
    found = findings(package("rr"), "float", "--addon=misra", source)
    assert {f"{source}:2 arrayIndexOutOfBounds", f"{source}:2 misra-c2012-15.1"} <= found
