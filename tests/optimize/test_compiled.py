# SPDX-License-Identifier: BSD-3-Clause
"""Compiled NLPs: the cache, and everything that may be wrong with a compiler."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from studies import study_of

from softimpact.optimize.impact.compiled import compiled_functions
from softimpact.optimize.impact.impact_program import impact_numbers, impact_program
from softimpact.symbolic import Motors
from softimpact.toolchain import c_compiler, cache_folder

COMPILER = c_compiler()
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="no C compiler")


def parabola(weight: float = 1.0) -> list[ca.Function]:
    """A small function."""
    x = ca.MX.sym("x", 2)
    return [ca.Function("parabola", [x], [ca.sumsqr(x - ca.DM([weight, 0]))])]


def program(folder: Path, name: str, text: str) -> str:
    """Write an executable shell script."""
    path = folder / name
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return str(path)


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "a" / "cache"
    monkeypatch.setenv("SOFTIMPACT_CACHE", str(folder))
    return folder


def test_where_the_cache_is(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SOFTIMPACT_CACHE", str(tmp_path / "mine"))
    assert cache_folder() == tmp_path / "mine"
    monkeypatch.delenv("SOFTIMPACT_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache_folder() == tmp_path / "xdg/softimpact"
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache_folder() == tmp_path / ".cache/softimpact"


def test_which_compiler(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    assert c_compiler() is None
    clang = program(tmp_path, "clang", "exit 0")
    assert c_compiler() == (clang,)
    cc = program(tmp_path, "cc", "exit 0")
    assert c_compiler() == (cc,)
    monkeypatch.setenv("CC", clang)
    assert c_compiler() == (clang,)
    monkeypatch.setenv("CC", str(tmp_path / "none"))
    assert c_compiler() is None


def test_a_compiler_of_several_words(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "with space").mkdir()
    cache = program(tmp_path, "ccache", "exit 0")
    compiler = program(tmp_path / "with space", "gcc", "exit 0")
    monkeypatch.setenv("CC", f"{cache} gcc -m64")
    assert c_compiler() == (cache, "gcc", "-m64")
    monkeypatch.setenv("CC", compiler)
    assert c_compiler() == (compiler,)


@needs_compiler
def test_a_user_without_a_home_does_not_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("SOFTIMPACT_CACHE", "XDG_CACHE_HOME", "HOME"):
        monkeypatch.delenv(name, raising=False)

    def nobody(_: int) -> None:
        raise KeyError

    monkeypatch.setattr("pwd.getpwuid", nobody)
    assert compiled_functions(parabola(), COMPILER) is None


def test_no_compiler_no_library(cache: Path) -> None:
    assert compiled_functions(parabola(), None) is None
    assert not cache.exists()


@needs_compiler
def test_a_library_computes_the_same(cache: Path) -> None:
    before = Path.cwd()
    library = compiled_functions(parabola(0.25), COMPILER)
    assert library is not None
    assert library.parent == cache
    assert Path.cwd() == before
    assert float(ca.external("parabola", str(library))([1.25, 2])) == 5.0
    assert [path.name for path in cache.iterdir()] == [library.name]


@needs_compiler
def test_the_second_time_nothing_is_compiled(cache: Path) -> None:
    library = compiled_functions(parabola(), COMPILER)
    assert library is not None
    os.utime(library, (1, 1))
    assert compiled_functions(parabola(), COMPILER) == library
    assert library.stat().st_mtime == 1
    other = compiled_functions(parabola(2.0), COMPILER)
    assert other not in (None, library)


@pytest.mark.parametrize(
    "text",
    [
        "exit 1",
        "exit 0",  # and no output
        'for last; do :; done; while [ "$1" != -o ]; do shift; done; echo no > "$2"',
        "kill -SEGV $$",
    ],
)
def test_a_broken_compiler_does_not_matter(cache: Path, tmp_path: Path, text: str) -> None:
    assert compiled_functions(parabola(), (program(tmp_path, "cc", text),)) is None
    assert list(cache.iterdir()) == []


def test_a_compiler_that_cannot_run_does_not_matter(cache: Path, tmp_path: Path) -> None:
    assert compiled_functions(parabola(), (str(tmp_path / "none"),)) is None
    assert list(cache.iterdir()) == []


@needs_compiler
def test_a_cache_that_cannot_be_written_does_not_matter(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("not a folder")
    for place in ("file", "file/cache"):
        monkeypatch.setenv("SOFTIMPACT_CACHE", str(tmp_path / place))
        assert compiled_functions(parabola(), COMPILER) is None


TWIN = """
import sys, casadi as ca
from softimpact.optimize.impact.compiled import compiled_functions
from softimpact.toolchain import c_compiler
x = ca.MX.sym("x", 2)
function = ca.Function("parabola", [x], [ca.sumsqr(x - 1)])
print("ready", flush=True)
sys.stdin.readline()
print(compiled_functions([function], c_compiler()))
"""


def _twin() -> subprocess.Popen[str]:
    command = [sys.executable, "-c", TWIN]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True)


@needs_compiler
def test_two_processes_may_compile_the_same_at_once(cache: Path) -> None:
    with _twin() as a, _twin() as b:
        for twin in (a, b):
            assert twin.stdout is not None
            assert twin.stdout.readline() == "ready\n"
        for twin in (a, b):
            assert twin.stdin is not None
            twin.stdin.write("\n")
            twin.stdin.flush()
        libraries = {twin.communicate()[0].strip() for twin in (a, b)}
    assert (a.returncode, b.returncode) == (0, 0)
    assert libraries == {str(path) for path in cache.iterdir()}
    (library,) = libraries
    assert float(ca.external("parabola", library)([3, 4])) == 13.0


@needs_compiler
def test_machine_code_computes_what_the_virtual_machine_does(tmp_path: Path) -> None:
    study = study_of(tmp_path, {"impact": {"region": "head"}}, ("q9",))
    fast, slow = (impact_program(study.model, 150, 1, compiled=c) for c in (True, False))
    assert fast.library is not None
    p = impact_numbers(study.direction, 1.0, study.contact, Motors("driven"), 2e-4)
    random = np.random.default_rng(0)
    for _ in range(3):
        q = study.task_pose.q + random.uniform(-0.3, 0.3, 7)
        x = np.concatenate([q, random.uniform(3, 5, 7)])
        np.testing.assert_allclose(fast["forces"](x, p), slow["forces"](x, p), atol=1e-9)
        found, expected = (np.array(each["slopes"](x, p, 75)[1]) for each in (fast, slow))
        np.testing.assert_allclose(found, expected, atol=1e-9 * abs(expected).max())
