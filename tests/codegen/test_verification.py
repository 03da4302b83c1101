# SPDX-License-Identifier: BSD-3-Clause
"""Other people's checkers on the generated C; ``docs/verification.md`` lists them."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from compiled_packages import COMMITTED, Generated, run, tool

pytestmark = pytest.mark.slow
PAGE = Path(__file__).parents[2] / "docs/verification.md"


@pytest.mark.parametrize("real", ["double", "float"])
def test_gccs_analyzer_finds_nothing(
    package: Callable[[str], Generated], real: str, tmp_path: Path
) -> None:
    generated = package("panda")
    for source in generated.folder.glob("src/*.c"):
        flags = [*generated.flags(real), "-O2", "-fanalyzer"]
        run(tool("gcc"), *flags, "-c", source, "-o", tmp_path / "x.o")


@pytest.mark.parametrize("level", ["-O0", "-O2", "-O3"])
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_own_test_passes_at_every_level(
    package: Callable[[str], Generated], compiler: str, level: str, tmp_path: Path
) -> None:
    generated = package("panda")
    sources = [*generated.folder.glob("src/*.c"), *generated.folder.glob("test/*.c")]
    for real in ("double", "float"):
        binary = tmp_path / real
        run(tool(compiler), *generated.flags(real), level, *sources, "-o", binary, "-lm")
        assert run(binary).endswith("all passed\n")


@pytest.mark.parametrize("real", ["double", "float"])
def test_valgrind_finds_nothing(
    package: Callable[[str], Generated], real: str, tmp_path: Path
) -> None:
    valgrind = tool("valgrind")
    generated = package("panda")
    sources = [*generated.folder.glob("src/*.c"), *generated.folder.glob("test/*.c")]
    binary = tmp_path / "test"
    run(tool("gcc"), *generated.flags(real), "-g", *sources, "-o", binary, "-lm")
    said = run(valgrind, "--error-exitcode=3", "--track-origins=yes", binary)
    assert "ERROR SUMMARY: 0 errors" in said
    assert re.search(r"total heap usage: [12] allocs", said)  # printf's own


@pytest.mark.parametrize("robot", COMMITTED)
def test_every_loop_has_a_bound(package: Callable[[str], Generated], robot: str) -> None:
    for source in package(robot).folder.glob("src/*.[ch]"):
        text = source.read_text()
        assert not re.search(r"\b(goto|(malloc|calloc|realloc|free|alloca|setjmp)\s*\()", text)
        assert not re.search(r"for \([^;)]*;\s*;|while \(1\)|do \{", text), source


def test_page_lists_the_checks() -> None:
    page = PAGE.read_text()
    for file in (
        "test_fuzzing.py",
        "test_verification.py",
        "test_static_analysis.py",
        "test_linux_targets.py",
        "test_value_analysis.py",
        "test_costs.py",
    ):
        for name in re.findall(r"def (test_\w+)", (Path(__file__).parent / file).read_text()):
            listed = f"`{name}`" in page or f"`{file}`" in page
            assert listed or name == "test_page_lists_the_checks", name
