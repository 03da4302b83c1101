# SPDX-License-Identifier: BSD-3-Clause
"""A package's own test, compiled and run before the package is written."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..errors import FailedOwnTest

LONGEST_RUN = 300.0
"""Seconds after which a compiler or a test hangs; thirty joints take some ten."""

FLAGS = ("-std=c99", "-O0")
"""To compile takes longer than to run."""


def works(compiler: Sequence[str]) -> bool:
    """Return whether a compiler makes programs that run here."""
    try:
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder, "main.c")
            source.write_text("int main(void)\n{\n    return 0;\n}\n", encoding="utf-8")
            return _run(_built(compiler, [source], Path(folder))).returncode == 0
    except (OSError, FailedOwnTest, subprocess.TimeoutExpired):
        return False


def replay(files: Mapping[str, str], compiler: Sequence[str]) -> None:
    """Compile a package's own test and run it.

    Args:
        files: texts of the package by path.
        compiler: words of its command line; one that ``works``.

    Raises:
        FailedOwnTest: a golden result is missed, or C that does not compile.
    """
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        sources = [Path(folder, name) for name in files if _is_of_test(name)]
        try:
            outcome = _run(_built(compiler, sources, Path(folder)))
        except subprocess.TimeoutExpired:
            raise FailedOwnTest(f"it did not end within {LONGEST_RUN:.0f} s") from None
    if outcome.returncode != 0:
        raise FailedOwnTest(_reason(outcome.stdout) or f"it ended with code {outcome.returncode}")


def _is_of_test(name: str) -> bool:
    return name.endswith(".c") and name.startswith(("src/", "test/"))


def _built(compiler: Sequence[str], sources: Sequence[Path], folder: Path) -> Path:
    """Compile a program; raises FailedOwnTest with the compiler's first error."""
    program = folder / "replay.exe"
    command = [*compiler, *FLAGS, f"-I{folder / 'include'}", *map(str, sources)]
    built = _run(*command, "-o", program, "-lm")
    if built.returncode != 0:
        errors = [line for line in built.stderr.splitlines() if "error" in line]
        raise FailedOwnTest((errors or built.stderr.splitlines() or ["no program"])[0])
    return program


def _run(*command: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(word) for word in command],
        check=False,
        capture_output=True,
        text=True,
        errors="replace",
        timeout=LONGEST_RUN,
    )


def _reason(printed: str) -> str:
    failures = [line for line in printed.splitlines() if line.startswith("FAILED")]
    more = f" (and {len(failures) - 1} more)" if len(failures) > 1 else ""
    return f"{failures[0]}{more}" if failures else ""
