# SPDX-License-Identifier: BSD-3-Clause
"""Put small faults into sources, one at a time, and see whether a test notices.

Usage: ``python tests/mutation/run.py symbolic codegen --sample 100``, after a run of the tests with
``--cov --cov-context=test``, which tells the tests that pass through a line. A fault that none of
them notices is printed; docs/verification.md judges what was found.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from queue import Queue

import coverage
from mutants import Mutant, mutants, mutated  # type: ignore[import-not-found] # beside it

ROOT = Path(__file__).resolve().parents[2]
FEW = 25
"""Tests that a fault meets first: those that pass through the fewest lines, so the closest ones."""
MANY = 200
"""Tests that a fault meets at most."""
SECONDS = 300
"""Time after which a run counts as endless, so the fault as noticed."""


@dataclass(frozen=True)
class Fault:
    """A mutant of a file, and the tests that pass through its line, closest first."""

    file: str
    mutant: Mutant
    tests: tuple[str, ...]


def faults(folders: Sequence[str], data: coverage.CoverageData) -> Iterator[Fault]:
    """Yield the faults of folders whose lines some test passes through."""
    lines_of: dict[str, int] = {}
    contexts: dict[Path, dict[int, list[str]]] = {}
    for measured in data.measured_files():
        contexts[Path(measured).resolve()] = by_line = data.contexts_by_lineno(measured)
        for tests in by_line.values():
            for test in tests:
                lines_of[test] = lines_of.get(test, 0) + 1
    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*.py")):
            by_line = contexts.get(path, {})
            anywhere = {test for tests in by_line.values() for test in tests}
            for mutant in mutants(path.read_text(encoding="utf-8")):
                ran = set(by_line.get(mutant.line, ())) - {""} or anywhere  # constants of a module
                tests = sorted(ran - {""}, key=lambda test: (lines_of[test], test))
                names = tuple(dict.fromkeys(test.rpartition("|")[0] for test in tests))
                if names:
                    yield Fault(path.relative_to(ROOT).as_posix(), mutant, names[:MANY])


@contextmanager
def copies(count: int) -> Iterator[Queue[Path]]:
    """Give copies of the sources to put faults into."""
    listed = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(listed, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    free: Queue[Path] = Queue()
    with tempfile.TemporaryDirectory() as folder:
        for i in range(count):
            copy = Path(folder) / str(i)
            for name in names.splitlines():
                (copy / name).parent.mkdir(parents=True, exist_ok=True)
                if (ROOT / name).exists():
                    shutil.copy(ROOT / name, copy / name, follow_symlinks=False)
            free.put(copy)
        yield free


def noticed(fault: Fault, free: Queue[Path]) -> bool:
    """Return whether a test fails with a fault: the closest ones, then the others."""
    copy = free.get()
    source = copy / fault.file
    original = source.read_text(encoding="utf-8")
    try:
        source.write_text(mutated(original, fault.mutant), encoding="utf-8")
        if fails(copy, fault.tests[:FEW]):
            return True
        return len(fault.tests) > FEW and fails(copy, fault.tests[FEW:])
    finally:
        source.write_text(original, encoding="utf-8")
        free.put(copy)


def fails(copy: Path, tests: Sequence[str]) -> bool:
    """Return whether one of some tests fails."""
    environment = {**os.environ, "PYTHONPATH": str(copy / "src"), "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests]
    try:
        done = subprocess.run(
            command, cwd=copy, env=environment, capture_output=True, check=False, timeout=SECONDS
        )
    except subprocess.TimeoutExpired:
        return True
    return done.returncode != 0


def main() -> int:
    """Return how many faults of the sample no test notices."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="+")
    parser.add_argument("--sample", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--most", type=int, default=None, help="survivors that are no failure")
    given = parser.parse_args()
    data = coverage.CoverageData(str(ROOT / ".coverage"))
    data.read()
    known = list(faults(given.folders, data))
    chosen = sorted(
        random.Random(given.seed).sample(known, min(given.sample, len(known))),
        key=lambda fault: (fault.file, fault.mutant),
    )
    cores = os.cpu_count() or 1
    with copies(cores) as free, ThreadPoolExecutor(cores) as pool:
        answers = pool.map(lambda fault: noticed(fault, free), chosen)
        missed = []
        for fault, found in zip(chosen, answers, strict=True):
            if not found:
                missed.append(fault)
                print(f"{fault.file}:{fault.mutant.line}: {fault.mutant.what}", flush=True)
    print(f"{len(chosen) - len(missed)} of {len(chosen)} faults noticed, of {len(known)} possible")
    return int(given.most is not None and len(missed) > given.most)


if __name__ == "__main__":
    sys.exit(main())
