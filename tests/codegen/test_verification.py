# SPDX-License-Identifier: BSD-3-Clause
"""Other people's checkers on the generated C; ``docs/verification.md`` lists them."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from compiled_packages import COMMITTED, Generated, missing, run, tool

pytestmark = pytest.mark.slow
PAGE = Path(__file__).parents[2] / "docs/verification.md"


def executions(robot: str, real: str) -> int:
    """Return how often the fuzzer calls a build; ``make fuzz`` asks for more of each.

    In float it begins with what it found in double: numbers have two bytes in either. The other
    robots run the same sources, one for open and one for closed chains, with other joints.
    """
    first = robot in {"panda", "rmin"} and real == "double"
    return int(os.environ.get("FUZZ_EXECUTIONS", "100000" if first else "25000"))


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


@pytest.mark.long
@pytest.mark.parametrize("robot", COMMITTED)
def test_fuzzer_finds_nothing(
    package: Callable[[str], Generated], robot: str, tmp_path: Path
) -> None:
    generated, corpus = package(robot), tmp_path / "corpus"
    corpus.mkdir()
    probe = tmp_path / "probe.c"
    probe.write_text("int LLVMFuzzerTestOneInput(const unsigned char *d, unsigned long n);\n"
                     "int LLVMFuzzerTestOneInput(const unsigned char *d, unsigned long n)"
                     "{ return d == 0 && n > 0; }\n")  # fmt: skip
    command = [tool("clang"), "-fsanitize=fuzzer", str(probe), "-o", str(tmp_path / "probe")]
    if subprocess.run(command, capture_output=True, check=False).returncode != 0:
        missing("clang's libFuzzer")
    sources = [*generated.folder.glob("src/*.c"), generated.folder / "fuzz/fuzz.c"]
    checks = ["-fsanitize=fuzzer,address,undefined", "-fno-sanitize-recover=all", "-g"]
    for real in ("double", "float"):
        binary, runs = tmp_path / real, executions(robot, real)
        run("clang", *generated.flags(real), "-O2", *checks, *sources, "-o", binary, "-lm")
        said = run(binary, f"-runs={runs}", "-seed=1", "-max_len=512", "-len_control=0",
                   f"-artifact_prefix={tmp_path}/", corpus)  # fmt: skip
        assert f"Done {runs} runs" in said


@pytest.mark.parametrize("robot", COMMITTED)
def test_every_loop_has_a_bound(package: Callable[[str], Generated], robot: str) -> None:
    for source in package(robot).folder.glob("src/*.[ch]"):
        text = source.read_text()
        assert not re.search(r"\b(goto|(malloc|calloc|realloc|free|alloca|setjmp)\s*\()", text)
        assert not re.search(r"for \([^;)]*;\s*;|while \(1\)|do \{", text), source


def test_page_lists_the_checks() -> None:
    page = PAGE.read_text()
    for file in (
        "test_verification.py",
        "test_static_analysis.py",
        "test_linux_targets.py",
        "test_value_analysis.py",
        "test_costs.py",
    ):
        for name in re.findall(r"def (test_\w+)", (Path(__file__).parent / file).read_text()):
            listed = f"`{name}`" in page or f"`{file}`" in page
            assert listed or name == "test_page_lists_the_checks", name
